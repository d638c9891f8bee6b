// The table of sequences: scenes that a table of pairs cannot see, and what is asked of the default on each of them.
#pragma once

#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/tracker.hpp"
#include "pivnp/piv/sequence.hpp"
#include "tests/support/piv_sequence.hpp"

namespace pivnp::piv {

struct SequenceFigure {
  std::string name;
  double value = 0, limit = 0;
  bool at_least = false;
  bool met() const { return at_least ? value >= limit : value <= limit; }  // false for NaN
};
using SequenceFigures = std::vector<SequenceFigure>;

struct SequenceRow {
  std::string name;
  bool brief = false;  // part of the short form
  std::function<SequenceFigures(const PivOptions&, int seed, int threads)> measure;
};

namespace sequence {

/// Nodes and vectors of a sequence, row downward: the pixels are the world.
struct Measured {
  Grid grid;
  std::vector<VectorField> pairs;
};

/// `alone`: every pair by itself.
inline Measured measure(const Sequence& s, const PivOptions& options, int threads, bool alone = false,
                        const MaskView& mask = {}, const std::function<MaskView(int)>& material = {}) {
  Measured out;
  constexpr int spacing = 8;
  constexpr double edge = 16;
  out.grid = {.origin = Vec2(edge, edge),
              .spacing = Vec2(spacing, spacing),
              .nx = static_cast<int>((s.width - 1 - 2 * edge) / spacing) + 1,
              .ny = static_cast<int>((s.height - 1 - 2 * edge) / spacing) + 1};
  NodeLattice nodes{.nx = out.grid.nx, .ny = out.grid.ny, .pixel = {}, .on = {}};
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i) {
      const Vec2 p = out.grid.position(i, j);
      nodes.pixel.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
    }
  SequenceCorrelator correlator(options, nodes, s.width, s.height, threads);
  Image before = draw(s, 0);
  for (int k = 0; k + 1 < s.frames; ++k) {
    Image after = draw(s, k + 1);
    correlator.add(before.view(), after.view(), mask, nullptr, material ? material(k) : MaskView{});
    before = std::move(after);
    if (!alone && correlator.held() < SequenceCorrelator::group && k + 2 < s.frames) continue;
    for (PixelVectors& v : correlator.finish()) {
      const int pair = static_cast<int>(out.pairs.size());
      out.pairs.push_back({{pair, pair + 1}, v.anchor, out.grid, std::move(v.displacement), std::move(v.status),
                           std::move(v.cov), v.correlation_px, std::move(v.score), std::move(v.path_factor)});
    }
  }
  return out;
}

/// What the material that is at p midway between frames k and k + 1 moves by between them.
inline Vec2 truth(const Sequence& s, const Vec2& p, int k) {
  Vec2 d(0, 0);
  for (int n = 0; n < 20; ++n) {
    const Vec2 from = origin(s, p - d / 2, k);
    d = s.place(from, k + 1) - s.place(from, k);
  }
  return d;
}

struct Shares {
  double nodes = 0, valid = 0, wrong = 0, square = 0;
  double largest = 0;
  double valid_share() const { return valid / nodes; }
  double wrong_share() const { return wrong / valid; }
  double rms() const { return std::sqrt(square / (2 * valid)); }
  void add(const Shares& more) {
    nodes += more.nodes, valid += more.valid, wrong += more.wrong, square += more.square;
    largest = std::max(largest, more.largest);
  }
};

/// Over the nodes where `counts`, all pairs; wrong: valid and off by more than half a pixel.
inline Shares shares(const Sequence& s, const Measured& m, const std::function<bool(const Vec2&, int)>& counts) {
  Shares out;
  for (const VectorField& pair : m.pairs)
    for (std::size_t n = 0; n < pair.status.size(); ++n) {
      const Vec2 p = m.grid.position(int(n % std::size_t(m.grid.nx)), int(n / std::size_t(m.grid.nx)));
      if (counts && !counts(p, pair.pair[0])) continue;
      ++out.nodes;
      if (pair.status[n] != VectorStatus::valid) continue;
      ++out.valid;
      const Vec2 off = Vec2(pair.displacement[n][0], pair.displacement[n][1]) - truth(s, p, pair.pair[0]);
      out.wrong += off.norm() > 0.5, out.square += off.squaredNorm();
      out.largest = std::max(out.largest, off.norm());
    }
  return out;
}

/// Vectors that have a value, by what flags say of them: wrong by more than half a pixel, good to a quarter. Vectors
/// must be as measured (PivOptions::replace).
struct Told {
  double wrong = 0, wrong_flagged = 0, good = 0, good_kept = 0;
};

inline Told told(const Sequence& s, const Measured& m) {
  Told out;
  for (const VectorField& pair : m.pairs)
    for (std::size_t n = 0; n < pair.status.size(); ++n) {
      const Vec2 p = m.grid.position(int(n % std::size_t(m.grid.nx)), int(n / std::size_t(m.grid.nx)));
      const double off = (Vec2(pair.displacement[n][0], pair.displacement[n][1]) - truth(s, p, pair.pair[0])).norm();
      const bool valid = pair.status[n] == VectorStatus::valid;  // off is NaN where nothing was measured
      if (off > 0.5) ++out.wrong, out.wrong_flagged += !valid;
      if (off < 0.25) ++out.good, out.good_kept += valid;
    }
  return out;
}

/// A tracker with particles so far apart, from `border` px inside the frame.
inline np::Tracker started(const Sequence& s, double border, double apart, const np::NpOptions& options) {
  ParticleSet set;
  for (double y = border; y < s.height - border; y += apart)
    for (double x = border; x < s.width - border; x += apart) {
      if (s.material && !s.material(Vec2(x, y))) continue;
      set.id.push_back(std::int64_t(set.id.size()));
      set.label.push_back(0), set.x0.push_back(Vec2(x, y)), set.area.push_back(apart * apart), set.born.push_back(0);
      set.end.push_back(std::numeric_limits<double>::quiet_NaN()), set.end_reason.push_back(EndReason::none);
    }
  set.label_names = {"all"};
  return np::Tracker(options, std::move(set), 0);
}

/// Particles 4 px apart through all pairs, from `border` px inside the frame.
inline np::Tracker follow(const Measured& m, const Sequence& s, double border) {
  np::Tracker tracker = started(s, border, 4, {});
  for (const VectorField& pair : m.pairs) tracker.step(pair, pair.pair[1]);
  return tracker;
}

/// Summed particles across a shear band (sequence::band): shear of F along it in bins of 2 px, the truth, and both
/// after an even window of 32 px' Gaussian (sigma 9.03 px), and the displacement's error beside the band.
struct BandResult {
  double peak = 0;   // over the peak of the blurred truth
  double width = 0;  // at half height
  double blurred_width = 0, true_width = 0;
  double noise = 0;  // px, rms of a component's error 48 px and more from the band
};

inline double half_width_of(const std::vector<double>& profile, double bin) {
  const auto top = std::max_element(profile.begin(), profile.end());
  const double half = 0.5 * *top;
  double out = 0;
  for (const int direction : {-1, 1}) {
    auto k = top - profile.begin();
    while (k + direction >= 0 && k + direction < std::ptrdiff_t(profile.size()) &&
           profile[std::size_t(k + direction)] > half)
      k += direction, out += bin;
    if (k + direction < 0 || k + direction >= std::ptrdiff_t(profile.size())) continue;
    const double a = profile[std::size_t(k)], b = profile[std::size_t(k + direction)];
    out += bin * (a - half) / (a - b);
  }
  return out;
}

inline BandResult band_result(const Sequence& s, const np::Tracker& tracker, double step, double half_width) {
  constexpr double bin = 2, sigma = 9.03;
  constexpr int reach = 60;  // bins
  const double c = std::cos(5 * M_PI / 180), t = std::sin(5 * M_PI / 180);
  const Vec2 along(c, t), across(-t, c), middle(0.5 * s.width, 0.5 * s.height);
  std::vector<double> found(2 * reach + 1), count(found.size()), blurred(found.size()), exact(found.size());
  BandResult out;
  double square = 0, some = 0;
  const int last = s.frames - 1;
  for (std::size_t p = 0; p < tracker.particles().size(); ++p) {
    const auto state = tracker.state()[p];
    if (state.status == ParticleStatus::ended) continue;
    const Vec2 X = tracker.particles().x0[p];
    const double off = across.dot(X - middle);
    const auto at = std::lround(off / bin) + reach;
    if (at >= 0 && at <= 2 * reach) found[std::size_t(at)] += along.dot(state.F * across), ++count[std::size_t(at)];
    if (std::abs(off) > 48) square += (state.x - s.place(X, last)).squaredNorm(), some += 2;
  }
  for (int b = -reach; b <= reach; ++b) {
    const auto slope = [&](double x) {
      const double e = 1 / std::cosh(x / half_width);
      return last * step / half_width * e * e;
    };
    double sum = 0, weight = 0;
    for (int k = -80; k <= 80; ++k) {
      const double w = std::exp(-0.5 * k * k / (sigma * sigma));
      sum += w * slope(bin * b + k), weight += w;
    }
    const auto at = std::size_t(b + reach);
    blurred[at] = sum / weight, exact[at] = slope(bin * b);
    found[at] = count[at] > 0 ? found[at] / count[at] : 0;
  }
  out.peak = *std::max_element(found.begin(), found.end()) / *std::max_element(blurred.begin(), blurred.end());
  out.width = half_width_of(found, bin);
  out.blurred_width = half_width_of(blurred, bin), out.true_width = half_width_of(exact, bin);
  out.noise = std::sqrt(square / some);
  return out;
}

/// Errors of particles' displacements and F against the truth, and the shares within one and two stated sigma.
struct PathResult {
  double rms = 0, one = 0, two = 0, left = 0;  // left: share still followed
};

inline PathResult path_result(const Sequence& s, const np::Tracker& tracker) {
  PathResult out;
  double square = 0, components = 0, one = 0, two = 0, followed = 0;
  for (std::size_t p = 0; p < tracker.particles().size(); ++p) {
    const auto state = tracker.state()[p];
    if (state.status == ParticleStatus::ended) continue;
    ++followed;
    const Vec2 off = state.x - s.place(tracker.particles().x0[p], s.frames - 1);
    for (int c = 0; c < 2; ++c) {
      const double sigma = std::sqrt(state.cov[std::size_t(c)]);
      square += off[c] * off[c], ++components;
      one += std::abs(off[c]) <= sigma, two += std::abs(off[c]) <= 2 * sigma;
    }
  }
  out.rms = std::sqrt(square / components), out.one = one / components, out.two = two / components;
  out.left = followed / static_cast<double>(tracker.particles().size());
  return out;
}

inline SequenceRow band_row(int steps, double step, double noise, bool brief = false) {
  constexpr double half_width = 8;
  char name[64];
  std::snprintf(name, sizeof name, "band %d x %.2f px, noise %.0f %%", steps, step, 100 * noise);
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Sequence s{.frames = steps + 1, .seed = seed, .noise = noise};
            s.width = 384, s.height = 384;
            s.place = band(s, step / 2, half_width);
            const auto run = [&](Smoothing smoothing, bool alone) {
              PivOptions o = options;
              o.smoothing = smoothing;
              return band_result(s, follow(measure(s, o, threads, alone), s, 64), step / 2, half_width);
            };
            const BandResult r = run(options.smoothing, false), window = run(Smoothing::window, true),
                             alone = run(Smoothing::adaptive, true);
            return {{"peak over blurred truth", r.peak, .95, true},
                    {"width over blurred truth", r.width / r.blurred_width, 1.1},
                    {"width over truth", r.width / r.true_width, .9, true},
                    {"path noise, px", r.noise, 1.15 * std::min(window.noise, alone.noise)}};
          }};
}

inline SequenceRow light_row(const char* name, double most_wrong, bool brief,
                             std::function<double(double, double, int)> light) {
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Shares all;
            for (const bool grains : {false, true}) {  // faint sand; bright grains on dark ground
              Sequence s{.frames = 4, .seed = seed, .noise = .01};
              if (grains) s.texture = {.density_per_px = .03, .blob_diameter_px = 5};
              if (!grains) s.texture.peak_min = .03, s.texture.peak_max = .1;
              s.place = uniform(9.3, -6.4), s.light = light;
              all.add(shares(s, measure(s, options, threads), {}));
            }
            return {{"valid and wrong", all.wrong_share(), most_wrong}, {"valid", all.valid_share(), .8, true}};
          }};
}

/// A round body of the named grey without texture of its own over moving sand; counted 16 px and more inside it, and
/// 24 px and more outside it.
inline SequenceRow void_row(const char* name, bool brief, double noise, int jpeg,
                            std::function<double(double, double)> grey) {
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Sequence s{.frames = 4, .seed = seed, .noise = noise, .jpeg = jpeg};
            s.place = uniform(1.3, -0.6);
            const auto off = [](double x, double y) { return std::hypot(x - 256, y - 240) - 130; };
            s.cover = [=](double x, double y, int) { return std::clamp(0.5 - off(x, y), 0.0, 1.0); };
            s.cover_grey = grey;
            const Measured m = measure(s, options, threads);
            const Shares inside = shares(s, m, [&](const Vec2& p, int) { return off(p.x(), p.y()) < -16; });
            const Shares outside = shares(s, m, [&](const Vec2& p, int) { return off(p.x(), p.y()) > 24; });
            return {{"valid inside", inside.valid_share(), .01},
                    {"valid outside", outside.valid_share(), .995, true},
                    {"rms outside, px", outside.rms(), .05}};
          }};
}

inline SequenceRow path_row(const char* name, bool brief, int frames, double noise, double loss, int jpeg, double most,
                            const std::function<std::function<Vec2(const Vec2&, int)>(const Sequence&)>& motion) {
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Sequence s{.frames = frames, .seed = seed, .noise = noise, .jpeg = jpeg};
            s.width = 384, s.height = 384;
            s.texture.loss = loss;
            s.place = motion(s);
            const PathResult r = path_result(s, follow(measure(s, options, threads), s, 72));
            return {{"paths: rms, px", r.rms, most},
                    {"followed", r.left, .99, true},
                    {"within one sigma", r.one, .60, true},
                    {"within two sigma", r.two, .90, true}};
          }};
}

enum class Ground { seen, masked, left_out };

/// A layer that slides over ground of its own texture, times `behind`: surface along the frame's middle row, shear of
/// `shear` below it. Vectors whose window is at least half inside against those well inside. `masked`: a mask leaves
/// the ground out of both frames; `left_out`: of the first one, as regions that move with their particles do.
inline SequenceRow surface_row(const char* name, bool brief, double step, double behind, double shear,
                               Ground seen = Ground::seen) {
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Sequence s{.frames = 5, .seed = seed, .behind = behind, .noise = .01};
            s.width = 384, s.height = 384;
            s.place = [=](const Vec2& X, int k) -> Vec2 { return X + k * Vec2(step - shear * (X.y() - 192), 0); };
            s.material = [](const Vec2& X) { return X.y() > 192; };
            std::vector<std::uint8_t> usable(std::size_t(s.width) * std::size_t(s.height), 1);
            std::fill_n(usable.begin(), 193 * s.width, std::uint8_t(0));
            const MaskView ground{usable.data(), s.width, s.height, s.width};
            const Measured m = measure(s, options, threads, false, seen == Ground::masked ? ground : MaskView{},
                                       [&](int) { return seen == Ground::left_out ? ground : MaskView{}; });
            const Shares rim = shares(s, m, [](const Vec2& p, int) { return p.y() > 192 && p.y() < 208 && p.x() > 64; });
            const Shares deep = shares(s, m, [](const Vec2& p, int) { return p.y() > 240 && p.x() > 64; });
            return {{"rim: valid and wrong", rim.wrong_share(), .05},
                    {"rim: rms over the interior's", rim.rms() / deep.rms(), 1.5},
                    {"rim: valid", rim.valid_share(), .5, true}};
          }};
}

}  // namespace sequence

inline std::vector<SequenceRow> sequence_rows() {
  using namespace sequence;
  std::vector<SequenceRow> rows;
  for (const int steps : {7, 20, 60})
    for (const double step : {.05, .2, .5}) rows.push_back(band_row(steps, step, .03, steps == 7 && step == .2));
  rows.push_back(band_row(20, .05, .01));
  rows.push_back(band_row(20, .2, .05));

  // Light that moves.
  rows.push_back(light_row("soft shadow 15 px a frame", 0, true, [](double x, double, int k) {
    return 1 - .55 / (1 + std::exp((x - 150 - 15 * k) / 25));
  }));
  rows.push_back(light_row("sharp shadow 15 px a frame", .005, false, [](double x, double y, int k) {
    return 1 - .55 * std::clamp(0.5 - (x + .3 * y - 250 - 15 * k), 0.0, 1.0);
  }));
  rows.push_back(light_row("spot of a lamp that jumps, gain 2.8", 0, true, [](double x, double y, int k) {
    return .35 + .63 * std::exp(-.5 * (std::pow((x - 150 - 90 * (k % 2)) / 120, 2) + std::pow((y - 250) / 150, 2)));
  }));
  rows.push_back(light_row("gain 2.8 from frame to frame", 0, false,
                           [](double, double, int k) { return k % 2 == 0 ? .35 : .98; }));
  rows.push_back({"fast, gain 2", false, [](const PivOptions& options, int seed, int threads) -> SequenceFigures {
                    PivOptions fast = options;
                    fast.method = "fast";
                    return light_row("", 0, false, [](double, double, int k) { return k % 2 == 0 ? .5 : 1.0; })
                        .measure(fast, seed, threads);
                  }});

  // Nothing to measure.
  rows.push_back(void_row("black hole", true, .004, 0, [](double, double) { return .02; }));
  rows.push_back(void_row("sky, noise 1 %", true, .01, 0, [](double x, double y) { return .8 - .0004 * y + .0001 * x; }));
  rows.push_back(void_row("sky, noise 1 %, JPEG 85", false, .01, 85, [](double, double y) { return .8 - .0004 * y; }));
  rows.push_back(void_row("glass, noise 3 %", false, .03, 0, [](double x, double y) {
    return .5 + .1 * std::exp(-(std::pow(x - 230, 2) + std::pow(y - 250, 2)) / 8000);
  }));
  rows.push_back(void_row("shadowed wall", false, .01, 0, [](double x, double) { return .08 + .0002 * x; }));
  rows.push_back({"defocus, sigma 8 px", false, [](const PivOptions& options, int seed, int threads) -> SequenceFigures {
                    Sequence s{.frames = 3, .seed = seed, .noise = .02};
                    s.place = uniform(1.3, -0.6), s.blur_px = 8;
                    s.blurred = [](double x, double) { return x > 256; };
                    const Measured m = measure(s, options, threads);
                    const Shares soft = shares(s, m, [](const Vec2& p, int) { return p.x() > 280; });
                    const Shares keen = shares(s, m, [](const Vec2& p, int) { return p.x() < 232; });
                    return {{"valid inside", soft.valid_share(), .01}, {"valid outside", keen.valid_share(), .995, true}};
                  }});

  // Surfaces that move.
  rows.push_back(surface_row("surface 2 px, plain ground", false, 2, 0, 0));
  rows.push_back(surface_row("surface 2 px, faint ground", false, 2, .3, 0));
  rows.push_back(surface_row("surface 6 px, full ground", false, 6, 1, 0));
  rows.push_back(surface_row("surface 6 px, full ground, shear", false, 6, 1, .02));
  rows.push_back(surface_row("surface 12 px, faint ground", false, 12, .3, 0));
  rows.push_back(surface_row("surface 6 px, full ground, masked", false, 6, 1, 0, Ground::masked));
  rows.push_back(surface_row("surface 6 px, full ground, shear, masked", false, 6, 1, .02, Ground::masked));
  rows.push_back(surface_row("surface 2 px, faint ground, left out", false, 2, .3, 0, Ground::left_out));
  rows.push_back(surface_row("surface 6 px, full ground, left out", false, 6, 1, 0, Ground::left_out));
  rows.push_back(surface_row("surface 6 px, full ground, shear, left out", false, 6, 1, .02, Ground::left_out));
  rows.push_back(surface_row("surface 12 px, full ground, left out", false, 12, 1, 0, Ground::left_out));

  // Paths and their stated error.
  rows.push_back(path_row("vortex, noise 2 %", false, 13, .02, 0, 0, .1, [](const Sequence& s) { return vortex(s, 2, 80); }));
  rows.push_back(path_row("vortex, loss 10 %", false, 13, .01, .1, 0, .1, [](const Sequence& s) { return vortex(s, 2, 80); }));
  rows.push_back(path_row("extension .3 % a frame", false, 21, .02, 0, 0, .1,
                          [](const Sequence& s) { return extension(s, .003); }));
  rows.push_back(path_row("even motion, JPEG 60", false, 9, .01, 0, 60, .05, [](const Sequence&) { return uniform(.7, .4); }));
  rows.push_back(path_row("even motion, JPEG 30", false, 9, .01, 0, 30, .05, [](const Sequence&) { return uniform(.7, .4); }));

  // Dirt on the glass.
  rows.push_back({"pattern on the glass", false, [](const PivOptions& options, int seed, int threads) -> SequenceFigures {
                    Sequence s{.frames = 8, .seed = seed, .noise = .01};
                    s.width = 384, s.height = 384;
                    s.place = uniform(.8, .3);
                    Sequence dirt = s;
                    dirt.seed = seed + 50;
                    const auto blobs = std::make_shared<std::vector<Vec2>>();
                    for (std::uint64_t n = 0; n < 1500; ++n)
                      blobs->push_back(Vec2(384 * random01(std::uint64_t(seed), 77, 2 * n), 384 * random01(std::uint64_t(seed), 77, 2 * n + 1)));
                    const auto grey = std::make_shared<std::vector<double>>(grey_of(s.texture, *blobs, 384, 384));
                    s.pattern = [=](double x, double y) {
                      return 1.0 * ((*grey)[std::size_t(y) * 384 + std::size_t(x)] - s.texture.background);
                    };
                    const PathResult r = path_result(s, follow(measure(s, options, threads), s, 72));
                    return {{"paths: rms, px", r.rms, .1}, {"within two sigma", r.two, .90, true}};
                  }});

  // Beyond the range of fft.
  for (const double stretch : {.88, .80})
    for (const char* method : {"fft", "gn"})
      rows.push_back({std::string(method) + ", stretch " + std::to_string(stretch).substr(0, 4), false,
                      [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
                        Sequence s{.frames = 2, .seed = seed, .noise = .01};
                        s.place = [=](const Vec2& X, int k) -> Vec2 {
                          const Vec2 m(256, 256);
                          return m + (k == 0 ? 1.0 : stretch) * (X - m);
                        };
                        PivOptions o = options;
                        o.method = method;
                        const Shares all = shares(s, measure(s, o, threads), {});
                        const double wrong = all.wrong / all.nodes;
                        o.replace = false;
                        const Told as_measured = told(s, measure(s, o, threads));
                        return {{"valid and wrong, of all", wrong, method[0] == 'f' ? .02 : .0005},
                                {"largest error of valid, px", all.largest, 5},
                                {"wrong ones flagged",
                                 as_measured.wrong > 0 ? as_measured.wrong_flagged / as_measured.wrong : 1, .97, true},
                                {"good ones kept", as_measured.good_kept / as_measured.good, .95, true}};
                      }});
  return rows;
}

}  // namespace pivnp::piv

// The table of sequences: scenes that a table of pairs cannot see, and what is asked of the default on each of them.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/piv_sequence_results.hpp"

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

constexpr double band_half_width = 8;

inline Sequence band_scene(int steps, double step, double noise, int seed) {
  Sequence s{.frames = steps + 1, .seed = seed, .noise = noise};
  s.width = 384, s.height = 384;
  s.place = band(s, step / 2, band_half_width);
  return s;
}

inline BandResult band_result(const Sequence& s, double step, const PivOptions& options, int threads, bool alone) {
  return band_result(s, follow(measure(s, options, threads, alone), s, 64), step / 2, band_half_width);
}

inline SequenceRow band_row(int steps, double step, double noise, bool brief = false) {
  char name[64];
  std::snprintf(name, sizeof name, "band %d x %.2f px, noise %.0f %%", steps, step, 100 * noise);
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            const Sequence s = band_scene(steps, step, noise, seed);
            const auto run = [&](Smoothing smoothing, bool alone) {
              PivOptions o = options;
              o.smoothing = smoothing;
              return band_result(s, step, o, threads, alone);
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

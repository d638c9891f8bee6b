// What the default finds in a drawn sequence of frames, against the truth: vectors, a band, paths.
#pragma once

#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/tracker.hpp"
#include "pivnp/piv/sequence.hpp"
#include "tests/support/piv_sequence.hpp"

namespace pivnp::piv {

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
      out.pairs.push_back({{pair, pair + 1},
                           v.anchor,
                           out.grid,
                           std::move(v.displacement),
                           std::move(v.status),
                           std::move(v.cov),
                           v.correlation_px,
                           std::move(v.score),
                           std::move(v.path_factor)});
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

}  // namespace sequence

}  // namespace pivnp::piv

// Rows of the table of sequences that judge paths: the error of displacement and strain, and what is stated of it, at a
// tenth, at half and at the end of sequences of many kinds. Truth is the map that carried the texture.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "pivnp/np/errors/bend_loss.hpp"
#include "tests/support/piv_sequence_rows.hpp"

namespace pivnp::piv {

namespace sequence {

/// Shares within one and two stated sigma, of displacement's components and of the strain of what F is off by.
struct Coverage {
  double rms = 0, one = 0, two = 0, strain_one = 0, strain_two = 0;
  double silent = 0;  // off by over 1 px, not flagged, and beyond three stated sigma
};

inline Coverage coverage(const Sequence& s, const np::Tracker& tracker, int frame) {
  Coverage c;
  double live = 0;
  for (std::size_t p = 0; p < tracker.particles().size(); ++p) {
    const auto state = tracker.state()[p];
    if (state.status == ParticleStatus::ended) continue;
    ++live;
    const Vec2 X = tracker.particles().x0[p], off = state.x - s.place(X, frame);
    const Mat2 inverse = state.F.inverse();
    const Mat2 L = (state.F - gradient_of(s, X, frame)) * inverse;
    Mat2 R;
    R << state.cov_F[0], state.cov_F[2], state.cov_F[2], state.cov_F[1];
    const Mat2 S = inverse.transpose() * R * inverse;
    bool beyond = false;
    for (int k = 0; k < 2; ++k) {
      const double sigma = std::sqrt(state.cov[std::size_t(k)]), strain_sigma = std::sqrt(S(k, k));
      c.rms += off[k] * off[k] / 2;
      c.one += (std::abs(off[k]) <= sigma) / 2.0, c.two += (std::abs(off[k]) <= 2 * sigma) / 2.0;
      c.strain_one += (std::abs(L(k, k)) <= strain_sigma) / 2.0, c.strain_two += (std::abs(L(k, k)) <= 2 * strain_sigma) / 2.0;
      beyond = beyond || std::abs(off[k]) > 3 * sigma;
    }
    c.silent += off.norm() > 1 && beyond && state.status == ParticleStatus::active;
  }
  for (double* sum : {&c.rms, &c.one, &c.two, &c.strain_one, &c.strain_two, &c.silent}) *sum /= live;
  c.rms = std::sqrt(c.rms);
  return c;
}

/// Pushes material aside: 25 px down at the end, within 60 px of the middle, and fading 90 px below row 100.
inline auto punch(int frames) {
  return [=](const Vec2& X, int k) -> Vec2 {
    const double pushed = 25.0 * k / (frames - 1), off = (X.x() - 256) / 60;
    const double f = std::exp(-0.5 * off * off) * std::exp(-std::max(0.0, X.y() - 100) / 90);
    return X + pushed * f * Vec2(0.5 * off, 1);
  };
}

/// A band that grows: 18 px to either side at the end, tanh(s / 10 px), as the power 1.5 of time.
inline auto growing_band(const Sequence& s) {
  return [one = band(s, 1, 10), last = s.frames - 1](const Vec2& X, int k) -> Vec2 {
    return X + 18 * std::pow(double(k) / last, 1.5) * (one(X, 1) - X);
  };
}

/// A body that slips on a circle, 42 px at the end, over a band of tanh(s / 9 px); as the square of time.
inline auto slide(int frames) {
  return [=](const Vec2& X, int k) -> Vec2 {
    const Vec2 centre(200, 60), r = X - centre;
    const double turn = .16 * std::pow(double(k) / (frames - 1), 2) * .5 * (1 - std::tanh((r.norm() - 260) / 9));
    const double c = std::cos(turn), t = std::sin(turn);
    return centre + Vec2(c * r.x() - t * r.y(), t * r.x() + c * r.y());
  };
}

/// What follows a tracker's steps: holds the particles against drift, for one.
struct Hold {
  std::function<void(const np::Tracker&, const np::BendLoss&)> start;
  std::function<void(np::Tracker&, np::BendLoss&, const VectorField& pair, bool last)> after_step;
};
using HoldOf = std::function<Hold(const Sequence&, const PivOptions&, int threads)>;

/// Particles `apart` px apart, 64 px from the frame's border, after the last pair of the sequence.
inline np::Tracker followed(const Sequence& s, double apart, const PivOptions& options, int threads, const HoldOf& hold_of,
                            const std::function<void(const np::Tracker&, int frame)>& at_frame) {
  const Measured m = measure(s, options, threads);
  np::Tracker tracker = started(s, 64, apart, {});
  np::BendLoss lost(tracker.particles().size());
  const Hold hold = hold_of ? hold_of(s, options, threads) : Hold{};
  if (hold.start) hold.start(tracker, lost);
  for (const VectorField& pair : m.pairs) {
    const int k = pair.pair[1];
    lost.before_step(tracker);
    tracker.step(pair, k);
    lost.after_step(tracker, pair, np::BendLoss::length_of(pair, options.window_px));
    if (hold.after_step) hold.after_step(tracker, lost, pair, k == s.frames - 1);
    at_frame(tracker, k);
  }
  return tracker;
}

/// Bands of tanh(s/half_width) of that shear strain at their middle at the end: shares of the places within 1.2 half
/// widths that are flagged or whose shear, and displacement along the band where it bends (beyond 0.3 half widths), are
/// within one stated sigma.
inline SequenceRow band_row(double half_width, double strain, bool brief, const HoldOf& hold_of) {
  char name[96];
  std::snprintf(name, sizeof name, "21 frames: band of %g px, strain %g", half_width, strain);
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Sequence s{.width = 288, .height = 256, .frames = 21, .seed = seed, .noise = .02};
            const int last = s.frames - 1;
            const Vec2 along(std::cos(5 * M_PI / 180), std::sin(5 * M_PI / 180)), across(-along.y(), along.x());
            s.place = band(s, strain * half_width / last, half_width);
            const np::Tracker tracker = followed(s, 3, options, threads, hold_of, [](const np::Tracker&, int) {});
            double live = 0, shown = 0, bends = 0, one = 0, strain_one = 0, silent = 0;
            for (std::size_t p = 0; p < tracker.particles().size(); ++p) {
              const auto state = tracker.state()[p];
              const Vec2 X = tracker.particles().x0[p];
              const double from = std::abs(across.dot(X - Vec2(.5 * s.width, .5 * s.height))) / half_width;
              if (state.status == ParticleStatus::ended || from > 1.2) continue;
              const bool flagged = state.status == ParticleStatus::flagged;
              Mat2 C, R;
              C << state.cov[0], state.cov[2], state.cov[2], state.cov[1];
              R << state.cov_F[0], state.cov_F[2], state.cov_F[2], state.cov_F[1];
              const double off = std::abs(along.dot(state.x - s.place(X, last))),
                           shear = std::abs(along.dot((state.F - gradient_of(s, X, last)) * across)),
                           sigma = std::sqrt(along.dot(C * along));
              ++live, shown += !flagged;
              strain_one += flagged || shear <= std::sqrt(across.dot(R * across));
              silent += !flagged && off > std::max(1.0, 3 * sigma);
              if (from > .3) ++bends, one += flagged || off <= sigma;
            }
            return {{"not flagged", shown / live, 0, true},
                    {"within one sigma or flagged", one / bends, .60, true},
                    {"strain: the same", strain_one / live, .55, true},
                    {"silently wrong", silent / live, .01}};
          }};
}

/// `most`: rms of the displacement's components at the end, px.
inline SequenceRow coverage_row(const std::string& name, bool brief, Sequence s, double most, const HoldOf& hold_of) {
  return {name, brief, [=](const PivOptions& options, int seed, int threads) -> SequenceFigures {
            Sequence drawn = s;
            drawn.seed = seed;
            SequenceFigures out;
            const int last = s.frames - 1;
            followed(drawn, 6, options, threads, hold_of, [&](const np::Tracker& tracker, int k) {
              if (k != (last + 9) / 10 && k != last / 2 && k != last) return;
              const Coverage c = coverage(drawn, tracker, k);
              const std::string at = ", frame " + std::to_string(k);
              const auto inside = [&](const char* what, double share, double least) {
                out.push_back({what + at, share, least, true});
              };
              inside("within one sigma", c.one, .60);
              inside("within two sigma", c.two, .90);
              inside("strain within one sigma", c.strain_one, .60);
              inside("strain within two sigma", c.strain_two, .90);
              if (k == last) out.push_back({"paths: rms, px", c.rms, most});
              if (k == last) out.push_back({"silently wrong", c.silent, .01});
            });
            return out;
          }};
}

}  // namespace sequence

/// 41 frames of 512 x 512 px, particles followed as `pivnp track` follows them.
inline std::vector<SequenceRow> path_rows(const sequence::HoldOf& hold_of = {}) {
  using namespace sequence;
  std::vector<SequenceRow> rows;
  constexpr int frames = 41;
  const auto of = [](double noise, double loss = 0, int jpeg = 0) {
    Sequence s{.frames = frames, .noise = noise, .jpeg = jpeg};
    s.texture.loss = loss;
    return s;
  };
  const auto add = [&](const std::string& name, Sequence s, auto place, double most, bool brief = false) {
    s.place = place;
    rows.push_back(coverage_row("41 frames: " + name, brief, s, most, hold_of));
  };
  const Sequence frame = of(0);
  add("vortex, noise 2 %", of(.02), vortex(frame, 2, 80), .1);
  add("vortex, loss 10 %", of(.01, .1), vortex(frame, 2, 80), .1);
  add("growing band, noise 2 %", of(.02), growing_band(frame), .3);
  add("growing band, noise 5 %", of(.05), growing_band(frame), .3);
  Sequence air = of(.02);
  air.material = [](const Vec2& X) { return X.y() > 150 - .15 * (X.x() - 256); };
  add("slide under air, noise 2 %", air, slide(frames), .5);
  add("extension, noise 1 %", of(.01), extension(frame, .003), .1);
  add("punch, noise 2 %, JPEG 85", of(.02, 0, 85), punch(frames), .2);
  Sequence lit = of(.02);
  lit.light = [](double x, double, int k) { return 1 - .4 / (1 + std::exp((x - 100 - 8 * k) / 25)); };
  add("punch, noise 2 %, moving shadow", lit, punch(frames), .2);
  for (const double half_width : {4, 7, 12, 22})
    for (const double strain : {0.2, 1.1, 4.6}) rows.push_back(band_row(half_width, strain, half_width == 7, hold_of));
  return rows;
}

}  // namespace pivnp::piv

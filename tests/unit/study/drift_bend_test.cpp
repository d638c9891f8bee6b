// Drift correction where the motion bends within a subset: vectors that lose a part of a growing band, frames that show
// all of it.
//   criterion: correction brings paths no farther off than they were, its stated error covers what they are off by, and
//   nobody
//     is off by a pixel beyond three stated standard deviations without a flag. Beside the band it helps as it does
//     anywhere.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::app {
namespace {

namespace bent_paths {

constexpr int width = 208, height = 160, frame_count = 21;
constexpr double slip = 0.7, half_width = 10, middle = 80;  // px a frame to either side, px, px
constexpr double lost = 1.2 * 4;                            // px^2 of the Laplacian

double band(double y) { return slip * std::tanh((y - middle) / half_width); }
double bend(double y) {
  const double t = std::tanh((y - middle) / half_width);
  return -2 * slip * t * (1 - t * t) / (half_width * half_width);
}

struct Outcome {
  double in_band = 0, beside = 0;  // RMS, px, along the band
  double stated_in_band = 0;
  double flagged_in_band = 0;  // share
  double square = 0, stated = 0;  // RMS of all, px
  int silent = 0, flagged_beside = 0;
};

// What is wrong with the vectors, and with the texture.
struct Seen {
  std::function<double(const Vec2&)> misread;  // of u, in every pair; empty: nothing but the bend
  double misread_rms = 0;
  double sigma = .01;         // stated of each vector by itself
  bool slips = true;          // the band
  bool lost_in_band = false;  // new grains there, from the frame in the middle on
};

struct Scene {
  Case c = parse_case(
      "name = \"bend\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 8\narea_px = [[24, 24], [184, 136]]\n"
      "[region.block]\npolygon_px = [[64, 40], [144, 40], [144, 120], [64, 120]]\n"
      "[piv]\nwindow_px = 32\n[np]\nper_element = 4\ndrift_interval = 10\n",
      "test", ".");
  Setting setting = make_setting(c, width, height);
  Seen seen;
  explicit Scene(np::DriftScheme scheme, Seen how = {}) : seen(std::move(how)) { c.np->drift = scheme; }

  double moves(double y) const { return seen.slips ? band(y) : slip; }

  Image draw(int k) const {
    image::TextureOptions options;
    options.noise = 0.02, options.seed = 4;
    const image::BlobRenderer renderer(options, width, height);
    std::vector<Vec2> at;
    const int blobs = int(options.density_per_px * (width + 80) * (height + 80));
    for (int n = 0; n < blobs; ++n) {
      const Vec2 first(uniform(4, 2 * std::uint64_t(n)) * (width + 80) - 40,
                       uniform(4, 2 * std::uint64_t(n) + 1) * (height + 80) - 40);
      const bool other = seen.lost_in_band && 2 * k >= frame_count - 1 && std::abs(first.y() - middle) < 12;
      const double along = other ? uniform(5, std::uint64_t(n)) * (width + 80) - 40 : first.x();
      at.push_back(setting.camera.to_pixel(Vec2(along + k * moves(first.y()), first.y())));
    }
    return renderer.draw(at, k, frame_count);
  }

  VectorField vectors(const TrackStep& step) const {
    VectorField field;
    field.pair = {step.from, step.to};
    field.anchor = Anchor::forward;
    field.grid = setting.grid;
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const Vec2 x = field.grid.position(i, j);
        const double y = x.y(), bent = seen.slips ? bend(y) : 0, missing = std::hypot(4 * bent, seen.misread_rms);
        field.displacement.push_back({float(moves(y) + lost * bent + (seen.misread ? seen.misread(x) : 0)), 0});
        // What bends lose is stated as an error that all pairs share.
        const double first = seen.sigma * seen.sigma + missing * missing;
        field.cov.push_back({float(first), float(seen.sigma * seen.sigma), 0});
        field.path_factor.push_back(float((seen.sigma * seen.sigma + (2 * step.from + 1) * missing * missing) / first));
      }
    field.status.assign(field.grid.node_count(), VectorStatus::valid);
    field.score.assign(field.grid.node_count(), 1);
    return field;
  }
};

Outcome followed(np::DriftScheme scheme, const Seen& seen = {}) {
  const Scene scene(scheme, seen);
  std::vector<Frame> frames;
  for (int k = 0; k < frame_count; ++k) frames.push_back({"drawn", double(k), frame_ok});
  Outcome out;
  double n_band = 0, n_beside = 0, n_all = 0;
  SilentProgress progress;
  const Measured measured{plan_steps(frames), [&](const TrackStep& step) { return scene.vectors(step); },
                          [&](int k) { return scene.draw(k); }};
  follow(scene.c, scene.setting, frames, measured, 1, progress, [&](std::size_t k, const np::Tracker& now) {
    if (k + 1 != frames.size()) return;
    for (std::size_t p = 0; p < now.state().size(); ++p) {
      const np::Tracker::Particle particle = now.state()[p];
      const Vec2 x0 = now.particles().x0[p];
      const double off = particle.x.x() - x0.x() - double(k) * scene.moves(x0.y()), stated = std::sqrt(particle.cov[0]);
      if (std::abs(x0.y() - middle) < half_width)
        out.in_band += off * off, out.stated_in_band += stated * stated, ++n_band,
            out.flagged_in_band += particle.status == ParticleStatus::flagged;
      else if (std::abs(x0.y() - middle) > 3 * half_width)
        out.beside += off * off, ++n_beside, out.flagged_beside += particle.status == ParticleStatus::flagged;
      out.square += off * off, out.stated += stated * stated, ++n_all;
      out.silent += std::abs(off) > 0.5 && std::abs(off) > 2 * stated && particle.status == ParticleStatus::active;
    }
  });
  out.square = std::sqrt(out.square / n_all), out.stated = std::sqrt(out.stated / n_all);
  out.in_band = std::sqrt(out.in_band / n_band), out.stated_in_band = std::sqrt(out.stated_in_band / n_band);
  out.beside = std::sqrt(out.beside / n_beside), out.flagged_in_band /= n_band;
  return out;
}

// Of rows of particles 4 px apart, within a subset about row `at`: the quadratic fit there less the affine one.
double bend_of_subset(const std::map<int, double>& row, int at) {
  std::vector<std::pair<double, double>> inside;
  for (const auto& [y, value] : row)
    if (std::abs(y - at) <= 16) inside.emplace_back(y - at, value);
  const auto count = Eigen::Index(inside.size());
  Eigen::MatrixX3d terms(count, 3);
  Eigen::VectorXd values(count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto [r, value] = inside[std::size_t(n)];
    terms.row(n) << 1, r, r * r;
    values[n] = value;
  }
  return terms.colPivHouseholderQr().solve(values)[0] - terms.leftCols<2>().colPivHouseholderQr().solve(values)[0];
}

}  // namespace bent_paths

TEST(DriftBend, CorrectionDoesNotBelieveWhatASubsetCannotFollow) {
  using namespace bent_paths;
  const Outcome none = followed(np::DriftScheme::none), corrected = followed(np::DriftScheme::corrected);
  for (const auto& [name, o] : {std::pair{"none", none}, std::pair{"corrected", corrected}})
    std::printf(
        "[ figure   ] drift %s: in the band %.3f px off (stated %.3f), beside it %.3f; silent %d, flagged %.2f of it, "
        "beside %d\n",
        name, o.in_band, o.stated_in_band, o.beside, o.silent, o.flagged_in_band, o.flagged_beside);
  EXPECT_GT(none.in_band, 0.3);
  EXPECT_LT(corrected.in_band, 1.05 * none.in_band);
  EXPECT_GT(corrected.stated_in_band, corrected.in_band / 1.6);
  EXPECT_GT(corrected.stated_in_band, 0.9 * none.stated_in_band);  // both estimates lose the same
  EXPECT_GT(none.flagged_in_band, 0.5);
  EXPECT_GT(corrected.flagged_in_band, 0.5);
  EXPECT_EQ(corrected.silent, 0);
  EXPECT_EQ(corrected.flagged_beside, 0);
  EXPECT_LT(corrected.beside, 0.05);
}

// Errors of vectors that change within a subset: it cannot tell them, and what it takes over of them stays stated. With
// a correlation of exp(-d^2/(2 (7.2 px)^2)), as paths of smoothed pairs have.
TEST(DriftBend, WhatASubsetCannotFindStaysStated) {
  using namespace bent_paths;
  constexpr int waves = 80;
  constexpr double rms = .02, alike = 7.2;
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::array<double, 3>> modes;
  for (int n = 0; n < waves; ++n) modes.push_back({normal(random) / alike, normal(random) / alike, 9 * normal(random)});
  Seen seen{.misread =
                [&](const Vec2& x) {
                  double sum = 0;
                  for (const auto& [p, q, phase] : modes) sum += std::cos(p * x.x() + q * x.y() + phase);
                  return rms * std::sqrt(2.0 / waves) * sum;
                },
            .misread_rms = rms,
            .slips = false};
  const Outcome none = followed(np::DriftScheme::none, seen), corrected = followed(np::DriftScheme::corrected, seen);
  std::printf("[ figure   ] errors within subsets: %.3f px (stated %.3f), corrected %.3f (%.3f)\n", none.square,
              none.stated, corrected.square, corrected.stated);
  EXPECT_LT(corrected.square, 0.6 * none.square);
  EXPECT_GT(corrected.stated, corrected.square);
  EXPECT_LT(corrected.stated, 1.5 * corrected.square);
}

// Where a third of the particles, in the band, lost their texture, a later key frame holds these alone. What the direct
// estimate lacks follows from what bends have lost since that frame, of all particles about.
//   criterion: where vectors are known so badly that the direct estimate replaces them, BendLoss holds what it held at
//   the
//     key frame and the bend of what has been lost since, to a tenth in the mean of a row (sheared subsets are not
//     evenly filled).
TEST(DriftBend, ALaterKeyFrameKnowsWhatBendsHaveLostOfAllParticles) {
  using namespace bent_paths;
  const Scene scene(np::DriftScheme::corrected, {.sigma = 10, .lost_in_band = true});
  np::Tracker tracker(*scene.c.np, seed_particles(scene.c, scene.setting), 0);
  np::BendLoss lost(tracker.particles().size());
  DriftCorrector corrector(scene.c, scene.setting, 1);
  corrector.start(tracker, lost, scene.draw(0).view());
  std::vector<Vec2> at_key, before;
  std::map<int, double> since_key;
  for (int k = 1; k < frame_count; ++k) {
    const VectorField field = scene.vectors({k - 1, k});
    lost.before_step(tracker);
    tracker.step(field, k);
    lost.after_step(tracker, field, 2);
    if (k + 1 == frame_count)
      for (std::size_t p = 0; p < at_key.size(); ++p)
        since_key[int(tracker.particles().x0[p].y())] = lost.lost(p).x() - at_key[p].x();
    corrector.after_step(tracker, lost, k, k + 1 == frame_count, 0, [&] { return scene.draw(k); });
    if (2 * k + 1 != frame_count) continue;
    for (std::size_t p = 0; p < tracker.particles().size(); ++p) at_key.push_back(lost.lost(p));
  }
  ASSERT_EQ(corrector.rounds().size(), 2u);
  EXPECT_GT(corrector.rounds()[1].from_later, 100u);
  EXPECT_GT(corrector.rounds()[1].from_first, 100u);
  std::map<int, Vec2> rows;  // sums over a row: held, expected
  for (std::size_t p = 0; p < at_key.size(); ++p) {
    const Vec2 x0 = tracker.particles().x0[p];
    const int y = int(x0.y());
    if (std::abs(x0.y() - middle) > 8 || x0.x() < 84 || x0.x() > 124) continue;
    auto& row = rows.try_emplace(y, Vec2::Zero()).first->second;
    row += Vec2(lost.lost(p).x(), at_key[p].x() + bend_of_subset(since_key, y));
  }
  EXPECT_EQ(rows.size(), 4u);
  for (const auto& [y, row] : rows) EXPECT_NEAR(row[0] / row[1], 1, .1) << "row " << y;
}

}  // namespace
}  // namespace pivnp::app

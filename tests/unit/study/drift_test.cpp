// What holds summed increments to the first frame: vectors with a known bias a frame, frames drawn without one.
//   criterion: summed increments end at the bias times the number of frames; corrected, leapfrog and reference update hold
//     the particles by the images. Where the images say nothing, the correction does no harm: the same bits. Texture that
//     is replaced half-way costs what was not corrected by then, no more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/study/methods/paths/drift.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::app {
namespace {

constexpr int width = 208, height = 160, count = 21, interval = 5;
constexpr double bias = 0.02, tilt = 2e-4;  // px, and px a px, a frame
const Vec2 patch(88, 71);                   // the middle of a piece of texture that slips
constexpr double sigma = 0.01;              // of a vector, as stated

enum class Texture { kept, replaced_half_way, of_every_frame_its_own, under_noise, with_a_patch_that_slips };

class Drift : public testing::Test {
 protected:
  Drift() : base_(parse_case("name = \"drift\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 16\narea_px = [[24, 24], [184, 136]]\n"
                             "[region.block]\npolygon_px = [[72, 56], [120, 56], [120, 104], [72, 104]]\n"
                             "[piv]\nwindow_px = 32\n[np]\nper_element = 4\ndrift_interval = 5\n",
                             "test", ".")),
            setting_(make_setting(base_, width, height)) {
    motion_.A << 1, 0.002, 0, 1;
    motion_.centre = Vec2(96, 79);
    motion_.shift = Vec2(0.7, 0.13);
    for (int k = 0; k < count; ++k) frames_.push_back({"drawn", double(k), frame_ok});
  }

  Image draw(int frame, Texture texture) const {
    image::TextureOptions options;
    options.noise = texture == Texture::under_noise ? 0.2 : 0.01;
    options.seed = texture == Texture::of_every_frame_its_own               ? 10 + frame
                   : texture == Texture::replaced_half_way && 2 * frame >= count - 1 ? 3
                                                                            : 2;
    const image::BlobRenderer renderer(options, width, height);
    std::vector<Vec2> at;
    const int blobs = int(options.density_per_px * (width + 80) * (height + 80));
    for (int n = 0; n < blobs; ++n) {
      const auto draw = [&](int which) { return uniform(std::uint64_t(options.seed), 2 * std::uint64_t(n) + which); };
      const Vec2 first(draw(0) * (width + 80) - 40, draw(1) * (height + 80) - 40);
      const bool slips = texture == Texture::with_a_patch_that_slips && frame > 0 && (first - patch).norm() < 20;
      at.push_back(setting_.camera.to_pixel(motion_.at(first, frame) + Vec2(slips ? 0.75 : 0, 0)));
    }
    return renderer.draw(at, frame, count);
  }

  VectorField vectors(const TrackStep& step) const {
    VectorField field;
    field.pair = {step.from, step.to};
    field.anchor = Anchor::forward;
    field.grid = setting_.grid;
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const Vec2 x = field.grid.position(i, j);
        const Vec2 d = motion_.next(x) - x + Vec2(bias_ + tilt * (x.y() - motion_.centre.y()), 0);
        field.displacement.push_back({float(d.x()), float(d.y())});
      }
    field.status.assign(field.grid.node_count(), VectorStatus::valid);
    field.cov.assign(field.grid.node_count(), {float(sigma * sigma), float(sigma * sigma), 0});
    field.score.assign(field.grid.node_count(), 1);
    return field;
  }

  struct Result {
    std::vector<double> rms, rms_F;  // error at every frame, px and 1
    std::vector<np::Tracker::Particle> end;
    std::vector<DriftRound> rounds;
  };

  Result tracked(np::DriftScheme drift, Texture texture) const {
    Case c = base_;
    c.np->drift = drift;
    const Measured measured{plan_steps(frames_), [&](const TrackStep& step) { return vectors(step); },
                            [&](int k) { return draw(k, texture); }};
    Result r;
    SilentProgress progress;
    r.rounds = follow(c, setting_, frames_, measured, 1, progress, [&](std::size_t k, const np::Tracker& now) {
      double sum = 0, sum_F = 0;
      const std::size_t n = now.state().size();
      for (std::size_t p = 0; p < n; ++p) {
        const np::Tracker::Particle particle = now.state()[p];
        EXPECT_NE(particle.status, ParticleStatus::ended);
        sum += (particle.x - motion_.at(now.particles().x0[p], int(k))).squaredNorm() / double(n);
        sum_F += (particle.F - motion_.F(int(k))).squaredNorm() / double(n);
        if (k + 1 == frames_.size()) r.end.push_back(particle);
      }
      r.rms.push_back(std::sqrt(sum));
      r.rms_F.push_back(std::sqrt(sum_F));
    });
    return r;
  }

  double bias_ = bias;
  Case base_;
  Setting setting_;
  AffineMotion motion_;
  std::vector<Frame> frames_;
};

TEST_F(Drift, SummedIncrementsWanderAndDirectCorrelationHoldsThem) {
  const Result none = tracked(np::DriftScheme::none, Texture::kept), corrected = tracked(np::DriftScheme::corrected, Texture::kept);
  const int steps = count - 1;
  EXPECT_NEAR(none.rms.back(), steps * bias, 0.1 * steps * bias);
  EXPECT_NEAR(none.rms_F.back(), steps * tilt, 0.1 * steps * tilt);
  EXPECT_TRUE(none.rounds.empty());
  ASSERT_EQ(corrected.rounds.size(), std::size_t(steps / interval));
  for (const DriftRound& round : corrected.rounds) {
    EXPECT_EQ(round.frame % interval, 0);
    EXPECT_EQ(round.from_first, round.alive);
    EXPECT_NEAR(round.median_px, interval * bias, 0.3 * interval * bias);  // what wandered since the last round
    EXPECT_LT(corrected.rms[std::size_t(round.frame)], 0.03);
    EXPECT_LT(corrected.rms_F[std::size_t(round.frame)], 0.25 * none.rms_F.back());
  }
  for (const double rms : corrected.rms) EXPECT_LT(rms, 0.03 + (interval - 1) * bias);
  for (const np::DriftScheme scheme : {np::DriftScheme::leapfrog, np::DriftScheme::reference_update}) {
    SCOPED_TRACE(name_of(scheme));
    const Result r = tracked(scheme, Texture::kept);
    ASSERT_EQ(r.rounds.size(), std::size_t(steps));
    for (const double rms : r.rms) EXPECT_LT(rms, 0.03);
    EXPECT_LT(r.rms_F.back(), 0.25 * none.rms_F.back());
  }
  // Fused, a particle is known better than by either, and the stated error says so.
  EXPECT_LT(corrected.end[0].cov[0], 0.2 * none.end[0].cov[0]);
  EXPECT_GT(std::sqrt(corrected.end[0].cov[0]), 0.004);
}

TEST_F(Drift, WhereImagesSayNothingNothingIsChanged) {
  frames_.resize(interval + 1);
  const Result none = tracked(np::DriftScheme::none, Texture::of_every_frame_its_own);
  for (const np::DriftScheme scheme :
       {np::DriftScheme::corrected, np::DriftScheme::leapfrog, np::DriftScheme::reference_update}) {
    SCOPED_TRACE(name_of(scheme));
    const Result r = tracked(scheme, Texture::of_every_frame_its_own);
    for (std::size_t p = 0; p < none.end.size(); ++p) {
      EXPECT_EQ(r.end[p].x, none.end[p].x);
      EXPECT_EQ(r.end[p].F, none.end[p].F);
      EXPECT_EQ(r.end[p].cov, none.end[p].cov);
      EXPECT_EQ(r.end[p].status,
                scheme == np::DriftScheme::corrected ? ParticleStatus::active : ParticleStatus::flagged);
    }
    for (const DriftRound& round : r.rounds) EXPECT_EQ(round.from_first + round.from_later, 0u);
  }
}

// Matches that correlate badly, or lie further off than the path can have wandered, do not count.
TEST_F(Drift, PoorAndDistantMatchesAreNotBelieved) {
  frames_.resize(interval + 1);
  const Result noisy = tracked(np::DriftScheme::corrected, Texture::under_noise);
  ASSERT_EQ(noisy.rounds.size(), 1u);
  EXPECT_EQ(noisy.rounds[0].from_first, 0u);
  bias_ = 0.3;  // 1.5 px in five frames, where half a pixel, .02 a frame and three deviations are allowed: .7
  const Result far = tracked(np::DriftScheme::corrected, Texture::kept), none = tracked(np::DriftScheme::none, Texture::kept);
  EXPECT_EQ(far.rounds[0].from_first, 0u);
  EXPECT_EQ(far.rms.back(), none.rms.back());
}

// A piece of texture slips over the material by .75 px at once: within reach, but out of line with its neighbours.
TEST_F(Drift, AMatchOutOfLineWithItsNeighboursIsNotBelieved) {
  frames_.resize(interval + 1);
  base_.regions[0].second.polygon_px = {{40, 40}, {152, 40}, {152, 120}, {40, 120}};
  setting_ = make_setting(base_, width, height);
  const Result r = tracked(np::DriftScheme::corrected, Texture::with_a_patch_that_slips);
  EXPECT_LT(r.rounds[0].from_first, r.rounds[0].alive);
  EXPECT_GT(r.rounds[0].from_first, r.rounds[0].alive / 2);
  double worst = 0;
  const ParticleSet set = seed_particles(base_, setting_);
  for (std::size_t p = 0; p < set.size(); ++p)
    worst = std::max(worst, (r.end[p].x - motion_.at(set.x0[p], interval)).norm());
  EXPECT_LT(worst, 0.5);
}

TEST_F(Drift, AfterTextureIsLostALaterFrameHolds) {
  const Result none = tracked(np::DriftScheme::none, Texture::replaced_half_way),
               corrected = tracked(np::DriftScheme::corrected, Texture::replaced_half_way);
  // Replaced at frame 10: what wandered since frame 5 stays, the rest is held to frame 10.
  EXPECT_NEAR(corrected.rms.back(), interval * bias, 0.4 * interval * bias);
  EXPECT_LT(corrected.rms.back(), 0.5 * none.rms.back());
  ASSERT_EQ(corrected.rounds.size(), 4u);
  EXPECT_EQ(corrected.rounds[0].from_first, corrected.rounds[0].alive);
  EXPECT_EQ(corrected.rounds[1].from_first + corrected.rounds[1].from_later, 0u);
  for (const std::size_t late : {2u, 3u}) EXPECT_EQ(corrected.rounds[late].from_later, corrected.rounds[late].alive);
}

}  // namespace
}  // namespace pivnp::app

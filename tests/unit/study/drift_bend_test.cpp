// Drift correction where the motion bends within a subset: vectors that lose a part of a growing band, frames that show
// all of it.
//   criterion: correction brings paths no farther off than they were, its stated error covers what they are off by, and
//   nobody
//     is off by a pixel beyond three stated standard deviations without a flag. Beside the band it helps as it does
//     anywhere.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::app {
namespace {

namespace bent_paths {

constexpr int width = 208, height = 160, count = 21;
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
  int silent = 0, flagged_beside = 0;
};

Outcome followed(np::DriftScheme scheme) {
  Case c = parse_case(
      "name = \"bend\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 8\narea_px = [[24, 24], [184, 136]]\n"
      "[region.block]\npolygon_px = [[64, 40], [144, 40], [144, 120], [64, 120]]\n"
      "[piv]\nwindow_px = 32\n[np]\nper_element = 4\ndrift_interval = 10\n",
      "test", ".");
  c.np->drift = scheme;
  const Setting setting = make_setting(c, width, height);
  std::vector<Frame> frames;
  for (int k = 0; k < count; ++k) frames.push_back({"drawn", double(k), frame_ok});
  const auto draw = [&](int k) {
    image::TextureOptions options;
    options.noise = 0.02, options.seed = 4;
    const image::BlobRenderer renderer(options, width, height);
    std::vector<Vec2> at;
    const int blobs = int(options.density_per_px * (width + 80) * (height + 80));
    for (int n = 0; n < blobs; ++n) {
      const Vec2 first(uniform(4, 2 * std::uint64_t(n)) * (width + 80) - 40,
                       uniform(4, 2 * std::uint64_t(n) + 1) * (height + 80) - 40);
      at.push_back(setting.camera.to_pixel(first + Vec2(k * band(first.y()), 0)));
    }
    return renderer.draw(at, k, count);
  };
  const auto vectors = [&](const TrackStep& step) {
    VectorField field;
    field.pair = {step.from, step.to};
    field.anchor = Anchor::forward;
    field.grid = setting.grid;
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const double y = field.grid.position(i, j).y(), missing = 4 * bend(y);
        field.displacement.push_back({float(band(y) + lost * bend(y)), 0});
        // What bends lose is stated as an error that all pairs share.
        const double sigma = .01, first = sigma * sigma + missing * missing;
        field.cov.push_back({float(first), float(sigma * sigma), 0});
        field.path_factor.push_back(float((sigma * sigma + (2 * step.from + 1) * missing * missing) / first));
      }
    field.status.assign(field.grid.node_count(), VectorStatus::valid);
    field.score.assign(field.grid.node_count(), 1);
    return field;
  };
  Outcome out;
  double n_band = 0, n_beside = 0;
  SilentProgress progress;
  follow(
      c, setting, frames, {plan_steps(frames), vectors, draw}, 1, progress, [&](std::size_t k, const np::Tracker& now) {
        if (k + 1 != frames.size()) return;
        for (std::size_t p = 0; p < now.state().size(); ++p) {
          const np::Tracker::Particle particle = now.state()[p];
          const Vec2 x0 = now.particles().x0[p];
          const double off = particle.x.x() - x0.x() - double(k) * band(x0.y()), stated = std::sqrt(particle.cov[0]);
          if (std::abs(x0.y() - middle) < half_width)
            out.in_band += off * off, out.stated_in_band += stated * stated, ++n_band,
                out.flagged_in_band += particle.status == ParticleStatus::flagged;
          else if (std::abs(x0.y() - middle) > 3 * half_width)
            out.beside += off * off, ++n_beside, out.flagged_beside += particle.status == ParticleStatus::flagged;
          out.silent += std::abs(off) > 0.5 && std::abs(off) > 2 * stated && particle.status == ParticleStatus::active;
        }
      });
  out.in_band = std::sqrt(out.in_band / n_band), out.stated_in_band = std::sqrt(out.stated_in_band / n_band);
  out.beside = std::sqrt(out.beside / n_beside), out.flagged_in_band /= n_band;
  return out;
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

}  // namespace
}  // namespace pivnp::app

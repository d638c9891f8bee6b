// The mean correlation of several pairs, and interlaced frames.
//   criterion: of twelve pairs in strong noise the mean is right where a single pair fails; the stated error is that of
//   the mean; the same
//     bits for any number of threads; gn refuses. Lines half a frame apart are found, in either order and in vertical
//     motion too; progressive frames are none, in noise neither.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "pivnp/piv/validation/interlace.hpp"
#include "scene.hpp"
#include "tests/support/refusal.hpp"

namespace pivnp::piv {
namespace ensemble_tests {

using ::testing::HasSubstr;

std::vector<Scene> noisy(int count) {
  std::vector<Scene> all;
  for (int k = 0; k < count; ++k) {
    image::TextureOptions texture;
    texture.noise = 0.35;
    texture.density_per_px = 0.015;
    texture.seed = k + 1;
    all.push_back(make_scene(uniform(1.3, -0.6), 160, 128, texture));
  }
  return all;
}

PixelVectors mean_of(const std::vector<Scene>& scenes, const NodeLattice& nodes, PivOptions options, int threads) {
  std::vector<FramePair> pairs;
  for (const Scene& s : scenes) pairs.push_back({s.first.view(), s.second.view()});
  PairCorrelator correlator(options, nodes, 160, 128, threads);
  return correlator.correlate_mean(pairs, {});
}

TEST(Ensemble, FindsWhatASinglePairCannot) {
  const std::vector<Scene> scenes = noisy(12);
  const NodeLattice nodes = even_nodes(160, 128, 8, 24);
  PivOptions options;
  options.method = "fft";
  options.ensemble = 12;
  const Errors single = errors(scenes.front(), nodes, measure(scenes.front(), nodes, options));
  const Errors mean = errors(scenes.front(), nodes, mean_of(scenes, nodes, options, 1));
  EXPECT_LT(single.valid, 0.9);
  EXPECT_GT(mean.valid, 0.99);
  EXPECT_LT(mean.rms, 0.25);
  EXPECT_LT(mean.rms, 0.4 * single.rms);
  EXPECT_GT(mean.within_one, 0.5);
  EXPECT_GT(mean.within_two, 0.85);
}

TEST(Ensemble, HasTheSameBitsForAnyNumberOfThreads) {
  const std::vector<Scene> scenes = noisy(3);
  const NodeLattice nodes = even_nodes(160, 128, 16, 24);
  PivOptions options;
  options.method = "ncc";
  const PixelVectors one = mean_of(scenes, nodes, options, 1), three = mean_of(scenes, nodes, options, 3);
  ASSERT_EQ(one.displacement.size(), three.displacement.size());
  EXPECT_EQ(std::memcmp(one.displacement.data(), three.displacement.data(),
                        one.displacement.size() * sizeof one.displacement[0]),
            0);
  EXPECT_EQ(std::memcmp(one.cov.data(), three.cov.data(), one.cov.size() * sizeof one.cov[0]), 0);
}

TEST(Ensemble, IsRefusedByMethodsWithoutCorrelation) {
  PivOptions options;
  options.ensemble = 2;
  EXPECT_THAT(test::refusal([&] { mean_of(noisy(2), even_nodes(160, 128, 32, 32), options, 1); }),
              HasSubstr("piv.ensemble: found 2, expected 1"));
}

struct Fields {
  Image frame;
  NodeLattice nodes;
  std::vector<std::array<float, 2>> moved;
  std::vector<VectorStatus> status;
  double delay() const { return field_delay(frame.view(), {}, nodes, moved, status); }
};

// Even lines of one instant and odd lines of half a frame later (or earlier), of material that moves by (u, v) a frame.
Fields interlaced(double u, double v, bool odd_later, bool progressive, double noise) {
  image::TextureOptions texture;
  texture.noise = noise;
  Scene half = make_scene(uniform(u / 2, v / 2), 192, 160, texture);
  Image &even = odd_later ? half.first : half.second, &odd = odd_later ? half.second : half.first;
  if (!progressive)
    for (int r = 1; r < 160; r += 2) std::memcpy(even.row<std::uint8_t>(r), odd.row<std::uint8_t>(r), 192);
  Fields out{std::move(even), even_nodes(192, 160, 8, 24), {}, {}};
  out.moved.assign(out.nodes.pixel.size(), {float(u), float(v)});
  out.status.assign(out.nodes.pixel.size(), VectorStatus::valid);
  return out;
}

TEST(Interlace, LinesHalfAFrameApartAreFound) {
  for (const double noise : {0.0, 0.05}) {
    EXPECT_EQ(interlaced(3.0, 0.4, true, false, noise).delay(), 0.5);
    EXPECT_EQ(interlaced(3.0, 0.4, false, false, noise).delay(), -0.5);
    EXPECT_EQ(interlaced(0.3, 4.0, true, false, noise).delay(), 0.5);
    EXPECT_EQ(interlaced(9.0, -5.0, true, false, noise).delay(), 0.5);
    EXPECT_EQ(interlaced(3.0, 0.4, true, true, noise).delay(), 0);
    EXPECT_EQ(interlaced(0.3, 4.0, true, true, noise).delay(), 0);
  }
  EXPECT_EQ(interlaced(0.2, 0.1, true, false, 0).delay(), 0);  // too slow to tell
}

}  // namespace ensemble_tests
}  // namespace pivnp::piv

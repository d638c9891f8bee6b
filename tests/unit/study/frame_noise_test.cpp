// Noise whose neighbouring pixels are alike: found between frames, and put into the pairs that are made of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "apps/study/methods/frames/frame_noise.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {

constexpr int side = 256;

// A mean over 3 pixels along a row (1, 2, 1) and none along columns: neighbours in a row correlate by 4/6, next ones by 1/6.
NoiseShape along_rows() { return NoiseShape(1, {0, 0, 0, 1, 2, 1, 0, 0, 0}); }

Image noisy(const ImageView& clean, const NoiseShape& shape, double deviation, std::uint64_t stream) {
  const std::vector<float> noise = shape.draw(clean.width, clean.height, stream);
  Image out(clean.width, clean.height, clean.depth, clean.white);
  for (int r = 0; r < clean.height; ++r)
    for (int c = 0; c < clean.width; ++c) {
      const double value = double(clean.row<std::uint8_t>(r)[c]) + deviation * double(noise[std::size_t(r) * std::size_t(clean.width) + std::size_t(c)]);
      out.row<std::uint8_t>(r)[c] = std::uint8_t(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  return out;
}

// Two frames of a shear with noise of that shape.
class Sheared final : public image::FrameSource {
 public:
  Sheared(const NoiseShape& shape, double deviation) {
    image::TextureOptions texture;
    texture.seed = 41;
    const image::SyntheticPair clean = image::synthetic_pair(image::triangle_shear(0.03), side, side, texture);
    images_.push_back(noisy(clean.first.view(), shape, deviation, 5));
    images_.push_back(noisy(clean.second.view(), shape, deviation, 6));
    for (int k = 0; k < 2; ++k) frames_.push_back({.name = "", .time = double(k)});
  }
  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return true; }
  int width() const override { return side; }
  int height() const override { return side; }
  Image read(int index) override {
    const ImageView v = images_[std::size_t(index)].view();
    Image copy(v.width, v.height, v.depth, v.white);
    std::copy_n(v.data, v.stride * v.height, reinterpret_cast<std::byte*>(copy.row<std::uint8_t>(0)));
    return copy;
  }

 private:
  std::vector<Image> images_;
  std::vector<Frame> frames_;
};

NoiseShape found_between(const Image& first, const Image& second, const KnownPairs& known) {
  piv::PairCorrelator correlator({}, known.nodes, side, side, 1);
  return noise_shape(first, second, known.nodes, correlator.correlate(first.view(), second.view(), {}), known.scored);
}

TEST(FrameNoise, DrawnNoiseIsAlikeAsItsShapeSays) {
  const NoiseShape shape = along_rows();
  EXPECT_NEAR(shape.correlation(0, 0), 1, 1e-12);
  EXPECT_NEAR(shape.correlation(1, 0), 4.0 / 6, 1e-12);
  EXPECT_NEAR(shape.correlation(2, 0), 1.0 / 6, 1e-12);
  EXPECT_EQ(shape.correlation(0, 1), 0);
  const std::vector<float> noise = shape.draw(400, 300, 9);
  double square = 0, next = 0, below = 0;
  for (std::size_t r = 0; r + 1 < 300; ++r)
    for (std::size_t c = 0; c + 1 < 400; ++c) {
      const double v = double(noise[r * 400 + c]);
      square += v * v, next += v * double(noise[r * 400 + c + 1]), below += v * double(noise[(r + 1) * 400 + c]);
    }
  EXPECT_NEAR(square / (299 * 399), 1, 0.03);  // four standard errors, of values that are alike
  EXPECT_NEAR(next / square, 4.0 / 6, 0.02);
  EXPECT_NEAR(below / square, 0, 0.02);
}

TEST(FrameNoise, OfFramesIsFoundAndPutIntoTheirPairs) {
  const Case c = parse_case("[frames]\npath = \"x.png\"\n[grid]\nspacing_px = 8\n", "a case", ".");
  const Setting setting = make_setting(c, side, side);
  for (const bool alike : {false, true}) {
    SCOPED_TRACE(alike ? "alike along rows" : "independent");
    Sheared frames(alike ? along_rows() : NoiseShape(), 10);
    const CarriedFrame carried = carried_frame(c, setting, frames, 1, silent);
    const KnownPairs& known = carried.known;
    const double row = alike ? 4.0 / 6 : 0, next = alike ? 1.0 / 6 : 0;
    const NoiseShape of_frames = found_between(frames.read(0), frames.read(1), known);
    EXPECT_NEAR(of_frames.correlation(1, 0), row, 0.06);
    EXPECT_NEAR(of_frames.correlation(2, 0), next, 0.06);
    EXPECT_NEAR(of_frames.correlation(0, 1), 0, 0.06);
    const KnownPair pair = carried.pair("shift", image::uniform(2.3, -1.4), 1);
    const NoiseShape of_pair = found_between(pair.first, pair.second, known);
    EXPECT_NEAR(of_pair.correlation(1, 0), of_frames.correlation(1, 0), 0.06);
    EXPECT_NEAR(of_pair.correlation(2, 0), of_frames.correlation(2, 0), 0.06);
    EXPECT_NEAR(of_pair.correlation(0, 1), of_frames.correlation(0, 1), 0.06);
  }
}

}  // namespace
}  // namespace pivnp::app

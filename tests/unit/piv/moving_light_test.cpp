// Shadows with sharp edges that move over material: opaque grains drawn by tests/support/shaded_grains.hpp.
//   criterion: at most 1 % of the vectors are valid and off by more than 0.15 px, with a shadow and without.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/sampling/even_light.hpp"
#include "tests/support/shaded_grains.hpp"

namespace pivnp::piv {
namespace {

constexpr int side = 224;

Image frame_of(const grains::Scene& s, int k) {
  Image out(s.width, s.height, PixelDepth::u8, 255);
  const std::vector<std::uint8_t> grey = grains::draw(s, k);
  std::copy(grey.begin(), grey.end(), out.row<std::uint8_t>(0));
  return out;
}

// A vortex under a shadow whose edge passes through its middle.
grains::Scene under_shadow(double depth, unsigned seed) {
  grains::Scene s;
  s.width = s.height = side, s.seed = seed;
  s.soil = grains::soils().front();
  s.place = [](grains::Place X, int k) {
    const double x = X.x - 112, y = X.y - 112, turn = 2.1 * k / 55 * std::exp(0.5 * (1 - (x * x + y * y) / (55 * 55)));
    return grains::Place{112 + std::cos(turn) * x - std::sin(turn) * y, 112 + std::sin(turn) * x + std::cos(turn) * y};
  };
  if (depth > 0)
    s.light = [=](double c, double r, int k) { return 1 - depth * std::clamp(0.5 - (0.9 * c - 0.43 * r - 60 - 4.7 * k), 0.0, 1.0); };
  return s;
}

// Share of the vectors that are valid and off by more than 0.15 px, of those 24 px within the frame.
double silent(const grains::Scene& s) {
  const Image first = frame_of(s, 0), second = frame_of(s, 1);
  NodeLattice nodes;
  for (int r = 24; r < side - 24; r += 8)
    for (int c = 24; c < side - 24; c += 8) nodes.pixel.push_back({float(c), float(r)});
  nodes.nx = nodes.ny = (side - 48 + 7) / 8;
  PairCorrelator correlator(PivOptions{}, nodes, side, side, 1);
  const PixelVectors found = correlator.correlate(first.view(), second.view(), {});
  double wrong = 0;
  for (std::size_t n = 0; n < nodes.pixel.size(); ++n) {
    if (found.status[n] != VectorStatus::valid) continue;
    // Central anchor: the material that is at the node midway; the vortex turns it by half an angle to either side.
    const double x = double(nodes.pixel[n][0]) - 112, y = double(nodes.pixel[n][1]) - 112;
    const double chord = 2 * std::tan(0.5 * 2.1 / 55 * std::exp(0.5 * (1 - (x * x + y * y) / (55 * 55))));
    wrong += std::hypot(double(found.displacement[n][0]) + chord * y, double(found.displacement[n][1]) - chord * x) > 0.15;
  }
  return wrong / double(nodes.pixel.size());
}

TEST(MovingLight, ASharpShadowOverMotionThatIsNotUniform) {
  for (const double depth : {0.0, 0.2, 0.5}) EXPECT_LE(silent(under_shadow(depth, 505)), 0.01) << depth;
}

// A shadow is a factor: freed of it, grains beyond the reach of its edge look as they did.
TEST(MovingLight, EvenLightLeavesTheGrains) {
  grains::Scene lit = under_shadow(0, 506), dim = lit;
  lit.noise = dim.noise = 0;
  dim.light = [](double, double, int) { return 0.5; };
  const Image a = even_light(frame_of(lit, 0).view(), 1), b = even_light(frame_of(dim, 0).view(), 1);
  double off = 0;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) off += std::abs(double(a.view().row<float>(r)[c]) - double(b.view().row<float>(r)[c])) / (side * side);
  EXPECT_LT(off, 2);  // of 42 a standard deviation: rounding
}

}  // namespace
}  // namespace pivnp::piv

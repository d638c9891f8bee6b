// Pairs that are searched again from the pair before.
//   criterion: motion that grows from pair to pair beyond what the largest windows can find by themselves is found where each pair is near the
//   one before: right within .1 px over what both frames show. The last pair alone has no such vector.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "pivnp/piv/sequence.hpp"
#include "tests/support/piv_sequence.hpp"

namespace pivnp::piv {
namespace search_again_tests {

constexpr int side = 320;
constexpr double at[] = {-64, -30, 12, 62};  // px, of the material in each frame
constexpr int frames = 4, last_pair = frames - 2;

// Of the nodes whose material both frames of the last pair show: the share that is valid and right.
double right(const PixelVectors& vectors, const NodeLattice& nodes) {
  const double d = at[last_pair + 1] - at[last_pair];
  double asked = 0, found = 0;
  for (std::size_t n = 0; n < nodes.pixel.size(); ++n) {
    const double x = double(nodes.pixel[n][0]);
    if (x - d / 2 < 24 || x + d / 2 > side - 24) continue;
    ++asked;
    found += vectors.status[n] == VectorStatus::valid && std::abs(double(vectors.displacement[n][0]) - d) < .1 && std::abs(double(vectors.displacement[n][1])) < .1;
  }
  return found / asked;
}

TEST(SearchAgain, MotionBeyondTheWindowsReachIsFoundFromThePairBefore) {
  Sequence s{.width = side, .height = side, .frames = frames, .seed = 5, .noise = .01};
  s.place = [](const Vec2& X, int k) -> Vec2 { return X + Vec2(at[k], 0); };
  NodeLattice nodes{.nx = 18, .ny = 18, .pixel = {}, .on = {}};
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i) nodes.pixel.push_back({float(24 + 16 * i), float(24 + 16 * j)});
  SequenceCorrelator correlator({}, nodes, side, side, 1);
  for (int k = 0; k + 1 < frames; ++k) {
    const Image a = draw(s, k), b = draw(s, k + 1);
    correlator.add(a.view(), b.view(), {});
  }
  EXPECT_GT(right(correlator.last(), nodes), .9);
  PairCorrelator alone({}, nodes, side, side, 1);
  const Image a = draw(s, last_pair), b = draw(s, last_pair + 1);
  EXPECT_LT(right(alone.correlate(a.view(), b.view(), {}), nodes), .1);
}

}  // namespace search_again_tests
}  // namespace pivnp::piv

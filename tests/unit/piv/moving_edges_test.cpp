// Edges of light that move over material, on fields made by hand and on a drawn pair.
#include <gtest/gtest.h>

#include "pivnp/piv/validation/moving_edges.hpp"
#include "tests/support/piv_sequence_rows.hpp"

namespace pivnp::piv {
namespace {

// 40 x 40 points, twice as bright from column 20 on.
struct Scene {
  CellSums sums;
  std::vector<float> u, v;
  std::vector<std::uint8_t> good;

  Scene() {
    sums.lattice.nx = sums.lattice.ny = 40;
    sums.lattice.step = 8;
    for (auto& plane : sums.plane) plane.assign(sums.lattice.size(), 0.0f);
    for (std::size_t k = 0; k < sums.lattice.size(); ++k) {
      sums.plane[CellSums::usable][k] = 64;
      sums.plane[CellSums::f][k] = sums.plane[CellSums::g][k] = k % 40 < 20 ? 64 * 50.0f : 64 * 100.0f;
    }
    u.assign(sums.lattice.size(), 3.0f), v.assign(sums.lattice.size(), -1.0f), good.assign(sums.lattice.size(), 1);
  }
  void move(int from, int to, float by) {
    for (std::size_t k = 0; k < u.size(); ++k)
      if (int(k % 40) >= from && int(k % 40) < to) u[k] += by;
  }
  std::size_t rejected() {
    reject_moving_edges(sums, u, v, 0.4f, good);
    return std::size_t(std::count(good.begin(), good.end(), 0));
  }
};

TEST(MovingEdges, WhatMovesWithTheEdgeAloneIsRejected) {
  Scene s;
  s.move(18, 22, 5.0f);
  // Four columns, but for the rows at the lattice's rim, where no edge is looked for.
  EXPECT_EQ(s.rejected(), std::size_t(4 * 36));
}

TEST(MovingEdges, WhatDoesNotLeaveItsSidesStays) {
  Scene still, slip, dim, slight;
  slip.move(20, 40, 5.0f);
  dim.move(18, 22, 5.0f);
  for (std::size_t k = 0; k < dim.u.size(); ++k)
    dim.sums.plane[CellSums::f][k] = dim.sums.plane[CellSums::g][k] = 64 * 50.0f;
  slight.move(18, 22, 0.3f);
  EXPECT_EQ(still.rejected(), 0u);
  EXPECT_EQ(slip.rejected(), 0u);  // a slip line between layers of two colours
  EXPECT_EQ(dim.rejected(), 0u);   // the same motion without a step of the grey values
  EXPECT_EQ(slight.rejected(), 0u);
}

// A thin layer flows over material at rest, under air that holds nothing to measure.
TEST(MovingEdges, ALayerUnderAirStays) {
  Scene s;
  s.move(20, 24, 5.0f);
  for (std::size_t k = 0; k < s.good.size(); ++k) s.good[k] = k % 40 >= 20;
  EXPECT_EQ(s.rejected(), std::size_t(20 * 40));  // the air alone, as before
}

TEST(MovingEdges, ASharpShadowIsFlagged) {
  Sequence s{.frames = 2, .seed = 2024, .noise = .01};
  s.width = s.height = 288;
  s.texture.peak_min = .03, s.texture.peak_max = .1;
  s.place = sequence::uniform(9.3, -6.4);
  s.light = [](double x, double y, int k) { return 1 - .55 * std::clamp(0.5 - (x + .3 * y - 180 - 15 * k), 0.0, 1.0); };
  PivOptions options;
  options.replace = false;
  const sequence::Told told = sequence::told(s, sequence::measure(s, options, 2));
  EXPECT_GT(told.wrong, 50);
  EXPECT_GE(told.wrong_flagged, .97 * told.wrong);
  EXPECT_GE(told.good_kept, .98 * told.good);
}

}  // namespace
}  // namespace pivnp::piv

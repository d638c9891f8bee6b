// The planar slide of Alvarado 2018's figure 4.6 between blocks, on tied sides (uGIMP, FLIP), against the resolved band: asked for are 5 %
// of the time to 50 m and of the speed there, of the temperature and the pressure of the band, whatever cells and points. Held here: the
// time, within 5 %, and the speed, within 12 % below (docs/limits.md); heat and water to round-off; the width of the zone within 4 %.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/mpm/planar_slide.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

struct Slide {
  double permeability, thickness, cell;
  int per_element;
};

struct Both {
  PlanarSlide::State resolved;
  SlideState cells;
};

Both slide(const Slide& of, BandExchange exchange = BandExchange::deviation) {
  HeatedBand band;
  band.permeability = of.permeability;
  band.thickness = of.thickness;
  SlideOptions o;
  o.cell = of.cell;
  o.per_element = of.per_element;
  o.exchange = exchange;
  PlanarSlide slide(band);
  slide.mass = 2020 * (std::round(o.above / o.cell) + 0.5 * o.rows) * o.cell;
  const PlanarSlide::State resolved = slide.after(50);
  return {resolved, run_slide(slide, o, 50, 1.6 * resolved.time)};
}

TEST(ThermalSlide, IsTheResolvedOneWhateverTheCells) {
  const Slide rows[] = {{1e-11, 0.01, 2, 4},  {1e-11, 0.01, 1, 4},  {1e-11, 0.01, 1, 9},  {1e-11, 0.01, 1, 16}, {1e-11, 0.001, 1, 4},
                        {1e-11, 0.1, 1, 4},   {1e-11, 0.001, 2, 4}, {1e-11, 0.1, 2, 4},   {1e-9, 0.01, 1, 4},   {1e-9, 0.01, 2, 4},
                        {1e-8, 0.01, 1, 4},   {1e-8, 0.01, 2, 4},   {1e-7, 0.01, 2, 4}};
  for (const Slide& row : rows) {
    const auto [resolved, cells] = slide(row);
    const testing::ScopedTrace trace(__FILE__, __LINE__, testing::Message() << "K " << row.permeability << " L " << row.thickness << " cell " << row.cell
                                     << " points " << row.per_element << " speed " << cells.speed << " of " << resolved.speed);
    EXPECT_NEAR(cells.time, resolved.time, 0.05 * resolved.time);
    EXPECT_NEAR(cells.speed, resolved.speed, 0.12 * resolved.speed);
    EXPECT_NEAR(cells.width, row.cell, 0.04 * row.cell);
    EXPECT_LT(std::abs(cells.heat_lost), 1e-9);
    EXPECT_LT(std::abs(cells.water_lost), 1e-12);
    EXPECT_LT(std::abs(cells.residual), 2e-3);
  }
}

// The exchange as printed: with heat that gets lost, and times that do not tell permeabilities apart which change them by half.
TEST(ThermalSlide, AsPrintedItIsNot) {
  const Both tight = slide({1e-11, 0.01, 1, 4}, BandExchange::printed), open = slide({1e-8, 0.01, 1, 4}, BandExchange::printed);
  EXPECT_GT(open.resolved.time, 1.35 * tight.resolved.time);
  EXPECT_LT(open.cells.time, 1.05 * tight.cells.time);
  EXPECT_GT(tight.cells.time, 1.1 * tight.resolved.time);
  EXPECT_LT(tight.cells.heat_lost, -0.5);
}

}  // namespace
}  // namespace pivnp::mpm

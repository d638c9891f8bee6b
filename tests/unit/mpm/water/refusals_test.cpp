// Water that does not fit a scene is refused in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

#include "mpm/material/model.hpp"
#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using pivnp::test::refusal;
using ::testing::HasSubstr;

TEST(PoreWater, RefusesWhatDoesNotFit) {
  const auto told = [](const std::function<void(Scene&, MpmOptions&)>& change) {
    return refusal([&] {
      const WaterColumn c = small_column();
      Scene s = scene_of(c);
      MpmOptions o = options_of(c);
      change(s, o);
      Solver(o, s, 1);
    });
  };
  EXPECT_EQ(told([](Scene&, MpmOptions&) {}), "");
  const std::string material = "material.soil.";
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.materials[0].porosity = 1; }), HasSubstr(material + "porosity"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.materials[0].permeability_m_s.reset(); }), HasSubstr(material + "permeability_m_s"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.materials[0].density_kg_m3 = 2000; }), HasSubstr(material + "density_kg_m3"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.materials[0].grain_density_kg_m3 = -1; }), HasSubstr(material + "grain_density_kg_m3"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.water.reset(), o.pressure.reset(); s.boundaries.pop_back(); }), HasSubstr(material + "porosity"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.materials[0] = elastic(1e6, 0.3, 2000); }), HasSubstr("water"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.materials[0] = elastic(1e6, 0.3, 2000), s.water.reset(), o.pressure.reset(); }), HasSubstr("boundary.load.drained"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.materials[0] = elastic(1e6, 0.3, 2000), s.water.reset(), s.boundaries.pop_back(), o.pressure = PressureScheme::in_steps; }),
              HasSubstr("mpm.pressure"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.boundaries.back().second.pressure_pa = 1; }), HasSubstr("boundary.load"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.water->level_m = 1, s.water->level_history = {{0, 1}}; }), HasSubstr("water.level_history"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.water->level_history = {{1, 1}, {1, 2}}; }), HasSubstr("water.level_history: entry 2"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.water->groundwater = Groundwater::level; }), HasSubstr("water.groundwater"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.water->groundwater = Groundwater::level, s.water->level_m = 1, o.pressure = PressureScheme::projected, o.initial_equilibrium = true; }), HasSubstr("water.groundwater"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.water->groundwater = Groundwater::level, s.water->level_m = 1, s.water->start = WaterStart::seepage; }), HasSubstr("water.start"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) { s.water->groundwater = Groundwater::level, s.water->level_m = 1, s.water->surface_m = {{0, 1}, {1, 1}}; }), HasSubstr("water.surface_m"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.water->level_history = {{0, 1}}, o.gravity_m_s2 = {5, -5}; }), HasSubstr("water.level_history"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.water->level_m = 1, o.gravity_m_s2 = {5, -5}; }), HasSubstr("water.level_m"));
  EXPECT_THAT(told([](Scene&, MpmOptions& o) { o.gravity_m_s2 = {0, -9.81}, o.initial_equilibrium = true; }), HasSubstr("water.level_m"));
  const auto inert = [&](const std::function<void(Scene&, MpmOptions&)>& change) {
    return told([&](Scene& s, MpmOptions& o) {
      s.water->inertia = true;
      change(s, o);
    });
  };
  EXPECT_EQ(inert([](Scene&, MpmOptions&) {}), "");
  EXPECT_THAT(inert([](Scene&, MpmOptions& o) { o.pressure = PressureScheme::projected; }),
              HasSubstr("water.inertia: found true beside mpm.pressure"));
  EXPECT_THAT(inert([](Scene& s, MpmOptions& o) {
                s.water->level_m = 0.03, o.gravity_m_s2 = {0, -9.81};
              }),
              HasSubstr("water.inertia: found true beside pores that are not full"));
  EXPECT_THAT(inert([](Scene& s, MpmOptions&) { s.materials[0].permeability = PermeabilityLaw::kozeny_carman; }),
              HasSubstr("water.inertia: found true beside materials"));
  EXPECT_THAT(inert([](Scene& s, MpmOptions&) { s.water->groundwater = Groundwater::level, s.water->level_m = 1; }),
              HasSubstr("water.inertia: found true beside water.groundwater"));
  EXPECT_THAT(inert([](Scene& s, MpmOptions&) {
                s.boundaries[1].second.type = BoundaryType::tied;
                s.boundaries[1].second.across_m = Pair{0.02, 0};
                s.boundaries.erase(s.boundaries.begin() + 2);
              }),
              HasSubstr("water.inertia: found true beside a tied boundary"));
  EXPECT_THAT(told([](Scene& s, MpmOptions& o) { s.water->inertia = true, o.sleep_below_m_s = 1; }), HasSubstr("mpm.sleep_below_m_s: given beside water.inertia"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) {
                BoundaryOptions across = line({0, 0.03}, {0.02, 0.03}, "fixed");
                across.drained = true;
                s.boundaries.emplace_back("sieve", across);
              }),
              HasSubstr("boundary.sieve.drained"));
  EXPECT_THAT(told([](Scene& s, MpmOptions&) {
                BoundaryOptions oblique = line({0, 0}, {0.02, 0.001}, "fixed");
                oblique.flux_m_s = 1;
                s.boundaries.emplace_back("oblique", oblique);
              }),
              HasSubstr("boundary.oblique.flux_m_s"));
}

TEST(PoreWater, KeysOfAMaterialGoTogether) {
  const auto fault = [](const std::function<void(MaterialOptions&)>& change) {
    MaterialOptions m = saturated(1e6, 0.3, 0.3, 1e-5);
    change(m);
    try {
      check_material(m);
    } catch (const MaterialFault& found) {
      return found.key;
    }
    return std::string();
  };
  EXPECT_EQ(fault([](auto&) {}), "");
  EXPECT_EQ(fault([](auto& m) { m.permeability_m_s.reset(), m.drained = true; }), "");
  EXPECT_EQ(fault([](auto& m) { m.porosity = 0; }), "porosity");
  EXPECT_EQ(fault([](auto& m) { m.porosity = 1.5; }), "porosity");
  EXPECT_EQ(fault([](auto& m) { m.porosity.reset(), m.density_kg_m3 = 2000; }), "permeability_m_s");
  EXPECT_EQ(fault([](auto& m) { m.porosity.reset(), m.permeability_m_s.reset(), m.density_kg_m3 = 2000, m.drained = true; }), "drained");
  EXPECT_EQ(fault([](auto& m) { m.permeability_m_s = -1; }), "permeability_m_s");
  EXPECT_EQ(fault([](auto& m) { m.density_end_kg_m3 = 1, m.density_until_s = 1; }), "density_end_kg_m3");
  const MaterialOptions dry = without_pores(saturated(1e6, 0.3, 0.25, 1e-5, 2600), WaterOptions{});
  EXPECT_EQ(dry.density_kg_m3, 0.75 * 2600 + 250);
  EXPECT_FALSE(dry.porosity);
}

}  // namespace
}  // namespace pivnp::mpm

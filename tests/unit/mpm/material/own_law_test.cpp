// A law is a row: one that is added from outside is made, stepped, sorted, saved and recorded like those that are built in,
// with its own keys, rules and history. And what no part of a case needs has no values.
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/material/own_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <type_traits>

#include "mpm/scene/memory.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/state/node_fields.hpp"
#include "mpm/state/particle_fields.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

MaterialOptions own(double scale = 1) {
  MaterialOptions m = elastic(1e5, 0.3, 1000);
  m.model = "of_a_test";
  m.own_value("scale_of_test") = scale;
  return m;
}

// A column that falls apart, so that points change cells and the storage is sorted.
Scene falling(const MaterialOptions& material) {
  Scene s = column(0.2, material);
  s.grid.nx = 41;
  s.boundaries = {{"base", line({0, 0}, {0.4, 0}, "frictional", 0.2)}, {"left", line({0, 0}, {0, 0.24}, "roller")}};
  for (const Vec2& x : s.particles.x0) s.v0.push_back(Vec2(3 * x.y(), -x.y()));
  return s;
}

MpmOptions falling_options() {
  MpmOptions o = options({0, -9.81});
  o.locking = Locking::none;
  o.end_at_rest = false;
  return o;
}

TEST(OwnLaw, IsMadeByItsNameAndHeldToItsRules) {
  const auto fault = [](const MaterialOptions& o) -> std::string {
    try {
      check_material(o);
    } catch (const MaterialFault& f) {
      return f.key;
    }
    return "";
  };
  EXPECT_EQ(fault(own()), "model");
  EXPECT_THROW(make_material(own(), "material.a"), InputError);
  const OwnLawListed listed;
  EXPECT_EQ(fault(own()), "");
  EXPECT_NE(dynamic_cast<const OwnLaw*>(make_material(own(), "material.a").get()), nullptr);
  EXPECT_EQ(material_model_names().back(), "of_a_test");
  MaterialOptions o = own();
  o.own.clear();
  EXPECT_EQ(fault(o), "scale_of_test");  // missing
  EXPECT_EQ(fault(own(20)), "scale_of_test");
  EXPECT_EQ(fault(own(std::nan(""))), "scale_of_test");
  o = own();
  o.friction_deg = 11;
  EXPECT_EQ(fault(o), "scale_of_test");
  o = sand(30);
  o.own_value("scale_of_test") = 1.0;
  EXPECT_EQ(fault(o), "scale_of_test");  // another law does not take it
  o = own();
  o.reduction_factor = 2.0;
  EXPECT_EQ(fault(o), "reduction_factor");  // it has no strength
  o = own();
  o.softening_shape = 1;
  EXPECT_EQ(fault(o), "softening_shape");
}

TEST(OwnLaw, ItsHistoryStaysWithItsPointThroughStepsSortsAndRestarts) {
  const OwnLawListed listed;
  const Scene s = falling(own());
  Solver solver(falling_options(), s, 2);
  solver.advance_to(0.1, silent);
  const std::vector<std::byte> saved = solver.save();
  solver.advance_to(0.2, silent);
  const MotionFrame frame = solver.frame();
  double most = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    if (frame.status[k] == ParticleStatus::ended) continue;
    const auto& F = frame.F[k];
    const double volume = double(F[0]) * double(F[3]) - double(F[1]) * double(F[2]);
    ASSERT_NEAR(double(frame.field("volume_of_test")(k)), std::log(volume), 1e-4) << k;
    ASSERT_EQ(frame.field("strained_of_test")(k), 1);
    most = std::max(most, std::abs(std::log(volume)));
  }
  EXPECT_GT(most, 0.01);
  EXPECT_EQ(frame.find("axes_of_test"), nullptr);
  Solver again(falling_options(), s, 1);
  again.load(saved);
  again.advance_to(0.2, silent);
  EXPECT_TRUE(again.save() == solver.save());
  EXPECT_THROW(Solver(falling_options(), falling(elastic(1e5, 0.3, 1000)), 1).load(saved), InputError);
}

TEST(OwnLaw, BesideAnotherEachHasItsOwnHistory) {
  const OwnLawListed listed;
  MaterialOptions clay = elastic(1e6, 0.3, 1000);
  clay.model = "von_mises";
  clay.shear_strength_pa = 100;
  const Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 31, 31},
                        {rectangle("a", 0.05, 0.05, 0.1, 0.1), rectangle("b", 0.1, 0.05, 0.15, 0.1)}, {clay, own()});
  const Scheme scheme = scheme_of(options());
  const Materials laws = materials_of(s);
  Particles p = initial_state(s, scheme, GridState(s.grid, scheme.shape), laws).particles;
  ASSERT_EQ(p.history.numbers.size(), 5u);  // plastic strain and work; volume and two axes
  ASSERT_EQ(p.bodies.size(), 2u);
  const StressBatch first = batch_of(p, p.bodies[0], 0, 1), second = batch_of(p, p.bodies[1], p.bodies[1].begin, 1);
  EXPECT_EQ(first.history[0], p.history.find("plastic_dev")->data());
  EXPECT_EQ(first.history[1], p.history.find("dissipated")->data());
  EXPECT_EQ(first.history[2], nullptr);
  EXPECT_EQ(second.history[0], p.history.find("volume_of_test")->data() + p.bodies[1].begin);
  EXPECT_EQ(second.flags[0], p.history.flags[0].data() + p.bodies[1].begin);
  EXPECT_EQ(second.part(3, 2).history[2], second.history[2] + 3);
  for (std::size_t k = 0; k < p.size(); ++k) {
    for (Array& values : p.history.numbers) values[k] = p.x[k];
    p.history.flags[0][k] = std::uint8_t(p.index[k] % 251);
  }
  std::vector<std::uint32_t> order(p.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = std::uint32_t((k * 37 + 11) % order.size());
  std::fill(p.cell.begin(), p.cell.end(), 0);
  ASSERT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), order.size());
  p.sort_as(order, 2);
  EXPECT_FALSE(std::is_sorted(p.index.begin(), p.index.end()));
  for (std::size_t k = 0; k < p.size(); ++k) {
    for (const Array& values : p.history.numbers) ASSERT_EQ(values[k], p.x[k]);
    ASSERT_EQ(p.history.flags[0][k], std::uint8_t(p.index[k] % 251));
  }
  p.history.reset();
  EXPECT_EQ(p.history.numbers[2][0], 0);
  EXPECT_NE(p.history.numbers[3][0], 0);  // declared to stay
}

TEST(History, AnElasticCaseHasNoneAndIsRecordedLikeTheOthers) {
  const Scene s = falling(elastic(1e5, 0.3, 1000));
  const Scheme scheme = scheme_of(falling_options());
  const SolverState state = initial_state(s, scheme, GridState(s.grid, scheme.shape), materials_of(s));
  EXPECT_TRUE(state.particles.history.numbers.empty());
  EXPECT_TRUE(state.particles.history.flags.empty());
  EXPECT_EQ(state.particles.view().opening, nullptr);
  const MotionFrame frame = frame_of(state, s.particles);
  ASSERT_NE(frame.find("plastic_dev"), nullptr);
  EXPECT_EQ(frame.field("plastic_dev")(0), 0);
  EXPECT_EQ(frame.find("opening"), nullptr);
}

TEST(ParticleFields, OnlyWhatIsNeededHasValues) {
  const auto held = [](const ParticleNeeds& needs) {
    Particles p;
    p.resize(7, needs);
    std::set<std::string> names;
    for_each_particle_field([&](const ParticleField& field, const auto&... column) {
      const std::size_t sizes[] = {(p.*column.values).size()...};
      for (const std::size_t size : sizes) EXPECT_EQ(size, sizes[0]) << field.name;
      if (sizes[0] == 7) names.emplace(field.name);
    });
    return names;
  };
  const std::set<std::string> least = held({});
  EXPECT_EQ(least, (std::set<std::string>{"place", "velocity", "volume0", "F", "J", "stress", "cell", "index"}));
  for (bool ParticleNeeds::*need : {&ParticleNeeds::own_mass, &ParticleNeeds::affine, &ParticleNeeds::sized, &ParticleNeeds::tied,
                                    &ParticleNeeds::kept, &ParticleNeeds::increments, &ParticleNeeds::averaged}) {
    ParticleNeeds needs;
    needs.*need = true;
    EXPECT_EQ(held(needs).size(), least.size() + 1);
  }
  EXPECT_EQ(held({.wet = true}).size(), least.size() + 3);
}

TEST(ParticleFields, EveryRecordedOneIsAMotionField) {
  for_each_particle_field([](const ParticleField& field, const auto&... column) {
    if (field.recorded.empty()) return;
    const MotionField* row = motion_fields().find(field.recorded);
    ASSERT_NE(row, nullptr) << field.name;
    EXPECT_EQ(row->components(), sizeof...(column));
  });
}

// What Particles holds but the laws' history is sized, sorted and saved by the list.
TEST(ParticleFields, NoneIsForgotten) {
  static const Particles p;
  std::size_t listed = 0;
  for_each_particle_field([&](const ParticleField&, const auto&... column) {
    const auto add = [&](const auto& c) { listed += sizeof(p.*c.values); };
    (add(column), ...);
  });
  EXPECT_EQ(listed, std::size_t(reinterpret_cast<const char*>(&p.history) - reinterpret_cast<const char*>(&p)));
}

// What a case does not need takes no memory: of Particles themselves, and as it is counted before there are any.
TEST(ParticleFields, MemoryIsThatOfTheFieldsNeeded) {
  const Materials none;
  for (const ParticleNeeds& needs : {ParticleNeeds{}, ParticleNeeds{.affine = true}, ParticleNeeds{.affine = true, .wet = true}}) {
    Particles p;
    p.resize(10, needs);
    std::size_t bytes = 0;
    for_each_particle_field([&](const ParticleField&, const auto&... column) {
      const auto add = [&](const auto& c) {
        const auto& values = p.*c.values;
        bytes += values.capacity() * sizeof(values[0]);
      };
      (add(column), ...);
    });
    EXPECT_EQ(double(bytes), 10 * bytes_a_point(needs, none));
  }
}

// What a case does not need takes no memory: of the arrays themselves, and as it is counted before there are any.
TEST(NodeFields, MemoryIsThatOfTheFieldsNeeded) {
  for (const NodeNeeds& needs : {NodeNeeds{}, NodeNeeds{.averages = true}, NodeNeeds{.filtered = true, .loads = true},
                                 NodeNeeds{.own_strain_velocity = true, .wet = true, .averaged = true}}) {
    const Grid grid{{0, 0}, {1, 1}, 5, 5};
    GridState g(grid, ShapeKind::bilinear, 1, true, needs);
    double bytes = sizeof(Node);
    for_each_node_field([&](const NodeField& field, const auto&... member) {
      const auto add = [&]<class Values, class Owner>(Values Owner::*values) {
        if constexpr (std::is_same_v<Owner, NodeArrays>) {
          const Values& array = g.arrays.*values;
          EXPECT_TRUE(array.size() == 0 || array.size() >= g.grid.node_count()) << field.name;
          if (array.size() > 0) bytes += sizeof(typename Values::value_type);
        }
      };
      (add(member), ...);
    });
    EXPECT_EQ(bytes, bytes_a_node(needs));
  }
  EXPECT_EQ(bytes_a_node({}), sizeof(Node));
  EXPECT_EQ(bytes_a_node({.averages = true}), sizeof(Node) + sizeof(CellEdges) + sizeof(CornerSums) + 2 * sizeof(AlongAxes));
  EXPECT_EQ(bytes_a_node({.wet = true}), sizeof(Node) + sizeof(PoreNode) + sizeof(PoreElement) + sizeof(PoreMark) + 5 * sizeof(double) + 5 * sizeof(float));
  EXPECT_EQ(bytes_a_node({.wet = true, .wet_soils = true}), bytes_a_node({.wet = true}) + sizeof(double));
  const Materials none;  // four points a cell: 64 bytes more for each
  EXPECT_LE(bytes_a_point({.own_mass = true, .wet = true}, none) - bytes_a_point({}, none) + (bytes_a_node({.wet = true}) - bytes_a_node({})) / 4, 64);
  Scheme scheme;
  EXPECT_TRUE(node_needs(scheme, {}, {}).averages);
  EXPECT_FALSE(node_needs(scheme, {}, {}).filtered);
  scheme.shape = ShapeKind::bilinear;
  scheme.transfer = TransferKind::xpic;
  EXPECT_FALSE(node_needs(scheme, {}, {.water = true}).averages);
  EXPECT_TRUE(node_needs(scheme, {}, {.water = true}).filtered);
  EXPECT_TRUE(node_needs(scheme, {}, {.water = true}).wet);
}

// Every byte of a node's line but its end is a listed field's.
TEST(NodeFields, TheLineHoldsNoOther) {
  static const Node node;
  std::size_t listed = 0, end = 0;
  std::set<std::string_view> names;
  for_each_node_field([&](const NodeField& field, const auto&... component) {
    EXPECT_TRUE(names.insert(field.name).second);
    const auto look = [&]<class Values, class Owner>(Values Owner::*c) {
      if constexpr (std::is_same_v<Owner, Node>) {
        EXPECT_EQ(field.need, nullptr) << field.name;
        const auto* at = reinterpret_cast<const char*>(&(node.*c));
        listed += sizeof(node.*c);
        end = std::max(end, std::size_t(at - reinterpret_cast<const char*>(&node)) + sizeof(node.*c));
      } else {
        EXPECT_NE(field.need, nullptr) << field.name;
      }
    };
    (look(component), ...);
  });
  EXPECT_EQ(listed, end);
  EXPECT_LT(sizeof(Node) - end, sizeof(double));
}

}  // namespace
}  // namespace pivnp::mpm

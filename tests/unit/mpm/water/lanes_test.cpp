// The flow's kernels in lanes against plain loops, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "mpm/grid/sweeps.hpp"
#include "mpm/step/energy.hpp"
#include "mpm/water/pore_lanes.hpp"
#include "mpm/water/pore_projection_lanes.hpp"
#include "tests/unit/mpm/disorder.hpp"
#include "tests/unit/mpm/every_target.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// Points in no order, some dry, some without pores; nodes with numbers of their own.
struct Pores : Case {
  std::mt19937_64 random{seed_of_all + 2};
  Array pressure, content, J_flow, mobility, solid;
  std::size_t before, nodes;
  std::vector<PoreNode> node;
  std::vector<PoreElement> element;
  std::vector<std::vector<double>> arrays;
  std::vector<std::vector<float>> weights;
  PoreFields f{};
  PoreView w{};

  explicit Pores(ShapeKind shape, bool varied)
      : Case(shape, TransferKind::flip), before(std::size_t(g.grid.nx) + 8), nodes(g.grid.node_count() + 2 * before), node(nodes), element(nodes) {
    Particles& p = state.particles;
    const std::size_t n = p.size();
    for (Array* a : {&pressure, &content, &J_flow}) a->resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      p.J[k] = 1 + 0.1 * u();
      J_flow[k] = p.J[k] + 1e-3 * u();
      pressure[k] = 1e4 * u();
      content[k] = k % 7 == 0 ? 0 : 0.4 + 0.01 * u();
    }
    if (varied) {
      mobility.resize(n);
      solid.resize(n);
      for (std::size_t k = 0; k < n; ++k) {
        mobility[k] = k % 11 == 0 ? no_pores_mobility : k % 5 == 0 ? drained_mobility : 1e-9 * (2 + u());
        solid[k] = 0.6 + 0.1 * u();
      }
    }
    w = {pressure.data(), content.data(), J_flow.data(), varied ? mobility.data() : nullptr, varied ? solid.data() : nullptr,
         1e-9, 0.6, 1e9, 100, -9000, 17, 9810, 0.1, false};
    for (int k = 0; k < 8; ++k) arrays.emplace_back(nodes, 0.0);
    for (int k = 0; k < 5; ++k) weights.emplace_back(nodes, 0.0f);
    const auto field = [&](int k) { return arrays[std::size_t(k)].data() + before; };
    const auto weight = [&](int k) { return weights[std::size_t(k)].data() + before; };
    f = {field(0), field(1), field(2), field(3), field(4), field(5), weight(0), weight(1), weight(2), weight(3), weight(4), field(6), field(7), g.grid.nx};
    if (!varied) f.rate = nullptr;
  }
  double u() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  PoreSumsView sums() { return {node.data() + before, element.data() + before}; }
  bool holds(std::size_t k) const { return content[k] > 0 && (mobility.empty() || mobility[k] >= 0); }
  double head(std::size_t k) const { return w.head_x * state.particles.x[k] + w.head_y * state.particles.y[k] + w.head_0; }
  double mobility_of(std::size_t k) const { return mobility.empty() ? w.mobility_all : mobility[k]; }
  double pores_of(std::size_t k) const { return state.particles.J[k] - (solid.empty() ? w.solid_all : solid[k]); }

  // The element of a point, its place there, and the four nodes' hats.
  struct At {
    std::size_t element, node[4];
    double s, t, hat[4];
  };
  At at(std::size_t k) const {
    const Vec2 place = (Vec2(state.particles.x[k], state.particles.y[k]) - g.field_grid.origin).cwiseQuotient(g.grid.spacing);
    const Vec2 inside = g.natural(state.particles, k);
    At a{};
    std::size_t i = std::size_t(state.particles.cell[k]) % std::size_t(g.grid.nx), j = std::size_t(state.particles.cell[k]) / std::size_t(g.grid.nx);
    if (g.centred) {
      i += inside.x() < 0 ? 0 : 1;
      j += inside.y() < 0 ? 0 : 1;
    }
    a.s = place.x() - double(i);
    a.t = place.y() - double(j);
    a.element = g.grid.node(int(i), int(j));
    const auto row = std::size_t(g.grid.nx);
    const std::array<std::size_t, 4> corners{a.element, a.element + 1, a.element + row, a.element + row + 1};
    std::copy(corners.begin(), corners.end(), a.node);
    for (int c = 0; c < 4; ++c) a.hat[c] = (c % 2 ? a.s : 1 - a.s) * (c / 2 ? a.t : 1 - a.t);
    return a;
  }
  double spanned(const At& a, const double* values) const {
    double sum = 0;
    for (int c = 0; c < 4; ++c) sum += a.hat[c] * values[a.node[c]];
    return sum;
  }
  void map() {
    const PointView points = state.particles.view();
    const CellView cells = g.view();
    for (const Range& run : g.active.mapped.runs) map_pores_lanes(g.centred, points, w, cells, sums(), run);
  }
  void randomize(const std::vector<double*>& fields, double scale) {
    for (double* values : fields)
      for (std::size_t n = 0; n < g.grid.node_count(); ++n) values[n] = scale * u();
  }
};

template <class Body>
void for_all_cases(Body&& body) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline})
    for (const bool varied : {false, true}) {
      SCOPED_TRACE(std::string(name_of(shape)) + (varied ? ", varied" : ""));
      on_every_target([&] {
        Pores c(shape, varied);
        body(c);
      });
    }
}

TEST(PoreLanes, SumsOfNodesAndElements) {
  for_all_cases([](Pores& c) {
    c.map();
    std::vector<PoreNode> node(c.g.grid.node_count());
    std::vector<PoreElement> element(node.size());
    const Particles& p = c.state.particles;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (!c.holds(k)) continue;
      const Pores::At a = c.at(k);
      const double v = p.volume0[k] * p.J[k], pores = p.volume0[k] * c.pores_of(k);
      const double mobile = c.mobility.empty() ? pores : v * c.mobility[k];
      for (int n = 0; n < 4; ++n) {
        node[a.node[n]].volume += a.hat[n] * v;
        node[a.node[n]].potential += a.hat[n] * v * (c.mobility.empty() ? 1 : c.mobility[k]) * (c.pressure[k] - c.head(k));
        node[a.node[n]].strained += a.hat[n] * p.volume0[k] * (p.J[k] - c.J_flow[k]);
        node[a.node[n]].mobile += a.hat[n] * mobile;
      }
      element[a.element].inside += v;
      element[a.element].along_x += v * a.s * (1 - a.s);
      element[a.element].along_y += v * a.t * (1 - a.t);
      element[a.element].conducting += c.mobility.empty() ? v : v * c.mobility[k];
    }
    for (std::size_t n = 0; n < node.size(); ++n) {
      const PoreNode& seen = c.sums().node[n];
      const PoreElement& in = c.sums().element[n];
      ASSERT_NEAR(seen.volume, node[n].volume, 1e-15);
      ASSERT_NEAR(seen.potential, node[n].potential, 1e-11);
      ASSERT_NEAR(seen.strained, node[n].strained, 1e-17);
      ASSERT_NEAR(seen.mobile, node[n].mobile, 1e-15);
      ASSERT_NEAR(in.inside, element[n].inside, 1e-15);
      ASSERT_NEAR(in.along_x, element[n].along_x, 1e-16);
      ASSERT_NEAR(in.along_y, element[n].along_y, 1e-16);
      ASSERT_NEAR(in.conducting, element[n].conducting, 1e-15);
    }
  });
}

// Of points that are simulated and hold water; what came in moves as its point does.
TEST(PoreLanes, MassesFollowTheWater) {
  for_all_cases([](Pores& c) {
    for (const bool empty_too : {false, true}) {
      Particles& p = c.state.particles;
      for (Array* a : {&p.mass, &p.C_xx, &p.C_xy, &p.C_yx, &p.C_yy}) {
        a->resize(p.size());
        for (std::size_t k = 0; k < p.size(); ++k) (*a)[k] = 2 + c.u();
      }
      std::vector<std::int32_t> cell = p.cell;
      for (std::size_t k = 0; k < cell.size(); k += 3) cell[k] = Particles::ended;
      const std::vector<double> before(p.mass.begin(), p.mass.end());
      const PoreMasses of{1600, 1000, c.g.grid.spacing.x(), c.g.grid.spacing.y(), empty_too};
      Range range{8, p.size() - 1};
      const double brought = carry_water_lanes(p.view(), c.w, cell.data(), of, range);
      ASSERT_LT(p.size() - 1 - range.begin, 8u);
      double sum = 0;
      for (std::size_t k = 0; k < p.size(); ++k) {
        const bool taken = k >= 8 && k < range.begin && cell[k] >= 0 && (empty_too || c.content[k] > 0);
        const double mass = taken ? p.volume0[k] * (1600 + 1000 * c.content[k]) : before[k];
        ASSERT_DOUBLE_EQ(p.mass[k], mass) << k;
        sum += (1 - before[k] / mass) * stored_kinetic(p, c.g, k);
      }
      ASSERT_NEAR(brought, sum, 1e-12 * std::abs(sum));
    }
  });
}

TEST(PoreLanes, MeansEdgesAndExchange) {
  for_all_cases([](Pores& c) {
    c.map();
    const PoreFields& f = c.f;
    const PoreEdges edges{3e3, 5e2, 7e2, 1e-9, 0.25 * c.g.grid.spacing.prod(), 2e-6, 3e-6};
    const std::vector<std::uint32_t>& nodes = c.g.active.nodes;
    std::vector<std::uint32_t> special(nodes.size());
    special.resize(take_means_lanes(c.sums(), f, edges, nodes.data(), nodes.size(), special.data()));
    const auto row = std::ptrdiff_t(c.g.grid.nx);
    const PoreNode* node = c.sums().node;
    const PoreElement* element = c.sums().element;
    const auto mobility = [&](const PoreElement& e) { return c.mobility.empty() ? edges.mobility_all : e.inside > 0 ? e.conducting / e.inside : 0; };
    std::vector<double> share(c.nodes, 0.0);
    for (const std::uint32_t n : nodes) {
      const PoreElement &here = element[n], &left = (element + n)[-1], &below = (element + n)[-row], &across = (element + n)[-row - 1];
      const double v = node[n].volume, around = here.inside + left.inside + below.inside + across.inside;
      const bool x = v > 0 && node[n + 1].volume > 0, y = v > 0 && node[n + std::size_t(row)].volume > 0;
      const auto flow = [&](const PoreElement& e, double through, double PoreElement::*along) { return 0.5 * mobility(e) * (through * e.inside - edges.rate * e.*along); };
      const auto inert = [&](const PoreElement& e, double through, double yields) { return 0.5 * e.inside * (mobility(e) * through + yields); };
      ASSERT_EQ(f.volume[n], v);
      const double weight = c.mobility.empty() ? v : node[n].mobile;
      ASSERT_NEAR(f.potential[n], weight > 0 ? node[n].potential / weight : 0, 1e-10);
      ASSERT_NEAR(f.mean[n], v > 0 ? node[n].strained / v : 0, 1e-16);
      share[n] = f.even[n];
      ASSERT_NEAR(share[n], v > 0 ? std::min(1.0, 4 * v / around) : 0, 1e-14);
      const auto single = [](double seen, double exact, double round_off) { ASSERT_NEAR(seen, exact, round_off + 1e-7 * std::abs(exact)); };
      const auto weighs = [&](const PoreElement& e) { return c.mobility.empty() ? 1 : mobility(e); };  // (projected: inert_x is there)
      single(f.strain_x[n], x ? 0.5 * (weighs(here) * here.along_x + weighs(below) * below.along_x) : 0, 1e-17);
      single(f.strain_y[n], y ? 0.5 * (weighs(here) * here.along_y + weighs(left) * left.along_y) : 0, 1e-17);
      single(f.flow_x[n], x ? flow(here, edges.through_x, &PoreElement::along_x) + flow(below, edges.through_x, &PoreElement::along_x) : 0, 1e-20);
      single(f.flow_y[n], y ? flow(here, edges.through_y, &PoreElement::along_y) + flow(left, edges.through_y, &PoreElement::along_y) : 0, 1e-20);
      ASSERT_NEAR(f.inert_x[n], x ? inert(here, edges.through_x, edges.inert_x) + inert(below, edges.through_x, edges.inert_x) : 0, 1e-20);
      ASSERT_NEAR(f.inert_y[n], y ? inert(here, edges.through_y, edges.inert_y) + inert(left, edges.through_y, edges.inert_y) : 0, 1e-20);
      const bool empty = !(here.inside > 0 && left.inside > 0 && below.inside > 0 && across.inside > 0);
      ASSERT_EQ(std::count(special.begin(), special.end(), n), empty || v < edges.least_volume ? 1 : 0);
    }

    weigh_elements_lanes(f, nodes.data(), nodes.size());
    smooth_pores_lanes(f, f.mean, f.even, nodes.data(), nodes.size());
    for (const std::uint32_t n : nodes) {
      double gain = 0, round_off = 0;
      for (const std::ptrdiff_t e : {std::ptrdiff_t(0), std::ptrdiff_t(-1), -row, -row - 1}) {
        const std::ptrdiff_t at = std::ptrdiff_t(n) + e;
        double least = 1, mean = 0;
        for (const std::ptrdiff_t corner : {at, at + 1, at + row, at + row + 1}) {
          if (element[at].inside > 0) least = std::min(least, share[std::size_t(corner)]);
          mean += 0.25 * f.mean[corner];
        }
        const double part = 0.25 * element[at].inside * least * (mean - f.mean[n]);
        gain += part;
        round_off += 1e-7 * std::abs(part);
      }
      const double per_volume = f.volume[n] > 0 ? 1 / f.volume[n] : 0;
      ASSERT_NEAR(f.even[n], f.mean[n] + per_volume * gain, 1e-15 + per_volume * round_off);
    }

    const std::vector<double> mean(f.mean, f.mean + c.g.grid.node_count());
    exchange_pores_lanes(f, edges.rate, edges.mobility_all, nodes.data(), nodes.size());
    for (const std::uint32_t n : nodes) {
      const auto exchanged = [&](const float* x, const float* y, const double* of) {
        const double own = of[n];
        const double sum = x[n] * (of[n + 1] - own) + (x + n)[-1] * ((of + n)[-1] - own) + y[n] * (of[n + std::size_t(row)] - own) + (y + n)[-row] * ((of + n)[-row] - own);
        return f.volume[n] > 0 ? sum / f.volume[n] : 0;
      };
      const double rate = edges.rate * (f.rate ? 1 : edges.mobility_all), weight = f.rate ? f.rate[n] : 1;
      ASSERT_NEAR(f.mean[n], 2 * mean[n] - f.even[n] - exchanged(f.strain_x, f.strain_y, f.even), 1e-15);
      const double change = rate * f.potential[n] + (weight > 0 ? exchanged(f.flow_x, f.flow_y, f.potential) / weight : 0);
      ASSERT_NEAR(f.change[n], change, 1e-11 + 1e-6 * std::abs(change));
    }
  });
}

TEST(PoreLanes, WhatThePointsTake) {
  for_all_cases([](Pores& c) {
    for (const bool projected : {false, true}) {
      Particles& p = c.state.particles;
      c.randomize({c.f.change, c.f.mean}, 1e-3);
      c.randomize({c.f.even}, projected ? 1e2 : 1e-3);
      std::vector<double> share(c.nodes);
      for (double& s : share) s = 0.5 + 0.4 * c.u();
      const double rate = 1e3;
      std::vector<double> content(c.content.begin(), c.content.end()), pressure(c.pressure.begin(), c.pressure.end());
      double all = 0, by_flow = 0;
      for (std::size_t k = 0; k < p.size(); ++k) {
        const double outside = c.w.outside * std::max(0.0, c.w.level - p.y[k]);
        if (!c.holds(k)) {
          pressure[k] = !c.mobility.empty() && c.mobility[k] == no_pores_mobility ? 0 : outside;
          continue;
        }
        const Pores::At a = c.at(k);
        const double e = pressure[k] - c.head(k), J = p.J[k], strain = J - c.J_flow[k], pores = c.pores_of(k), v0 = p.volume0[k];
        if (projected) {
          const double gained = c.spanned(a, c.f.even) - c.spanned(a, share.data()) * e, more = J * (c.mobility.empty() ? 1 : c.mobility[k]) * c.spanned(a, c.f.change);
          const double taken = strain - J * c.spanned(a, c.f.mean) + more;
          content[k] += taken;
          all += v0 * (taken * c.head(k) - (pressure[k] + 0.5 * gained) * strain - pores / c.w.bulk * gained * (pressure[k] + 0.5 * gained));
          by_flow -= v0 * more * (e + 0.5 * gained);
          pressure[k] += gained;
        } else {
          const double more = J * (c.mobility.empty() ? c.spanned(a, c.f.change) - rate * c.w.mobility_all * e
                                                      : c.mobility[k] * (c.spanned(a, c.f.change) - rate * e));
          content[k] += strain - J * c.spanned(a, c.f.even);
          content[k] += more;
          pressure[k] = c.w.bulk * (content[k] / pores - 1);
          by_flow -= v0 * more * 0.5 * (e + (pressure[k] - c.head(k)));
        }
      }
      PoreLosses seen;
      for (const Range& run : c.g.active.mapped.runs) {
        if (projected) {
          const PoreLosses part = project_points_lanes(c.g.centred, p.view(), c.w, c.g.view(), c.f, share.data(), run);
          seen.all += part.all;
          seen.by_flow += part.by_flow;
        } else {
          seen.by_flow += change_points_lanes(c.g.centred, rate, p.view(), c.w, c.g.view(), c.f, run).lost;
        }
      }
      ASSERT_NEAR(seen.all, all, 1e-10 * std::abs(all));
      ASSERT_NEAR(seen.by_flow, by_flow, 1e-9 * std::abs(by_flow));
      for (std::size_t k = 0; k < p.size(); ++k) {
        if (p.cell[k] == Particles::ended) continue;
        ASSERT_NEAR(c.content[k], content[k], 1e-14);
        ASSERT_NEAR(c.pressure[k], pressure[k], projected ? 1e-5 : 1e-4);
        ASSERT_EQ(c.J_flow[k], p.J[k]);
      }
    }
  });
}

}  // namespace
}  // namespace pivnp::mpm

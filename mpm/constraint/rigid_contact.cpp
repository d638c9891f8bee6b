// What bodies and material do to each other: where they meet, and the impulses that keep them apart.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mpm/constraint/rigid_body.hpp"

namespace pivnp::mpm {

namespace {

// Of a circle's pieces, hats along it. A field across it that is 1 at the circle and falls as R/r has no divergence, as one across a
// straight side has none: the point counts as if it had so much less volume.
void pieces_around(const Vec2& arm, double radius, std::size_t pieces, const Mat2& halves, double deepest, std::vector<UnderPiece>& list) {
  const double r = arm.norm(), count = double(pieces);
  if (r < 0.5 * radius || r > radius + deepest) return;
  const Vec2 normal = arm / r;
  const double at = std::atan2(arm.y(), arm.x()) / (2 * M_PI) * count - 0.5, before = std::floor(at);
  for (const double number : {before, before + 1}) {
    const double share = 1 - std::abs(at - number), wrapped = number - count * std::floor(number / count);
    if (share > 0)
      list.push_back({std::size_t(wrapped), share * radius / r, r - radius, (at - number) * 2 * M_PI * radius / count,
                      (halves.transpose() * normal).lpNorm<1>(), normal});
  }
}

}  // namespace

// Of a point the part that lies under a side, hats along the side: the first and last piece's are even to its ends.
void RigidBodies::Body::pieces_over(const Vec2& x, const Mat2& halves, double deepest, std::vector<UnderPiece>& list) const {
  if (!polygon && !boundary) return pieces_around(x - centre, radius, surface.size(), halves, deepest, list);
  const Side* inside = nullptr;  // where the point is in the body: the nearest
  double nearest = -std::numeric_limits<double>::infinity();
  const auto take = [&](const Side& s, double depth) {
    const double half = (halves.transpose() * s.along).lpNorm<1>(), on = (x - s.start).dot(s.along);
    const double low = std::max(on - half, 0.0), high = std::min(on + half, s.length);
    if (!(low < high)) return;
    const double piece = s.length / double(s.count), at = 0.5 * (low + high) / piece - 0.5, part = (high - low) / (2 * half);
    const double across = (halves.transpose() * s.normal).lpNorm<1>(), before = std::floor(at);
    const auto add = [&](double number, double share) {
      if (number < 0 || number >= double(s.count) || share == 0) return;
      list.push_back({s.first + std::size_t(number), share * part, depth, (at - number) * piece, across, s.normal});
    };
    const double second = before < 0 ? 1 : before + 1 >= double(s.count) ? 0 : at - before;
    add(before, 1 - second);
    add(before + 1, second);
  };
  for (const Side& s : sides) {
    const double depth = (x - s.start).dot(s.normal);
    if (depth >= s.least_depth && depth <= deepest) take(s, depth);
    if (depth >= 0 || depth <= nearest || boundary) continue;
    nearest = depth;
    inside = &s;
  }
  if (inside && contains(x)) take(*inside, nearest);
}

namespace {

// Of the least mass: half a cell above a surface a quarter of a cell's mass is still felt, and the sides of a body that
// stands there would plough; at the surface itself it is a half.
constexpr double closer_when_free = 1.6;
constexpr double deepest_layer = 6;       // cells from an outline to the points that are looked at
constexpr double touching_at_rest = 0.1;  // cells between a body and a face that lie on each other at the start
constexpr double sticking = 0.02;         // cells by which a rough body may be off and still takes hold
constexpr double held_within = 1;         // cells by which what it holds may be off
constexpr int impulse_sweeps = 20;

auto pair_of(std::span<const JoinedNode> joined, std::uint32_t node) {
  const auto at = std::lower_bound(joined.begin(), joined.end(), node, [](const JoinedNode& j, std::uint32_t n) { return j.small < n; });
  return at != joined.end() && at->small == node ? at : joined.end();
}

}  // namespace

void RigidBodies::find_points_under(const Body& body, double time, const Particles& p, const GridState& g) {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const SurfacePoint& s : body.surface) {
    const Vec2 x = body.place(s.x, time);
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  layer_.begin(body.surface.size(), g.velocity_fields);
  const Mat2 back{{std::cos(body.angle), std::sin(body.angle)}, {-std::sin(body.angle), std::cos(body.angle)}};
  layer_.add(p, g, low, high, [&](const Vec2& x, const Mat2& halves, std::vector<UnderPiece>& list) {
    body.pieces_over(body.place_at_time_0(x, time), back * halves, deepest_layer * spacing_, list);
    for (UnderPiece& u : list) {
      // (About the axis the field falls with the radius about that as well.)
      if (g.axisymmetric && !body.polygon) u.share *= std::max(0.0, x.x() - u.depth * u.normal.x()) / x.x();
      u.normal = body.turned(u.normal);
    }
  });
}

// Of the nodes around a place of a velocity field those that have mass, with weights of sum 1; none outside the grid.
void RigidBodies::add_nodes_around(const Vec2& x, int field, const GridState& g, double& mass) {
  std::int32_t cell = 0;
  double xi = 0, eta = 0, weight[most_stencil_nodes], sum = 0;
  std::size_t node[most_stencil_nodes];
  mass = 0;
  if (!g.find(x.x(), x.y(), cell, xi, eta, field)) return;
  g.weights_at(cell, xi, eta, node, weight);
  const std::size_t first = shares_.size();
  for (int k = 0; k < g.stencil; ++k) {
    const double m = g.node[node[k]].mass;
    mass += weight[k] * m;
    if (!(m > 0) || !(weight[k] > 0)) continue;
    sum += weight[k];
    shares_.push_back({std::uint32_t(node[k]), weight[k]});
  }
  for (std::size_t k = first; k < shares_.size(); ++k) shares_[k].share /= sum;
}

// What has been appended to shares_ is the contact's; false: nothing that has mass.
bool RigidBodies::take_shares(Contact& c, std::span<const JoinedNode> joined, const GridState& g) {
  for (std::size_t k = c.begin; k < shares_.size() && !joined.empty(); ++k) {
    const auto pair = pair_of(joined, shares_[k].node);
    if (pair == joined.end()) continue;
    const NodeShare moved{pair->heavy, shares_[k].share};
    shares_[k].share = 0;
    const auto from = shares_.begin() + std::ptrdiff_t(c.begin);
    const auto heavy = std::find_if(from, shares_.end(), [&](const NodeShare& s) { return s.node == moved.node; });
    if (heavy == shares_.end()) shares_.push_back(moved);
    else heavy->share += moved.share;
  }
  c.end = shares_.size();
  c.per_mass = 0;
  for (std::size_t k = c.begin; k < c.end; ++k) {
    NodeShare& s = shares_[k];
    const double mass = g.node[s.node].mass;
    if (mass > 0) c.per_mass += s.share * s.share / mass;
    else s.share = 0;
  }
  if (c.per_mass > 0) return true;
  shares_.resize(c.begin);
  return false;
}

void RigidBodies::find_contacts(double time, double dt, double least_mass, std::span<const JoinedNode> joined,
                                const Particles& p, const GridState& g) {
  contacts_.clear();
  shares_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    if ((body.free && time < 0) || time >= body.removed) continue;
    if (body.nodes_inside) {
      find_nodes_inside(body, int(b), time, joined, g);
      continue;
    }
    const double least = body.free ? closer_when_free * least_mass : least_mass;
    find_points_under(body, time, p, g);
    for (std::size_t s = 0; s < body.surface.size(); ++s) {
      const SurfacePoint& point = body.surface[s];
      for (int field = 0; field < g.velocity_fields; ++field) {
        Contact c;
        c.body = int(b);
        c.x = body.place(point.x, time);
        c.normal = body.turned(point.normal);
        c.begin = shares_.size();
        double& held = body.held[s * std::size_t(fields_) + std::size_t(field)];
        const MaterialFace face = layer_.face(g, s, field, shares_, !std::isnan(held));
        if (face.state == MaterialFace::State::none) {
          held = std::numeric_limits<double>::quiet_NaN();
          continue;
        }
        if (face.state == MaterialFace::State::found) {
          const double gap = time < 0 ? 0 : face.gap;
          if (face.gap > (time < 0 && !body.boundary ? touching_at_rest : held_within) * spacing_) {
            held = std::numeric_limits<double>::quiet_NaN();
            shares_.resize(c.begin);
            continue;
          }
          c.layer = true;
          c.x += face.along * Vec2(-c.normal.y(), c.normal.x());
          c.face = face.area;
          if (gap > 0) c.part = gap / dt;
          const bool touches = gap <= sticking * spacing_ || (body.boundary && time == 0);
          c.pulls = body.grips && (touches || !std::isnan(held));
          if (c.pulls) {
            if (std::isnan(held) && time == 0) held = gap;
            c.part = 0;
          }
        } else {
          double mass = 0;
          add_nodes_around(c.x, field, g, mass);
          if (!(mass > (g.axisymmetric ? c.x.x() : 1.0) * least)) {
            shares_.resize(c.begin);
            continue;
          }
          c.pulls = body.grips;
          c.face = point.piece * (g.axisymmetric ? c.x.x() : 1.0);
        }
        if (!take_shares(c, joined, g)) continue;
        if (body.free) {
          const Vec2 arm = c.x - body.centre - body.shift, tangent(-c.normal.y(), c.normal.x());
          const double across = arm.x() * c.normal.y() - arm.y() * c.normal.x();
          const double along = arm.x() * tangent.y() - arm.y() * tangent.x();
          const double per_inertia = body.turns && !body.given(2) ? 1 / body.inertia_per_mass : 0;
          const auto freely = [&](const Vec2& way) {  // of the way, what is free
            double sum = body.table.any() ? 0 : 1;
            for (int a = 0; a < 2 && body.table.any(); ++a) sum += body.given(a) ? 0 : way[a] * way[a];
            return sum;
          };
          c.body_normal = (freely(c.normal) + across * across * per_inertia) / body.mass_now;
          c.body_along = (freely(tangent) + along * along * per_inertia) / body.mass_now;
        }
        contacts_.push_back(c);
      }
    }
  }
}

// The nodes go with the body: each is a contact of its own.
void RigidBodies::find_nodes_inside(const Body& body, int number, double time, std::span<const JoinedNode> joined, const GridState& g) {
  const double round_off = 1e-6 * spacing_;
  for (const std::uint32_t n : g.active.nodes) {
    if (!(g.node[n].mass > 0)) continue;
    const Vec2 at = body.place_at_time_0(g.place(n), time);
    Vec2 unused;
    if (!body.polygon->contains(at) && body.polygon->distance(at, unused) > round_off) continue;
    Contact c;
    c.body = number;
    c.x = g.place(n);
    c.normal = body.way.squaredNorm() > 0 ? body.way : Vec2(1, 0);
    c.pulls = true;
    c.begin = shares_.size();
    shares_.push_back({n, 1});
    if (take_shares(c, joined, g)) contacts_.push_back(c);
  }
}

// What the water bears of the normal impulses.
void RigidBodies::press(double dt, const Pressures& in_pores) {
  if (std::none_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.friction.value_or(0) > 0; })) return;
  const std::vector<std::uint32_t> nodes = touched_nodes();
  const std::vector<double> pressures = in_pores(nodes);
  for (Contact& c : contacts_) {
    double sum = 0, shares = 0;
    for (std::size_t k = c.begin; k < c.end; ++k) {
      const auto at = std::size_t(std::lower_bound(nodes.begin(), nodes.end(), shares_[k].node) - nodes.begin());
      sum += shares_[k].share * pressures[at];
      shares += shares_[k].share;
    }
    if (shares > 0) c.by_water = dt * c.face * sum / shares;
  }
}

void RigidBodies::apply(double time, double dt, double least_mass, std::span<const JoinedNode> joined, const Particles& p,
                        GridState& g, std::vector<Reaction>& reactions, const Pressures& in_pores) {
  for (Body& body : bodies_)
    if (body.moves_freely()) body.take_motion_of_step(time, dt);
  find_contacts(time, dt, least_mass, joined, p, g);
  if (in_pores) press(dt, in_pores);
  for (int sweep = 0; sweep < impulse_sweeps; ++sweep)
    for (Contact& c : contacts_) {
      Body& body = bodies_[std::size_t(c.body)];
      Vec2 slip = -body.velocity_of(c.x, time);
      for (std::size_t k = c.begin; k < c.end; ++k)
        slip += shares_[k].share * Vec2(g.node[shares_[k].node].nx, g.node[shares_[k].node].ny);
      const Vec2 tangent(-c.normal.y(), c.normal.x());
      double normal = c.along_normal - (slip.dot(c.normal) + c.part) / (c.per_mass + c.body_normal);
      double along = c.along - slip.dot(tangent) / (c.per_mass + c.body_along);
      if (!c.pulls) normal = std::max(0.0, normal);
      if (body.friction) {
        const double most = *body.friction * std::max(0.0, normal - c.by_water);
        c.sticks = std::abs(along) <= most && most > 0;
        along = std::clamp(along, -most, most);
      } else if (!c.pulls && normal == 0) {
        along = 0;
      }
      const Vec2 impulse = (normal - c.along_normal) * c.normal + (along - c.along) * tangent;
      c.along_normal = normal;
      c.along = along;
      if (body.free) {
        const Vec2 before = body.v;
        body.v -= impulse / body.mass_now;
        for (int a = 0; a < 2; ++a)
          if (body.given(a)) body.v[a] = before[a];
        const Vec2 arm = c.x - body.centre - body.shift;
        if (body.turns && !body.given(2))
          body.spin -= (arm.x() * impulse.y() - arm.y() * impulse.x()) / (body.mass_now * body.inertia_per_mass);
      }
      for (std::size_t k = c.begin; k < c.end; ++k) {
        Node& node = g.node[shares_[k].node];
        if (!(node.mass > 0)) continue;
        const double per_mass = shares_[k].share / node.mass;
        node.nx += per_mass * impulse.x();
        node.ny += per_mass * impulse.y();
      }
    }
  for (const JoinedNode& j : joined)
    if (std::any_of(shares_.begin(), shares_.end(), [&](const NodeShare& s) { return s.node == j.heavy; })) {
      g.node[j.small].nx = 2 * g.node[j.heavy].nx - g.node[j.beyond].nx;
      g.node[j.small].ny = 2 * g.node[j.heavy].ny - g.node[j.beyond].ny;
    }
  const std::size_t first = reactions.size();
  for (const Contact& c : contacts_) {
    if (c.along_normal == 0 && c.along == 0) continue;
    const Vec2 impulse = c.along_normal * c.normal + c.along * Vec2(-c.normal.y(), c.normal.x());
    for (std::size_t k = c.begin; k < c.end; ++k) {
      const NodeShare& s = shares_[k];
      if (s.share == 0) continue;
      const Vec2 v = bodies_[std::size_t(c.body)].velocity_of(g.place(s.node), time);
      reactions.push_back({s.node, s.share * impulse.x(), s.share * impulse.y(), v.x(), v.y(), c.body});
      // (In a layer the points of the material itself bear the impulse.)
      if (!c.layer) g.node[s.node].hold();
    }
  }
  // Of a body and node one.
  const auto from = reactions.begin() + std::ptrdiff_t(first);
  std::stable_sort(from, reactions.end(), [](const Reaction& a, const Reaction& b) {
    return a.body != b.body ? a.body < b.body : a.node < b.node;
  });
  auto last = from;
  for (auto r = from; r != reactions.end(); ++r)
    if (r != from && last->body == r->body && last->node == r->node) {
      last->impulse_x += r->impulse_x;
      last->impulse_y += r->impulse_y;
    } else if (r != from) {
      *++last = *r;
    }
  if (from != reactions.end()) reactions.erase(last + 1, reactions.end());
}

std::vector<std::uint32_t> RigidBodies::touched_nodes() const {
  std::vector<std::uint32_t> nodes;
  for (const NodeShare& s : shares_) nodes.push_back(s.node);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void RigidBodies::separate_strain_velocities(GridState& g) const {
  for (const NodeShare& s : shares_) g.separate_strain_velocities(s.node);
}

void RigidBodies::apply_to_strain_velocity(double time, GridState& g) const {
  for (int sweep = 0; sweep < impulse_sweeps; ++sweep)
    for (const Contact& c : contacts_) {
      const Body& body = bodies_[std::size_t(c.body)];
      if (!c.pulls && !(c.along_normal > 0)) continue;
      Vec2 slip = -body.velocity_of(c.x, time);
      for (std::size_t k = c.begin; k < c.end; ++k) slip += shares_[k].share * std::as_const(g).strain_velocity(shares_[k].node);
      const double across = slip.dot(c.normal) + c.part;
      slip = c.sticks ? Vec2(slip + c.part * c.normal) : Vec2(across * c.normal);
      const Vec2 impulse = -slip / c.per_mass;
      for (std::size_t k = c.begin; k < c.end; ++k) {
        if (!(g.node[shares_[k].node].mass > 0)) continue;
        const GridState::StrainVelocity u = g.strain_velocity(shares_[k].node);
        const double share = shares_[k].share / g.node[shares_[k].node].mass;
        u.x += share * impulse.x();
        u.y += share * impulse.y();
      }
    }
}

}  // namespace pivnp::mpm

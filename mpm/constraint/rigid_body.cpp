#include "mpm/constraint/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::mpm {

RigidBodies::RigidBodies(const std::vector<std::pair<std::string, RigidOptions>>& bodies, const Grid& grid)
    : spacing_(grid.spacing.minCoeff()) {
  for (const auto& [name, options] : bodies) {
    Body body;
    body.key = "body." + name;
    if (options.circle_m.empty() == options.polygon_m.empty())
      throw InputError(body.key + ": expected either circle_m or polygon_m");
    if (!options.circle_m.empty()) {
      if (options.circle_m.size() != 3 || !(options.circle_m[2] > 0))
        throw InputError(body.key + ".circle_m: expected centre x, y and a radius above 0");
      body.centre = {options.circle_m[0], options.circle_m[1]};
      body.radius = options.circle_m[2];
    } else {
      std::vector<Vec2> vertices = positions_of(options.polygon_m);
      body.polygon.emplace(vertices, body.key + ".polygon_m");
    }
    body.velocity = {options.velocity_m_s[0], options.velocity_m_s[1]};
    body.from = options.from_s;
    body.friction = options.friction;
    body.until = options.until_s.value_or(std::numeric_limits<double>::infinity());
    bool any = false;
    for (int j = 0; j < grid.ny && !any; ++j)
      for (int i = 0; i < grid.nx && !any; ++i) any = body.contains(grid.position(i, j));
    if (!any) throw InputError(body.key + ": holds no node of the grid, expected a body wider than a cell, inside it");
    body.set_free(options);
    body.sample_surface(grid.spacing.minCoeff());
    bodies_.push_back(std::move(body));
  }
}

void RigidBodies::Body::set_free(const RigidOptions& o) {
  const auto refuse = [&](const char* name, const char* expected) {
    throw InputError(key + "." + name + ": expected " + expected);
  };
  if (o.mass_end_kg_m && !o.mass_kg_m) refuse("mass_end_kg_m", "mass_kg_m beside it");
  if (o.mass_until_s.has_value() != o.mass_end_kg_m.has_value()) refuse("mass_until_s", "mass_end_kg_m and mass_until_s together");
  if (!o.mass_kg_m) return;
  free = true;
  turns = o.turns;
  mass = *o.mass_kg_m;
  mass_end = o.mass_end_kg_m.value_or(mass);
  mass_from = o.mass_from_s;
  mass_until = o.mass_until_s.value_or(mass_from);
  if (!(mass > 0) || !std::isfinite(mass)) refuse("mass_kg_m", "a mass above 0 kg/m");
  if (!(mass_end > 0) || !std::isfinite(mass_end)) refuse("mass_end_kg_m", "a mass above 0 kg/m");
  if (!(mass_until >= mass_from)) refuse("mass_until_s", "more than mass_from_s");
  if (o.from_s != 0) refuse("from_s", "0 with a free body");
  if (o.until_s) refuse("until_s", "none with a free body");
  v = velocity;
  velocity = Vec2::Zero();
  if (!polygon) {
    inertia_per_mass = 0.5 * radius * radius;
    return;
  }
  // Area, centroid and polar second moment of the polygon (counter-clockwise), by triangles from the first corner.
  const std::vector<Vec2>& c = polygon->vertices();
  double area = 0, second = 0;
  Vec2 first(0, 0);
  for (std::size_t k = 1; k + 1 < c.size(); ++k) {
    const Vec2 a = c[k] - c[0], b = c[k + 1] - c[0];
    const double t = 0.5 * (a.x() * b.y() - a.y() * b.x());
    area += t;
    first += t / 3 * (a + b);
    second += t / 6 * (a.squaredNorm() + a.dot(b) + b.squaredNorm());
  }
  const Vec2 middle = first / area;
  centre = c[0] + middle;
  inertia_per_mass = second / area - middle.squaredNorm();
}

double RigidBodies::Body::mass_at(double time) const {
  if (time >= mass_until) return mass_end;
  return time <= mass_from ? mass : mass + (time - mass_from) / (mass_until - mass_from) * (mass_end - mass);
}

Vec2 RigidBodies::Body::turned(const Vec2& d) const {
  if (angle == 0) return d;
  const double cos = std::cos(angle), sin = std::sin(angle);
  return {cos * d.x() - sin * d.y(), sin * d.x() + cos * d.y()};
}

Vec2 RigidBodies::Body::place(const Vec2& x, double time) const {
  return free ? Vec2(centre + shift + turned(x - centre)) : Vec2(x + offset(time));
}

Vec2 RigidBodies::Body::place_at_time_0(const Vec2& x, double time) const {
  if (!free) return x - offset(time);
  const Vec2 d = x - centre - shift;
  const double cos = std::cos(angle), sin = std::sin(angle);
  return centre + Vec2(cos * d.x() + sin * d.y(), cos * d.y() - sin * d.x());
}

Vec2 RigidBodies::Body::velocity_of(const Vec2& x, double time) const {
  if (!free) return velocity_at(time);
  if (time < 0) return Vec2::Zero();
  const Vec2 arm = x - centre - shift;
  return {v.x() - spin * arm.y(), v.y() + spin * arm.x()};
}

void RigidBodies::accelerate(double time, double dt, const Vec2& gravity) {
  for (Body& body : bodies_) {
    if (!body.free) continue;
    body.v += dt * gravity;
    body.mass_now = body.mass_at(time + 0.5 * dt);
  }
}

void RigidBodies::advance(double dt) {
  for (Body& body : bodies_) {
    if (!body.free) continue;
    body.shift += dt * body.v;
    body.angle += dt * body.spin;
  }
}

bool RigidBodies::any_free() const {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const Body& b) { return b.free; });
}

double RigidBodies::mass(std::size_t body, double time) const {
  return bodies_.at(body).free ? bodies_[body].mass_at(time) : 0;
}

Vec2 RigidBodies::displacement(std::size_t body, double time) const {
  return bodies_.at(body).free ? bodies_[body].shift : bodies_[body].offset(time);
}

std::vector<double> RigidBodies::motion() const {
  std::vector<double> all;
  for (const Body& b : bodies_)
    all.insert(all.end(), {b.shift.x(), b.shift.y(), b.angle, b.v.x(), b.v.y(), b.spin});
  return all;
}

void RigidBodies::set_motion(const std::vector<double>& all) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    Body& b = bodies_[k];
    b.shift = {all[6 * k], all[6 * k + 1]};
    b.angle = all[6 * k + 2];
    b.v = {all[6 * k + 3], all[6 * k + 4]};
    b.spin = all[6 * k + 5];
  }
}

Vec2 RigidBodies::Body::offset(double time) const {
  return velocity * std::max(0.0, std::min(time, until) - from);
}

Vec2 RigidBodies::Body::velocity_at(double time) const {
  return time >= from && time < until ? velocity : Vec2::Zero();
}

bool RigidBodies::Body::contains(const Vec2& x) const {
  return polygon ? polygon->contains(x) : (x - centre).squaredNorm() <= radius * radius;
}

bool RigidBodies::cover(const Vec2& x, double time, double margin) const {
  return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
    const Vec2 at = body.place_at_time_0(x, time);
    Vec2 unused;
    return body.polygon ? body.contains(at) || body.polygon->distance(at, unused) < margin : (at - body.centre).norm() < body.radius + margin;
  });
}

void RigidBodies::check_clear(const std::vector<Vec2>& points) const {
  for (const Body& body : bodies_)
    for (const Vec2& x : points)
      if (body.contains(x)) {
        std::ostringstream text;
        text << body.key << ": material at (" << x.x() << ", " << x.y()
             << ") lies inside the body at time 0, expected a region cut around it";
        throw InputError(text.str());
      }
}

void RigidBodies::Body::sample_surface(double spacing) {
  if (!polygon) {
    const int n = int(std::ceil(2 * M_PI * radius / spacing));
    for (int k = 0; k < n; ++k) {
      const double at = 2 * M_PI * (k + 0.5) / n;
      const Vec2 normal(std::cos(at), std::sin(at));
      surface.push_back({centre + radius * normal, normal});
    }
    return;
  }
  const std::vector<Vec2>& corner = polygon->vertices();  // counter-clockwise
  for (std::size_t c = 0; c < corner.size(); ++c) {
    const Vec2 a = corner[c], side = corner[(c + 1) % corner.size()] - a;
    const Vec2 normal = Vec2(side.y(), -side.x()).normalized();
    const int n = int(std::ceil(side.norm() / spacing));
    sides.push_back({a, side.normalized(), normal, side.norm(), surface.size(), std::size_t(n)});
    for (int k = 0; k < n; ++k) surface.push_back({a + (k + 0.5) / n * side, normal});
  }
}

// Of a point the part that lies under a side, hats along the side: the first and last piece's are even to its ends.
void RigidBodies::Body::pieces_over(const Vec2& x, const Mat2& halves, double deepest, std::vector<UnderPiece>& list) const {
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
    if (depth >= 0 && depth <= deepest) take(s, depth);
    if (depth >= 0 || depth <= nearest) continue;
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
constexpr double sticking = 0.02;         // cells by which a rough body may be off and still pulls
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
    for (UnderPiece& u : list) u.normal = body.turned(u.normal);
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
    const Body& body = bodies_[b];
    if (body.free && time < 0) continue;
    const double least = body.free ? closer_when_free * least_mass : least_mass;
    if (body.polygon) find_points_under(body, time, p, g);
    for (std::size_t s = 0; s < body.surface.size(); ++s) {
      const SurfacePoint& point = body.surface[s];
      for (int field = 0; field < g.velocity_fields; ++field) {
        Contact c;
        c.body = int(b);
        c.x = body.place(point.x, time);
        c.normal = body.turned(point.normal);
        c.begin = shares_.size();
        const MaterialFace face = body.polygon ? layer_.face(g, s, field, shares_) : MaterialFace{};
        if (body.polygon && face.state == MaterialFace::State::none) continue;
        if (face.state == MaterialFace::State::found) {
          const double gap = time < 0 ? 0 : face.gap;
          if (face.gap > (time < 0 ? touching_at_rest : 1.0) * spacing_) {
            shares_.resize(c.begin);
            continue;
          }
          c.layer = true;
          c.x += face.along * Vec2(-c.normal.y(), c.normal.x());
          if (gap > 0) c.part = gap / dt;
          c.pulls = !body.friction && gap <= sticking * spacing_;
          if (c.pulls) c.part = 0;
        } else {
          double mass = 0;
          add_nodes_around(c.x, field, g, mass);
          if (!(mass > least)) {
            shares_.resize(c.begin);
            continue;
          }
          c.pulls = !body.friction;
        }
        if (!take_shares(c, joined, g)) continue;
        if (body.free) {
          const Vec2 arm = c.x - body.centre - body.shift, tangent(-c.normal.y(), c.normal.x());
          const double across = arm.x() * c.normal.y() - arm.y() * c.normal.x();
          const double along = arm.x() * tangent.y() - arm.y() * tangent.x();
          const double per_inertia = body.turns ? 1 / body.inertia_per_mass : 0;
          c.body_normal = (1 + across * across * per_inertia) / body.mass_now;
          c.body_along = (1 + along * along * per_inertia) / body.mass_now;
        }
        contacts_.push_back(c);
      }
    }
  }
}

void RigidBodies::apply(double time, double dt, double least_mass, std::span<const JoinedNode> joined, const Particles& p,
                        GridState& g, std::vector<Reaction>& reactions) {
  find_contacts(time, dt, least_mass, joined, p, g);
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
        const double most = *body.friction * normal;
        c.sticks = std::abs(along) <= most && most > 0;
        along = std::clamp(along, -most, most);
      } else if (!c.pulls && normal == 0) {
        along = 0;
      }
      const Vec2 impulse = (normal - c.along_normal) * c.normal + (along - c.along) * tangent;
      c.along_normal = normal;
      c.along = along;
      if (body.free) {
        body.v -= impulse / body.mass_now;
        const Vec2 arm = c.x - body.centre - body.shift;
        if (body.turns)
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
      g.node[j.small].nx = g.node[j.heavy].nx;
      g.node[j.small].ny = g.node[j.heavy].ny;
    }
  const std::size_t first = reactions.size();
  for (const Contact& c : contacts_) {
    if (c.along_normal == 0 && c.along == 0) continue;
    const Vec2 impulse = c.along_normal * c.normal + c.along * Vec2(-c.normal.y(), c.normal.x());
    for (std::size_t k = c.begin; k < c.end; ++k) {
      const NodeShare& s = shares_[k];
      if (s.share == 0) continue;
      const Vec2 v = bodies_[std::size_t(c.body)].velocity_of(g.position(s.node), time);
      reactions.push_back({s.node, s.share * impulse.x(), s.share * impulse.y(), v.x(), v.y(), c.body});
      // (In a layer the points of the material itself bear the impulse.)
      if (!c.layer) g.node[s.node].held = true;
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

double RigidBodies::next_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Body& body : bodies_)
    for (const double t : {body.from, body.until, body.mass_from, body.mass_until})
      if (t > time) next = std::min(next, t);
  return next;
}

bool RigidBodies::moving_after(double time) const {
  for (const Body& body : bodies_) {
    if (body.velocity.norm() > 0 && time < body.until) return true;
    if (body.free && (time < body.mass_until || body.v.norm() * time > 0.01 * spacing_)) return true;
  }
  return false;
}

std::vector<std::pair<Vec2, Vec2>> RigidBodies::moving_corners(double time) const {
  std::vector<std::pair<Vec2, Vec2>> all;
  for (const Body& body : bodies_) {
    if (!body.free && (body.velocity_at(time).norm() == 0 || body.surface.empty())) continue;
    std::pair<Vec2, Vec2> corners{body.place(body.surface.front().x, time), body.place(body.surface.front().x, time)};
    for (const SurfacePoint& s : body.surface) {
      const Vec2 x = body.place(s.x, time);
      corners = {corners.first.cwiseMin(x), corners.second.cwiseMax(x)};
    }
    all.push_back(corners);
  }
  return all;
}

double RigidBodies::fastest() const {
  double speed = 0;
  for (const Body& body : bodies_) speed = std::max({speed, body.velocity.norm(), body.v.norm()});
  return speed;
}

}  // namespace pivnp::mpm

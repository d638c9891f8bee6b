#include "mpm/constraint/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::mpm {

namespace {

constexpr double not_held = std::numeric_limits<double>::quiet_NaN();

}  // namespace

RigidBodies::RigidBodies(const std::vector<std::pair<std::string, RigidOptions>>& bodies, const Grid& grid, int velocity_fields)
    : spacing_(grid.spacing.minCoeff()), fields_(velocity_fields) {
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
    body.grips = !options.friction;
    body.set_free(options);
    body.turns_at = options.angular_velocity_rad_s;
    if (!options.motion_table.any() && body.turns_at != 0 && body.free)
      throw InputError(body.key + ".angular_velocity_rad_s: given beside mass_kg_m, expected a body with prescribed motion");
    if (options.motion_table.any()) {
      if (body.turns_at != 0 || (!body.free && body.velocity.norm() > 0))
        throw InputError(body.key + ".motion: given beside a constant velocity, expected one of them");
      body.take_motion(options.motion_table, body.key + ".motion");
    }
    if (options.pivot_m) body.centre = {(*options.pivot_m)[0], (*options.pivot_m)[1]};
    else if (!body.free && body.polygon) body.moments_about(body.centre);
    if (options.force_table.any() && !body.free) throw InputError(body.key + ".force: given without mass_kg_m, expected a free body");
    body.force = options.force_table;
    body.sample_surface(grid.spacing.minCoeff());
    body.held.assign(body.surface.size() * std::size_t(fields_), not_held);
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
  inertia_per_mass = moments_about(centre);
}

// The polygon's centroid, and its polar second moment about it over its area, by triangles from the first corner.
double RigidBodies::Body::moments_about(Vec2& centroid) const {
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
  centroid = c[0] + middle;
  return second / area - middle.squaredNorm();
}

void RigidBodies::Body::take_motion(const MotionTable& motion, const std::string& motion_key) {
  table = motion;
  table.prepare();
  for (const Course& c : table.courses)
    if (c.given() && c.rows.size() != table.time.size()) throw InputError(motion_key + ": expected a value at every time");
}

void RigidBodies::Body::take_motion_of_step(double time, double dt) {
  if (free && !table.any()) return;
  if (time < 0 || !(dt > 0)) return;
  const Vec2 now = shift_at(time), then = shift_at(time + dt);
  for (int a = 0; a < 2; ++a)
    if (!free || given(a)) {
      shift[a] = now[a];
      v[a] = (then[a] - now[a]) / dt;
    }
  if (free && !given(2)) return;
  angle = angle_at(time);
  spin = (angle_at(time + dt) - angle) / dt;
}

double RigidBodies::Body::angle_at(double time) const {
  if (given(2)) return table.turn(std::max(0.0, time));
  return free ? angle : turns_at * std::max(0.0, std::min(time, until) - from);
}

Vec2 RigidBodies::Body::shift_at(double time) const {
  if (!free) return offset(time);
  Vec2 at = shift;
  for (int a = 0; a < 2; ++a)
    if (given(a)) at[a] = table.shift(std::max(0.0, time))[a];
  return at;
}

double RigidBodies::Body::reach() const {
  double most = 0;
  for (const SurfacePoint& s : surface) most = std::max(most, (s.x - centre).norm());
  return most;
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
  if (!moves_freely()) return x + offset(time);
  const double now = angle_at(time), cos = std::cos(now), sin = std::sin(now);
  const Vec2 d = x - centre;
  return centre + shift_at(time) + (now == 0 ? d : Vec2(cos * d.x() - sin * d.y(), sin * d.x() + cos * d.y()));
}

Vec2 RigidBodies::Body::place_at_time_0(const Vec2& x, double time) const {
  if (!moves_freely()) return x - offset(time);
  const Vec2 d = x - centre - shift_at(time);
  const double now = angle_at(time), cos = std::cos(now), sin = std::sin(now);
  return centre + Vec2(cos * d.x() + sin * d.y(), cos * d.y() - sin * d.x());
}

Vec2 RigidBodies::Body::velocity_of(const Vec2& x, double time) const {
  if (!moves_freely()) return velocity_at(time);
  if (time < 0) return Vec2::Zero();
  const Vec2 arm = x - centre - shift_at(time);
  return {v.x() - spin * arm.y(), v.y() + spin * arm.x()};
}

void RigidBodies::grip(const std::string& name, const BoundaryOptions& o, const Vec2& centroid) {
  Body body;
  body.key = "boundary." + name;
  body.boundary = body.grips = true;
  if (o.type == BoundaryType::roller) body.friction = 0;
  if (o.velocity_m_s) body.velocity = {(*o.velocity_m_s)[0], (*o.velocity_m_s)[1]};
  body.until = std::numeric_limits<double>::infinity();
  body.removed = o.until_s.value_or(body.removed);
  if (o.motion_table.any()) body.take_motion(o.motion_table, body.key + ".motion");
  if (o.line_m.size() == 2) {
    const Vec2 a(o.line_m[0][0], o.line_m[0][1]), b(o.line_m[1][0], o.line_m[1][1]);
    const double length = (b - a).norm();
    if (!(length > 0)) throw InputError(body.key + ".line_m: expected two different end points");
    const Vec2 along = (b - a) / length;
    Vec2 inward(-along.y(), along.x());
    if (o.normal ? inward.dot(Vec2((*o.normal)[0], (*o.normal)[1])) > 0 : inward.dot(centroid - a) < 0) inward = -inward;
    // Material drawn half a cell past the line is held from within.
    body.sides = {{a, along, inward, length, 0, 0, -0.5 * spacing_}, {a, along, -inward, length, 0, 0, 0.5 * spacing_}};
    body.centre = 0.5 * (a + b);
  } else {
    body.polygon.emplace(positions_of(o.polygon_m), body.key + ".polygon_m");
    body.nodes_inside = true;
    if (o.normal) body.way = Vec2((*o.normal)[0], (*o.normal)[1]).normalized();
    else if (o.type == BoundaryType::roller) throw InputError(body.key + ".normal: a roller polygon needs its normal");
    body.moments_about(body.centre);
  }
  body.sample_surface(spacing_);
  body.held.assign(body.surface.size() * std::size_t(fields_), not_held);
  bodies_.push_back(std::move(body));
}

int RigidBodies::gripping(const std::string& name) const {
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    if (bodies_[k].boundary && bodies_[k].key == "boundary." + name) return int(k);
  return -1;
}

void RigidBodies::accelerate(double time, double dt, const Vec2& gravity, const Field& field) {
  for (Body& body : bodies_) {
    if (!body.free) continue;
    body.v += dt * (field ? Vec2(gravity + field(body.centre + body.shift, body.v)) : gravity);
    body.mass_now = body.mass_at(time + 0.5 * dt);
    if (body.force.any()) body.v += dt / body.mass_now * body.force.at(time);
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
  return bodies_.at(body).shift_at(time);
}

std::vector<double> RigidBodies::motion() const {
  std::vector<double> all;
  for (const Body& b : bodies_)
    all.insert(all.end(), {b.shift.x(), b.shift.y(), b.angle, b.v.x(), b.v.y(), b.spin});
  for (const Body& b : bodies_) all.insert(all.end(), b.held.begin(), b.held.end());
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
  auto at = all.begin() + std::ptrdiff_t(6 * bodies_.size());
  for (Body& b : bodies_) {
    std::copy(at, at + std::ptrdiff_t(b.held.size()), b.held.begin());
    at += std::ptrdiff_t(b.held.size());
  }
}

Vec2 RigidBodies::Body::offset(double time) const {
  if (table.any()) return table.shift(std::max(0.0, time));
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
    if (body.boundary) return false;
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
  if (boundary) {
    for (Side& side : sides) {
      const int n = int(std::ceil(side.length / spacing));
      side.first = surface.size();
      side.count = std::size_t(n);
      for (int k = 0; k < n; ++k) surface.push_back({side.start + (k + 0.5) / n * side.length * side.along, side.normal, side.length / n});
    }
    return;
  }
  if (!polygon) {
    const int n = int(std::ceil(2 * M_PI * radius / spacing));
    for (int k = 0; k < n; ++k) {
      const double at = 2 * M_PI * (k + 0.5) / n;
      const Vec2 normal(std::cos(at), std::sin(at));
      surface.push_back({centre + radius * normal, normal, 2 * M_PI * radius / n});
    }
    return;
  }
  const std::vector<Vec2>& corner = polygon->vertices();  // counter-clockwise
  for (std::size_t c = 0; c < corner.size(); ++c) {
    const Vec2 a = corner[c], side = corner[(c + 1) % corner.size()] - a;
    const Vec2 normal = Vec2(side.y(), -side.x()).normalized();
    const int n = int(std::ceil(side.norm() / spacing));
    sides.push_back({a, side.normalized(), normal, side.norm(), surface.size(), std::size_t(n)});
    for (int k = 0; k < n; ++k) surface.push_back({a + (k + 0.5) / n * side, normal, side.norm() / n});
  }
}

double RigidBodies::next_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Body& body : bodies_) {
    for (const double t : {body.from, body.until, body.mass_from, body.mass_until, body.removed})
      if (t > time) next = std::min(next, t);
    for (const std::vector<double>* times : {&body.table.time, &body.force.time})
      if (const auto t = std::upper_bound(times->begin(), times->end(), time); t != times->end()) next = std::min(next, *t);
  }
  return next;
}

bool RigidBodies::moving_after(double time) const {
  for (const Body& body : bodies_) {
    if ((body.velocity.norm() > 0 || body.turns_at != 0) && time < std::min(body.until, body.removed)) return true;
    for (const std::vector<double>* times : {&body.table.time, &body.force.time})
      if (!times->empty() && time < times->back()) return true;
    if (body.free && (time < body.mass_until || body.v.norm() * time > 0.01 * spacing_)) return true;
  }
  return false;
}

std::vector<std::pair<Vec2, Vec2>> RigidBodies::moving_corners(double time) const {
  std::vector<std::pair<Vec2, Vec2>> all;
  for (const Body& body : bodies_) {
    if (body.surface.empty() || (!body.moves_freely() && body.velocity_at(time).norm() == 0)) continue;
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
  for (const Body& body : bodies_) {
    speed = std::max({speed, body.velocity.norm(), body.v.norm()});
    double of_motion = std::abs(body.turns_at) * body.reach();
    for (const Course& c : body.table.courses) of_motion += c.fastest(body.table.time) * (&c == &body.table.courses[2] ? body.reach() : 1);
    speed = std::max(speed, of_motion);
  }
  return speed;
}

}  // namespace pivnp::mpm

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

void RigidBodies::accelerate(double time, double dt, const Vec2& gravity, const Field& field) {
  for (Body& body : bodies_) {
    if (!body.free) continue;
    body.v += dt * (field ? Vec2(gravity + field(body.centre + body.shift, body.v)) : gravity);
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

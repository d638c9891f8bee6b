#include "mpm/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

RigidBodies::RigidBodies(const std::vector<std::pair<std::string, RigidOptions>>& bodies, const Grid& grid) {
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
      std::vector<Vec2> vertices;
      for (const Pair& p : options.polygon_m) vertices.emplace_back(p[0], p[1]);
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
    bodies_.push_back(std::move(body));
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

template <class Action>
void RigidBodies::for_nodes_inside(const Body& body, double time, GridState& g, Action&& action) const {
  const Vec2 offset = body.offset(time);
  const Vec2 low = body.polygon ? body.polygon->lower() : body.centre - Vec2::Constant(body.radius);
  const Vec2 high = body.polygon ? body.polygon->upper() : body.centre + Vec2::Constant(body.radius);
  const Vec2 a = (low + offset - g.grid.origin).cwiseQuotient(g.grid.spacing);
  const Vec2 b = (high + offset - g.grid.origin).cwiseQuotient(g.grid.spacing);
  const auto clamped = [](double s, int nodes) { return int(std::clamp(s, -1.0, double(nodes))); };
  const int first_i = std::max(0, clamped(std::floor(a.x()), g.grid.nx));
  const int first_j = std::max(0, clamped(std::floor(a.y()), g.grid.ny));
  const int last_i = std::min(g.grid.nx - 1, clamped(std::ceil(b.x()), g.grid.nx));
  const int last_j = std::min(g.grid.ny - 1, clamped(std::ceil(b.y()), g.grid.ny));
  for (int j = first_j; j <= last_j; ++j)
    for (int i = first_i; i <= last_i; ++i) {
      const std::size_t n = g.grid.node(i, j);
      const Vec2 x = g.grid.position(i, j) - offset;
      if (g.node[n].mass > 0 && body.contains(x)) action(n, x);
    }
}

Vec2 RigidBodies::Body::velocity_of_node(const Vec2& v, const Vec2& x, const Vec2& of_body, bool with_friction) const {
  if (!friction) return of_body;
  Vec2 normal = x - centre;
  if (polygon) polygon->distance(x, normal);
  else if (!(normal.norm() > 0)) return of_body;
  normal.normalize();
  const Vec2 slip = v - of_body;
  const double inward = -slip.dot(normal);
  if (!(inward > 0)) return v;
  Vec2 along = slip + inward * normal;
  if (with_friction) {
    const double speed = along.norm(), most = *friction * inward;
    along *= speed <= most ? 0.0 : 1 - most / speed;
  }
  return of_body + along;
}

void RigidBodies::apply(double time, GridState& g, std::vector<Reaction>& reactions) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const Vec2 v = body.velocity_at(time);
    for_nodes_inside(body, time, g, [&](std::size_t n, const Vec2& x) {
      Node& node = g.node[n];
      const Vec2 free(node.nx, node.ny), now = body.velocity_of_node(free, x, v, true);
      const Vec2 impulse = node.mass * (now - free);
      reactions.push_back({std::uint32_t(n), impulse.x(), impulse.y(), v.x(), v.y(), int(b)});
      node.nx = now.x();
      node.ny = now.y();
    });
  }
}

void RigidBodies::apply_to_remapped(double time, GridState& g) const {
  for (const Body& body : bodies_) {
    const Vec2 v = body.velocity_at(time);
    for_nodes_inside(body, time, g, [&](std::size_t n, const Vec2& x) {
      const Vec2 now = body.velocity_of_node(Vec2(g.node[n].ux, g.node[n].uy), x, v, false);
      g.node[n].ux = now.x();
      g.node[n].uy = now.y();
    });
  }
}

double RigidBodies::next_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Body& body : bodies_)
    for (const double t : {body.from, body.until})
      if (t > time) next = std::min(next, t);
  return next;
}

bool RigidBodies::moving_after(double time) const {
  for (const Body& body : bodies_)
    if (body.velocity.norm() > 0 && time < body.until) return true;
  return false;
}

double RigidBodies::fastest() const {
  double speed = 0;
  for (const Body& body : bodies_) speed = std::max(speed, body.velocity.norm());
  return speed;
}

}  // namespace pivnp::mpm

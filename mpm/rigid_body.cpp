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
    body.sample_surface(grid.spacing.minCoeff());
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

void RigidBodies::Body::sample_surface(double spacing) {
  if (!polygon) {
    const int n = int(std::ceil(2 * M_PI * radius / spacing));
    for (int k = 0; k < n; ++k) {
      const double angle = 2 * M_PI * (k + 0.5) / n;
      const Vec2 normal(std::cos(angle), std::sin(angle));
      surface.push_back({centre + radius * normal, normal});
    }
    return;
  }
  const std::vector<Vec2>& corner = polygon->vertices();  // counter-clockwise
  for (std::size_t c = 0; c < corner.size(); ++c) {
    const Vec2 a = corner[c], side = corner[(c + 1) % corner.size()] - a;
    const Vec2 normal = Vec2(side.y(), -side.x()).normalized();
    const int n = int(std::ceil(side.norm() / spacing));
    for (int k = 0; k < n; ++k) surface.push_back({a + (k + 0.5) / n * side, normal});
  }
}

void RigidBodies::find_contacts(double time, double least_mass, const GridState& g) {
  contacts_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Vec2 offset = bodies_[b].offset(time);
    for (const SurfacePoint& point : bodies_[b].surface) {
      std::int32_t cell = 0;
      double xi = 0, eta = 0;
      const Vec2 x = point.x + offset;
      if (!g.find(x.x(), x.y(), cell, xi, eta)) continue;
      Contact c;
      c.body = int(b);
      c.normal = point.normal;
      g.weights_at(cell, xi, eta, c.node, c.weight);
      double mass = 0, weight = 0, per_mass = 0;
      for (int k = 0; k < g.stencil; ++k) {
        const double m = g.node[c.node[k]].mass;
        if (!(m > 0)) c.weight[k] = 0;
        else per_mass += c.weight[k] * c.weight[k] / m;
        mass += c.weight[k] * m;
        weight += c.weight[k];
      }
      if (!(mass > least_mass) || !(per_mass > 0)) continue;
      for (int k = 0; k < g.stencil; ++k) c.weight[k] /= weight;
      c.per_mass = per_mass / (weight * weight);
      contacts_.push_back(c);
    }
  }
}

namespace {

constexpr int sweeps = 20;

}  // namespace

void RigidBodies::apply(double time, double least_mass, GridState& g, std::vector<Reaction>& reactions) {
  find_contacts(time, least_mass, g);
  const auto stencil = std::size_t(g.stencil);
  // The nodes of each body's contacts as they were.
  struct Before {
    std::uint32_t node;
    int body;
    double x, y;
  };
  std::vector<Before> before;
  for (const Contact& c : contacts_)
    for (std::size_t k = 0; k < stencil; ++k)
      if (c.weight[k] > 0) before.push_back({std::uint32_t(c.node[k]), c.body, 0, 0});
  std::sort(before.begin(), before.end(), [](const Before& a, const Before& b) { return a.node < b.node; });
  before.erase(std::unique(before.begin(), before.end(), [](auto& a, auto& b) { return a.node == b.node; }),
               before.end());
  for (Before& b : before) {
    b.x = g.node[b.node].nx;
    b.y = g.node[b.node].ny;
  }
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (Contact& c : contacts_) {
      const Body& body = bodies_[std::size_t(c.body)];
      Vec2 slip = -body.velocity_at(time);
      for (std::size_t k = 0; k < stencil; ++k) slip += c.weight[k] * Vec2(g.node[c.node[k]].nx, g.node[c.node[k]].ny);
      const Vec2 tangent(-c.normal.y(), c.normal.x());
      double normal = c.along_normal - slip.dot(c.normal) / c.per_mass, along = c.along - slip.dot(tangent) / c.per_mass;
      if (body.friction) {
        normal = std::max(0.0, normal);
        const double most = *body.friction * normal;
        c.sticks = std::abs(along) <= most && most > 0;
        along = std::clamp(along, -most, most);
      }
      const Vec2 impulse = (normal - c.along_normal) * c.normal + (along - c.along) * tangent;
      c.along_normal = normal;
      c.along = along;
      for (std::size_t k = 0; k < stencil; ++k) {
        if (!(c.weight[k] > 0)) continue;
        Node& node = g.node[c.node[k]];
        node.nx += c.weight[k] / node.mass * impulse.x();
        node.ny += c.weight[k] / node.mass * impulse.y();
      }
    }
  // (A node between two bodies counts its impulse for the first.)
  for (const Before& b : before) {
    Node& node = g.node[b.node];
    const Vec2 v = bodies_[std::size_t(b.body)].velocity_at(time);
    if (node.nx == b.x && node.ny == b.y) continue;
    reactions.push_back({b.node, node.mass * (node.nx - b.x), node.mass * (node.ny - b.y), v.x(), v.y(), b.body});
    node.held = true;
  }
}

void RigidBodies::apply_to_remapped(double time, GridState& g) const {
  const auto stencil = std::size_t(g.stencil);
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (const Contact& c : contacts_) {
      const Body& body = bodies_[std::size_t(c.body)];
      if (body.friction && !(c.along_normal > 0)) continue;
      Vec2 slip = -body.velocity_at(time);
      for (std::size_t k = 0; k < stencil; ++k) slip += c.weight[k] * Vec2(g.node[c.node[k]].ux, g.node[c.node[k]].uy);
      if (!c.sticks) slip = slip.dot(c.normal) * c.normal;
      const Vec2 impulse = -slip / c.per_mass;
      for (std::size_t k = 0; k < stencil; ++k) {
        if (!(c.weight[k] > 0)) continue;
        Node& node = g.node[c.node[k]];
        node.ux += c.weight[k] / node.mass * impulse.x();
        node.uy += c.weight[k] / node.mass * impulse.y();
      }
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

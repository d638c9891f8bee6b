#include "mpm/boundary.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

Vec2 point(const Pair& p) { return {p[0], p[1]}; }

Vec2 unit(const Pair& p, const std::string& key) {
  const Vec2 v = point(p);
  if (!(v.norm() > 0) || !v.allFinite()) throw InputError(key + ".normal: expected a direction of non-zero length");
  return v.normalized();
}

// The side on which a wall along the grid, through nodes, has nothing; fold_none for any other.
std::uint8_t fold_along_grid(const Grid& grid, const Vec2& a, const Vec2& outward) {
  const Vec2 at = (a - grid.origin).cwiseQuotient(grid.spacing);
  const auto on_nodes = [](double s) { return std::abs(s - std::round(s)) < 1e-6; };
  if (std::abs(outward.y()) < 1e-9 && on_nodes(at.x())) return outward.x() < 0 ? fold_left : fold_right;
  if (std::abs(outward.x()) < 1e-9 && on_nodes(at.y())) return outward.y() < 0 ? fold_down : fold_up;
  return fold_none;
}

}  // namespace

Restraints::Restraints(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const GridState& g,
                       const Vec2& centroid, const Impedance& impedance) {
  std::vector<std::vector<std::uint16_t>> walls_of_node(g.grid.node_count());
  for (const auto& [name, options] : boundaries) {
    const std::string key = "boundary." + name;
    Wall wall;
    wall.type = Type::fixed;
    wall.normal = Vec2::Zero();
    wall.friction = options.friction;
    if (options.type == "roller") wall.type = Type::roller;
    else if (options.type == "frictional") wall.type = Type::frictional;
    else if (options.type == "absorbing") wall.type = Type::absorbing;
    else if (options.type != "fixed")
      throw InputError(key + ".type: found '" + options.type + "', expected fixed, roller, frictional or absorbing" +
                       did_you_mean(options.type, {"fixed", "roller", "frictional", "absorbing"}));
    if (!(options.friction >= 0)) throw InputError(key + ".friction: expected 0 or more");
    if (options.until_s) wall.until = *options.until_s;
    if (options.line_m.empty() == options.polygon_m.empty())
      throw InputError(key + ": expected either line_m or polygon_m");
    add_nodes(key, options, wall, g, centroid, walls_of_node);
    if (wall.type == Type::absorbing) {
      if (wall.fold == fold_none)
        throw InputError(key + ".line_m: an absorbing wall must lie along the grid, on a line of nodes");
      const bool upright = wall.fold == fold_left || wall.fold == fold_right;
      wall.impedance = impedance(0.5 * (wall.from + wall.to));
      for (double& c : wall.impedance) c *= upright ? g.grid.spacing.y() : g.grid.spacing.x();
    }
    walls_.push_back(wall);
  }
  for (std::size_t n = 0; n < walls_of_node.size(); ++n)
    if (!walls_of_node[n].empty()) nodes_.push_back({std::uint32_t(n), walls_of_node[n]});
}

void Restraints::add_nodes(const std::string& key, const BoundaryOptions& options, Wall& wall, const GridState& g,
                           const Vec2& centroid, std::vector<std::vector<std::uint16_t>>& walls_of_node) {
  const Grid& grid = g.grid;
  const auto id = static_cast<std::uint16_t>(walls_.size());
  bool any = false;
  const auto take = [&](int i, int j) {
    walls_of_node[grid.node(i, j)].push_back(id);
    any = true;
  };
  if (!options.line_m.empty()) {
    if (options.line_m.size() != 2) throw InputError(key + ".line_m: expected two end points");
    const Vec2 a = point(options.line_m[0]), b = point(options.line_m[1]);
    const double length = (b - a).norm();
    if (!(length > 0)) throw InputError(key + ".line_m: expected two different end points");
    const Vec2 along = (b - a) / length;
    Vec2 across(-along.y(), along.x());
    if (across.dot(centroid - a) > 0) across = -across;
    if (options.normal) {
      wall.normal = unit(*options.normal, key);
      if (across.dot(wall.normal) < 0) across = -across;
    } else {
      wall.normal = across;
    }
    const double h = 1 / across.cwiseQuotient(grid.spacing).norm(), half = 0.5 * h, round_off = 1e-6 * h;
    wall.from = a;
    wall.to = b;
    wall.fold = fold_along_grid(grid, a, across);
    // Without a fold, shapes of three nodes reach one row further.
    const double behind = g.width == 3 && wall.fold == fold_none ? half + h : half;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const Vec2 from_a = grid.position(i, j) - a;
        const double out = from_a.dot(across), on = std::clamp(from_a.dot(along), 0.0, length);
        const double past = std::abs(from_a.dot(along) - on);
        if (out > -half + round_off && out <= behind + round_off && std::hypot(past, std::min(out, half)) <= half + round_off)
          take(i, j);
      }
  } else {
    std::vector<Vec2> vertices;
    for (const Pair& p : options.polygon_m) vertices.push_back(point(p));
    const Polygon polygon(vertices, key + ".polygon_m");
    if (options.normal)
      wall.normal = unit(*options.normal, key);
    else if (wall.type != Type::fixed)
      throw InputError(key + ".normal: a " + options.type + " polygon needs its normal");
    const double round_off = 1e-6 * grid.spacing.minCoeff();
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const Vec2 x = grid.position(i, j);
        Vec2 unused;
        if (polygon.contains(x) || polygon.distance(x, unused) <= round_off) take(i, j);
      }
  }
  if (!any) throw InputError(key + ": restrains no node of the grid, expected at least one");
}

Vec2 Restraints::restrain(const RestrainedNode& at, double time, Vec2 v, bool with_friction, bool& stuck,
                          bool settling) const {
  const Vec2* roller = nullptr;
  bool frictional = false;
  for (const std::uint16_t id : at.walls) {
    const Wall& wall = walls_[id];
    if (time >= wall.until) continue;
    if (wall.type == Type::fixed || (settling && wall.type == Type::absorbing)) return Vec2::Zero();
    if (wall.type == Type::frictional) frictional = true;
    if (wall.type != Type::roller) continue;
    // Two rollers that are not parallel leave no way to go.
    if (roller && std::abs(roller->x() * wall.normal.y() - roller->y() * wall.normal.x()) > 1e-6) return Vec2::Zero();
    roller = &wall.normal;
  }
  if (roller) v -= v.dot(*roller) * *roller;
  if (!frictional) return v;
  for (int pass = 0; pass < 2; ++pass) {  // twice, for corners of two walls
    for (const std::uint16_t id : at.walls) {
      const Wall& wall = walls_[id];
      if (time >= wall.until || wall.type != Type::frictional) continue;
      const double inward = v.dot(wall.normal);
      if (!(inward > 0)) continue;
      Vec2 tangential = v - inward * wall.normal;
      if (with_friction) {
        const double speed = tangential.norm(), most = wall.friction * inward;
        stuck = speed <= most;
        tangential *= stuck ? 0.0 : 1 - most / speed;
      }
      v = tangential;
    }
    if (roller) v -= v.dot(*roller) * *roller;
  }
  return v;
}

// v / (1 + dt C / m), C the dashpots of the node's length of wall: half of it at a wall's ends.
Vec2 Restraints::absorbed(const RestrainedNode& at, double time, double dt, const GridState& g, Vec2 v) const {
  for (const std::uint16_t id : at.walls) {
    const Wall& wall = walls_[id];
    if (wall.type != Type::absorbing || time >= wall.until) continue;
    const Vec2 x = g.grid.position(int(at.node % std::uint32_t(g.grid.nx)), int(at.node / std::uint32_t(g.grid.nx)));
    const double half = 0.5 * g.grid.spacing.minCoeff();
    const double share = (x - wall.from).norm() < half || (x - wall.to).norm() < half ? 0.5 : 1;
    const double per = share * dt / g.node[at.node].mass, across = v.dot(wall.normal);
    const Vec2 along = v - across * wall.normal;
    v = across / (1 + per * wall.impedance[0]) * wall.normal + along / (1 + per * wall.impedance[1]);
  }
  return v;
}

void Restraints::apply(double time, double dt, GridState& g, std::vector<Reaction>& reactions) {
  for (RestrainedNode& at : nodes_) {
    Node& node = g.node[at.node];
    if (!(node.mass > 0)) continue;
    at.stuck = false;
    const Vec2 free(node.nx, node.ny);
    const Vec2 v = restrain(at, time, absorbed(at, time, dt, g, free), true, at.stuck, dt == 0);
    if (v == free) continue;
    reactions.push_back({at.node, node.mass * (v.x() - free.x()), node.mass * (v.y() - free.y()), 0, 0});
    node.nx = v.x();
    node.ny = v.y();
    node.held = true;
  }
}

void Restraints::apply_to_remapped(double time, GridState& g) const {
  for (const RestrainedNode& at : nodes_) {
    Node& node = g.node[at.node];
    if (!(node.mass > 0)) continue;
    bool unused = false;
    const Vec2 v = at.stuck ? Vec2::Zero() : restrain(at, time, Vec2(node.ux, node.uy), false, unused, false);
    node.ux = v.x();
    node.uy = v.y();
  }
}

double Restraints::next_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls_)
    if (wall.until > time) next = std::min(next, wall.until);
  return next;
}

std::vector<std::uint8_t> Restraints::folds(double time, const Grid& grid) const {
  std::vector<std::uint8_t> folds(grid.node_count(), fold_none);
  for (const RestrainedNode& at : nodes_)
    for (const std::uint16_t id : at.walls)
      if (time < walls_[id].until) folds[at.node] = std::uint8_t(folds[at.node] | walls_[id].fold);
  return folds;
}

bool Restraints::any_absorbing() const {
  return std::any_of(walls_.begin(), walls_.end(), [](const Wall& w) { return w.type == Type::absorbing; });
}

}  // namespace pivnp::mpm

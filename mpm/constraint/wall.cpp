#include "mpm/constraint/wall.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/constraint/withdrawal.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::mpm {

namespace {

using Type = BoundaryType;

Vec2 point(const Pair& p) { return {p[0], p[1]}; }

Vec2 unit(const Pair& p, const std::string& key) {
  const Vec2 v = point(p);
  if (!(v.norm() > 0) || !v.allFinite()) throw InputError(key + ".normal: expected a direction of non-zero length");
  return v.normalized();
}

// The side on which a wall along the grid has nothing, and the shift onto it of the nearest line of nodes (of two, the
// outer one) if that may move. wall_none for any other wall.
void place_along_grid(const GridGeometry& g, const Vec2& outward, bool may_move, Wall& wall) {
  const int axis = std::abs(outward.y()) < 1e-9 ? 0 : 1;
  if (std::abs(outward[1 - axis]) >= 1e-9) return;
  const bool low = outward[axis] < 0;
  const double at = (wall.from[axis] - g.domain.origin[axis]) / g.domain.spacing[axis], between = at - std::round(at);
  const bool moves = wall.type == Type::fixed || wall.type == Type::roller || wall.type == Type::frictional;
  if (std::abs(between) >= 1e-6) {
    const int last = (axis == 0 ? g.domain.nx : g.domain.ny) - 1;
    if (!g.centred || !may_move || !moves || at < 0 || at > last) return;
    const double row = low ? std::ceil(at - 0.5 - 1e-6) : std::floor(at + 0.5 + 1e-6);
    wall.shift[axis] = (at - row) * g.domain.spacing[axis];
  }
  wall.side = axis == 0 ? (low ? wall_left : wall_right) : (low ? wall_down : wall_up);
}

void check_motion(const std::string& key, const BoundaryOptions& o) {
  const std::string type(name_of(o.type));
  const auto finite = [](const Pair& p) { return std::isfinite(p[0]) && std::isfinite(p[1]); };
  if (o.velocity_m_s && ((o.type != Type::fixed && o.type != Type::roller) || !finite(*o.velocity_m_s)))
    throw InputError(key + ".velocity_m_s: given with type \"" + type + "\", expected a velocity and type = \"fixed\" or \"roller\"");
  if (o.motion_table.any() && o.type != Type::fixed && o.type != Type::roller)
    throw InputError(key + ".motion: given with type \"" + type + "\", expected type = \"fixed\" or \"roller\"");
  if (o.motion_table.any() && o.velocity_m_s) throw InputError(key + ".motion: given beside velocity_m_s, expected one of them");
  if (o.motion_table.any() && o.motion_table.courses[2].given()) throw InputError(key + ".motion: found a turn, expected displacements or velocities");
  if (o.withdraw_m_s && (o.velocity_m_s || o.motion_table.any()))
    throw InputError(key + ".withdraw_m_s: given beside a velocity, expected one of them");
  if (!o.grips && (o.motion_table.any() || (o.velocity_m_s && o.type == Type::roller)))
    throw InputError(key + (o.velocity_m_s ? ".velocity_m_s: a roller" : ".motion: a boundary") +
                     " that moves beside [water] or tied sides, expected type = \"fixed\" and velocity_m_s, or a [body.NAME]");
  if (o.withdraw_m_s && (!finite(*o.withdraw_m_s) || !(point(*o.withdraw_m_s).norm() > 0)))
    throw InputError(key + ".withdraw_m_s: expected a velocity other than 0");
  if (o.withdraw_m_s && (o.type == Type::traction || o.type == Type::absorbing))
    throw InputError(key + ".withdraw_m_s: given with type \"" + type + "\", expected fixed, roller or frictional");
  if (o.across_m.has_value() != (o.type == Type::tied))
    throw InputError(key + ".across_m: " + (o.across_m ? "given with type \"" + type + "\", expected type = \"tied\"" : "missing beside type = \"tied\""));
  if (o.type == Type::tied && (o.line_m.empty() || o.withdraw_m_s))
    throw InputError(key + (o.line_m.empty() ? ".line_m: missing; one side of what is tied" : ".withdraw_m_s: given with type \"tied\", expected fixed, roller or frictional"));
  if (o.follows_face && o.type != Type::traction)
    throw InputError(key + ".follows_face: given with type \"" + type + "\", expected type = \"traction\"");
  if (o.traction_pa && (o.type != Type::traction || !finite(*o.traction_pa)))
    throw InputError(key + ".traction_pa: given with type \"" + type + "\", expected type = \"traction\"");
}

// Does a wall along the grid go on beyond an end, to the ring of nodes around the domain? There shapes of three nodes reach past the end
// of a wall that ends with the domain, and material with a free face there would hang over it by a row of nodes.
bool goes_on(const GridGeometry& g, const Wall& wall, const Vec2& end, const Vec2& outward) {
  if (!g.centred || wall.side == wall_none || wall.type == Type::absorbing || wall.type == Type::tied) return false;
  const Vec2 beyond = end + 0.5 * g.domain.spacing.cwiseProduct(outward) - g.domain.origin;
  const Vec2 size(g.domain.spacing.x() * (g.domain.nx - 1), g.domain.spacing.y() * (g.domain.ny - 1));
  const int axis = std::abs(outward.x()) > std::abs(outward.y()) ? 0 : 1;
  return outward[axis] < 0 ? beyond[axis] <= 0 : beyond[axis] >= size[axis];
}

void take_nodes_along_line(const BoundaryOptions& o, const GridGeometry& g, const Vec2& centroid, bool may_move,
                           Wall& wall) {
  const Grid& grid = g.field_grid;
  if (o.line_m.size() != 2) throw InputError(wall.key + ".line_m: expected two end points");
  const Vec2 a = point(o.line_m[0]), b = point(o.line_m[1]);
  const double length = (b - a).norm();
  if (!(length > 0)) throw InputError(wall.key + ".line_m: expected two different end points");
  const Vec2 along = (b - a) / length;
  Vec2 across(-along.y(), along.x());
  if (across.dot(centroid - a) > 0) across = -across;
  if (o.normal) {
    wall.normal = unit(*o.normal, wall.key);
    if (across.dot(wall.normal) < 0) across = -across;
  } else {
    wall.normal = across;
  }
  const double h = 1 / across.cwiseQuotient(grid.spacing).norm(), half = 0.5 * h, round_off = 1e-6 * h;
  const double half_along = 0.5 / along.cwiseQuotient(grid.spacing).norm();
  wall.from = a;
  wall.to = b;
  place_along_grid(g, across, may_move, wall);
  const double before = goes_on(g, wall, a, -along) ? h : 0, after = goes_on(g, wall, b, along) ? h : 0;
  const bool moves = wall.shift != Vec2(0, 0);
  // Functions of three nodes that stay as they are reach one row further.
  const double behind = g.centred && wall.side == wall_none ? half + h : half;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const Vec2 from_a = grid.position(i, j) - a;
      const double out = from_a.dot(across), on = std::clamp(from_a.dot(along), -before, length + after);
      const double past = std::abs(from_a.dot(along) - on);
      // (Two walls may move the node of a corner.)
      const bool near =
          moves ? past <= half_along + round_off : std::hypot(past, std::min(out, half)) <= half + round_off;
      if (out > -half + round_off && out <= behind + round_off && near)
        wall.nodes.push_back(std::uint32_t(grid.node(i, j)));
    }
}

void take_nodes_in_polygon(const BoundaryOptions& o, const Grid& grid, Wall& wall) {
  std::vector<Vec2> vertices;
  for (const Pair& p : o.polygon_m) vertices.push_back(point(p));
  const Polygon polygon(vertices, wall.key + ".polygon_m");
  if (o.normal)
    wall.normal = unit(*o.normal, wall.key);
  else if (wall.type != Type::fixed)
    throw InputError(wall.key + ".normal: a " + std::string(name_of(o.type)) + " polygon needs its normal");
  const double round_off = 1e-6 * grid.spacing.minCoeff();
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const Vec2 x = grid.position(i, j);
      Vec2 unused;
      if (polygon.contains(x) || polygon.distance(x, unused) <= round_off) wall.nodes.push_back(std::uint32_t(grid.node(i, j)));
    }
}

Wall wall_of(const std::string& key, const BoundaryOptions& o, const GridGeometry& g, const Vec2& centroid,
             const Impedance& impedance, bool may_move) {
  Wall wall;
  wall.key = key;
  wall.type = o.type;
  wall.friction = o.friction;
  if (!(o.friction >= 0)) throw InputError(key + ".friction: expected 0 or more");
  if (o.until_s) wall.until = *o.until_s;
  if (o.velocity_m_s) wall.velocity = point(*o.velocity_m_s);
  if (o.line_m.empty() == o.polygon_m.empty()) throw InputError(key + ": expected either line_m or polygon_m");
  if (o.line_m.empty()) take_nodes_in_polygon(o, g.field_grid, wall);
  else
    take_nodes_along_line(o, g, centroid, may_move, wall);
  if (wall.nodes.empty()) throw InputError(key + ": restrains no node of the grid, expected at least one");
  if (wall.type == Type::absorbing) {
    if (wall.side == wall_none)
      throw InputError(key + ".line_m: an absorbing wall must lie along the grid, on a line of nodes");
    const bool upright = wall.side == wall_left || wall.side == wall_right;
    wall.impedance = impedance(0.5 * (wall.from + wall.to));
    for (double& c : wall.impedance) c *= upright ? g.grid.spacing.y() : g.grid.spacing.x();
  }
  for (const std::uint32_t n : wall.nodes)
    wall.release.push_back(release_time(o, wall.until, g.position(n), g.grid.spacing.minCoeff()));
  return wall;
}

// `area`: of the points before any was filled up.
void fill_up_to(const Wall& wall, int axis, const GridGeometry& g, const std::vector<double>& area,
                ParticleSet& points) {
  const Vec2& h = g.domain.spacing;
  const double inwards = wall.side & (wall_left | wall_down) ? 1 : -1, round_off = 1e-6 * h[axis];
  const auto [from, to] = std::minmax(wall.from[1 - axis], wall.to[1 - axis]);
  const double margin = 0.5 * h[1 - axis];
  const auto side = [&](std::size_t k) { return h[axis] * std::sqrt(area[k] / h.prod()); };
  const auto inside = [&](std::size_t k) { return inwards * (points.x0[k][axis] - wall.from[axis]); };
  std::vector<std::size_t> beside;
  double nearest = h[axis];
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double along = points.x0[k][1 - axis];
    if (along < from - margin || along > to + margin || inside(k) < -round_off || inside(k) > side(k) + round_off)
      continue;
    beside.push_back(k);
    nearest = std::min(nearest, inside(k));
  }
  // To the end of the wall's own cell the gradient of splines is constant, then linear.
  const double constant = g.shape == ShapeKind::bspline ? 0.5 * h[axis] - inwards * wall.shift[axis] : 2 * h[axis];
  for (const std::size_t k : beside) {
    if (inside(k) > nearest + round_off) continue;
    const double end = inside(k) + 0.5 * side(k),
                 place = end > constant + round_off ? (end * end + constant * constant) / (2 * end) : 0.5 * end;
    points.x0[k][axis] = wall.from[axis] + inwards * place;
    points.area[k] *= end / side(k);
  }
}

// Are the nodes that two walls move next to each other, or the same?
bool move_neighbours(const Wall& a, const Wall& b, const Vec2& h) {
  const Vec2 apart = (a.from - a.shift) - (b.from - b.shift);
  const auto along = [&](int axis) {
    return a.shift[axis] != 0 && b.shift[axis] != 0 && a.side != b.side && std::abs(apart[axis]) < 1.5 * h[axis];
  };
  return along(0) || along(1);
}

}  // namespace

void fill_up_to_walls(const std::vector<Wall>& walls, const GridGeometry& g, ParticleSet& points) {
  const std::vector<double> area = points.area;
  for (int axis = 0; axis < 2; ++axis)
    for (const Wall& wall : walls)
      if (wall.shift[axis] != 0) fill_up_to(wall, axis, g, area, points);
}

std::vector<Wall> walls_of(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries,
                           const GridGeometry& g, const Vec2& centroid, const Impedance& impedance, bool may_move) {
  std::vector<Wall> walls;
  std::vector<const BoundaryOptions*> of;
  for (const auto& [name, options] : boundaries) check_motion("boundary." + name, options);
  for (const auto& [name, options] : boundaries) {
    if (options.type == Type::traction) continue;  // a load (tractions.hpp)
    if (options.grips) continue;                   // a body (rigid_body.hpp)
    walls.push_back(wall_of("boundary." + name, options, g, centroid, impedance, may_move));
    of.push_back(&options);
    if (options.type != Type::tied) continue;
    of.push_back(nullptr);
    BoundaryOptions opposite = options;
    for (Pair& end : opposite.line_m) end = {end[0] + (*options.across_m)[0], end[1] + (*options.across_m)[1]};
    walls.push_back(wall_of("boundary." + name, opposite, g, centroid, impedance, false));
  }
  std::vector<std::size_t> stay;
  for (std::size_t a = 0; a < walls.size(); ++a)
    if (std::any_of(walls.begin(), walls.end(),
                    [&](const Wall& b) { return move_neighbours(walls[a], b, g.domain.spacing); }))
      stay.push_back(a);
  for (const std::size_t a : stay) walls[a] = wall_of(walls[a].key, *of[a], g, centroid, impedance, false);
  return walls;
}

}  // namespace pivnp::mpm

#include "mpm/constraint/boundary.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

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

// The side on which a wall along the grid, through nodes, has nothing; wall_none for any other.
std::uint8_t side_along_grid(const Grid& grid, const Vec2& a, const Vec2& outward) {
  const Vec2 at = (a - grid.origin).cwiseQuotient(grid.spacing);
  const auto on_nodes = [](double s) { return std::abs(s - std::round(s)) < 1e-6; };
  if (std::abs(outward.y()) < 1e-9 && on_nodes(at.x())) return outward.x() < 0 ? wall_left : wall_right;
  if (std::abs(outward.x()) < 1e-9 && on_nodes(at.y())) return outward.y() < 0 ? wall_down : wall_up;
  return wall_none;
}

void check_motion(const std::string& key, const BoundaryOptions& o) {
  const std::string type(name_of(o.type));
  const auto finite = [](const Pair& p) { return std::isfinite(p[0]) && std::isfinite(p[1]); };
  if (o.velocity_m_s && (o.type != BoundaryType::fixed || !finite(*o.velocity_m_s)))
    throw InputError(key + ".velocity_m_s: given with type \"" + type + "\", expected a velocity and type = \"fixed\"");
  if (o.withdraw_m_s && (!finite(*o.withdraw_m_s) || !(point(*o.withdraw_m_s).norm() > 0)))
    throw InputError(key + ".withdraw_m_s: expected a velocity other than 0");
  if (o.withdraw_m_s && (o.type == BoundaryType::traction || o.type == BoundaryType::absorbing))
    throw InputError(key + ".withdraw_m_s: given with type \"" + type + "\", expected fixed, roller or frictional");
  if (o.across_m.has_value() != (o.type == BoundaryType::tied))
    throw InputError(key + ".across_m: " + (o.across_m ? "given with type \"" + type + "\", expected type = \"tied\"" : "missing beside type = \"tied\""));
  if (o.type == BoundaryType::tied && (o.line_m.empty() || o.withdraw_m_s))
    throw InputError(key + (o.line_m.empty() ? ".line_m: missing; one side of what is tied" : ".withdraw_m_s: given with type \"tied\", expected fixed, roller or frictional"));
  if (o.traction_pa && (o.type != BoundaryType::traction || !finite(*o.traction_pa)))
    throw InputError(key + ".traction_pa: given with type \"" + type + "\", expected type = \"traction\"");
}

}  // namespace

Restraints::Restraints(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const GridState& g,
                       const Vec2& centroid, const Impedance& impedance) {
  std::vector<std::vector<std::uint16_t>> walls_of_node(g.field_grid.node_count());
  std::vector<const BoundaryOptions*> of_wall;
  // The other side of what is tied is a wall too.
  std::deque<std::pair<std::string, BoundaryOptions>> all;
  for (const auto& [name, options] : boundaries) {
    check_motion("boundary." + name, options);
    all.emplace_back(name, options);
    if (options.type != BoundaryType::tied) continue;
    all.push_back(all.back());
    for (Pair& end : all.back().second.line_m) end = {end[0] + (*options.across_m)[0], end[1] + (*options.across_m)[1]};
    all.back().second.across_m.reset();
  }
  for (const auto& [name, options] : all) {
    const std::string key = "boundary." + name;
    if (options.type == BoundaryType::traction) continue;  // a load, no restraint (loading.hpp)
    Wall wall;
    wall.type = options.type;
    wall.normal = Vec2::Zero();
    wall.friction = options.friction;
    if (!(options.friction >= 0)) throw InputError(key + ".friction: expected 0 or more");
    if (options.until_s) wall.until = *options.until_s;
    if (options.velocity_m_s) wall.velocity = point(*options.velocity_m_s);
    if (options.line_m.empty() == options.polygon_m.empty())
      throw InputError(key + ": expected either line_m or polygon_m");
    add_nodes(key, options, wall, g, centroid, walls_of_node);
    if (wall.type == Type::absorbing) {
      if (wall.side == wall_none)
        throw InputError(key + ".line_m: an absorbing wall must lie along the grid, on a line of nodes");
      const bool upright = wall.side == wall_left || wall.side == wall_right;
      wall.impedance = impedance(0.5 * (wall.from + wall.to));
      for (double& c : wall.impedance) c *= upright ? g.grid.spacing.y() : g.grid.spacing.x();
    }
    walls_.push_back(wall);
    of_wall.push_back(&options);
    if (wall.type == Type::tied && !options.across_m) tie(key, g, walls_of_node);
  }
  for (std::size_t n = 0; n < walls_of_node.size(); ++n) {
    if (walls_of_node[n].empty()) continue;
    RestrainedNode at{std::uint32_t(n), walls_of_node[n], {}};
    const Vec2 x = g.position(n);
    for (const std::uint16_t id : at.walls)
      at.until.push_back(release(*of_wall[id], walls_[id], x, g.grid.spacing.minCoeff()));
    changes_.insert(changes_.end(), at.until.begin(), at.until.end());
    nodes_.push_back(std::move(at));
  }
  const std::size_t of_one = nodes_.size();
  for (std::size_t field = 1; field < std::size_t(g.velocity_fields); ++field)
    for (std::size_t k = 0; k < of_one; ++k) {
      nodes_.push_back(nodes_[k]);
      nodes_.back().node += std::uint32_t(field * g.field_nodes());
    }
  std::sort(changes_.begin(), changes_.end());
  changes_.erase(std::unique(changes_.begin(), changes_.end()), changes_.end());
}

// The last two walls: the nodes of the first with those opposite.
void Restraints::tie(const std::string& key, const GridState& g,
                     const std::vector<std::vector<std::uint16_t>>& walls_of_node) {
  const auto second = std::uint16_t(walls_.size() - 1), first = std::uint16_t(second - 1);
  if (walls_[first].side == wall_none || walls_[second].side == wall_none || walls_[first].side == walls_[second].side)
    throw InputError(key + ".across_m: expected both sides along the grid, on lines of nodes, with the material between");
  const Vec2 apart = (walls_[second].from - walls_[first].from).cwiseQuotient(g.grid.spacing);
  const auto offset = std::ptrdiff_t(std::lround(apart.x())) + std::ptrdiff_t(std::lround(apart.y())) * g.grid.nx;
  if ((apart - Vec2(std::round(apart.x()), std::round(apart.y()))).norm() > 1e-6 || offset == 0)
    throw InputError(key + ".across_m: expected a whole number of cells");
  seams_.push_back({walls_[first].from, walls_[second].from - walls_[first].from, walls_[first].until});
  const auto on = [&](std::ptrdiff_t n, std::uint16_t wall) {
    const auto& walls = walls_of_node[std::size_t(n)];
    return std::find(walls.begin(), walls.end(), wall) != walls.end();
  };
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(walls_of_node.size()); ++n) {
    if (!on(n, first)) continue;
    if (n + offset < 0 || n + offset >= std::ptrdiff_t(walls_of_node.size()) || !on(n + offset, second))
      throw InputError(key + ".across_m: a node of line_m has none opposite in the grid, expected both sides inside it");
    for (std::size_t field = 0; field < std::size_t(g.velocity_fields); ++field) {
      const auto from = std::ptrdiff_t(field * g.field_nodes());
      ties_.push_back({{std::uint32_t(from + n), std::uint32_t(from + n + offset)}, walls_[first].until});
    }
  }
}

// A node is let go when the shape, moving, is a hundredth of a cell further from it than it was: inside a polygon, when
// its trailing side has passed; next to a line, when its trailing end has.
double Restraints::release(const BoundaryOptions& o, const Wall& wall, const Vec2& x, double spacing) const {
  if (!o.withdraw_m_s) return wall.until;
  const Vec2 v = point(*o.withdraw_m_s);
  std::vector<Vec2> vertices;
  for (const Pair& p : o.line_m.empty() ? o.polygon_m : o.line_m) vertices.push_back(point(p));
  const auto distance = [&](const Vec2& y) {
    if (o.line_m.empty()) {
      const Polygon polygon(vertices, "boundary");
      Vec2 unused;
      return polygon.contains(y) ? 0.0 : polygon.distance(y, unused);
    }
    const Vec2 d = vertices[1] - vertices[0];
    const double on = std::clamp((y - vertices[0]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    return (y - vertices[0] - on * d).norm();
  };
  const double start = distance(x), tolerance = 0.01 * spacing;
  const double step = tolerance / v.norm();
  double length = 0;
  for (const Vec2& a : vertices)
    for (const Vec2& b : vertices) length = std::max(length, (a - b).norm());
  const double most = (length + 2 * spacing) / v.norm();
  double low = 0, high = most;
  for (double t = 0.25 * spacing / v.norm(); t < most; t += 0.25 * spacing / v.norm())
    if (distance(x - t * v) > start + tolerance) {
      high = t;
      low = t - 0.25 * spacing / v.norm();
      break;
    }
  while (high - low > step) {
    const double middle = 0.5 * (low + high);
    (distance(x - middle * v) > start + tolerance ? high : low) = middle;
  }
  // On a raster, so that rows of nodes go together and the steps are not cut to pieces.
  const double raster = 0.1 * spacing / v.norm();
  return std::min(wall.until, o.withdraw_from_s + std::ceil(high / raster) * raster);
}

void Restraints::add_nodes(const std::string& key, const BoundaryOptions& options, Wall& wall, const GridState& g,
                           const Vec2& centroid, std::vector<std::vector<std::uint16_t>>& walls_of_node) {
  const Grid& grid = g.field_grid;
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
    wall.side = side_along_grid(grid, a, across);
    // Shapes whose functions stay as they are reach one row further.
    const double behind = g.centred && wall.side == wall_none ? half + h : half;
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
      throw InputError(key + ".normal: a " + std::string(name_of(options.type)) + " polygon needs its normal");
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
                          bool equilibrium) const {
  const Vec2* roller = nullptr;
  bool frictional = false;
  for (std::size_t w = 0; w < at.walls.size(); ++w) {
    const Wall& wall = walls_[at.walls[w]];
    if (time >= at.until[w]) continue;
    if (wall.type == Type::fixed) return equilibrium ? Vec2(0, 0) : wall.velocity;
    if (equilibrium && wall.type == Type::absorbing) return Vec2::Zero();
    if (wall.type == Type::frictional) frictional = true;
    if (wall.type != Type::roller) continue;
    // Two rollers that are not parallel leave no way to go.
    if (roller && std::abs(roller->x() * wall.normal.y() - roller->y() * wall.normal.x()) > 1e-6) return Vec2::Zero();
    roller = &wall.normal;
  }
  if (roller) v -= v.dot(*roller) * *roller;
  if (!frictional) return v;
  for (int pass = 0; pass < 2; ++pass) {  // twice, for corners of two walls
    for (std::size_t w = 0; w < at.walls.size(); ++w) {
      const Wall& wall = walls_[at.walls[w]];
      if (time >= at.until[w] || wall.type != Type::frictional) continue;
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
    const Vec2 x = g.position(at.node);
    const double half = 0.5 * g.grid.spacing.minCoeff();
    const double share = (x - wall.from).norm() < half || (x - wall.to).norm() < half ? 0.5 : 1;
    const double per = share * dt / g.node[at.node].mass, across = v.dot(wall.normal);
    const Vec2 along = v - across * wall.normal;
    v = across / (1 + per * wall.impedance[0]) * wall.normal + along / (1 + per * wall.impedance[1]);
  }
  return v;
}

void Restraints::apply(double time, double dt, GridState& g, std::vector<Reaction>& reactions) {
  for (const Tie& tie : ties_) {
    Node &a = g.node[tie.node[0]], &b = g.node[tie.node[1]];
    if (time >= tie.until || !(a.mass > 0 && b.mass > 0)) continue;
    const double mass = a.mass + b.mass, reduced = a.mass * b.mass / mass;
    const Vec2 impulse = reduced * Vec2(b.nx - a.nx, b.ny - a.ny);
    reactions.push_back({tie.node[0], impulse.x(), impulse.y(), 0, 0});
    reactions.push_back({tie.node[1], -impulse.x(), -impulse.y(), 0, 0});
    a.nx = b.nx = (a.mass * a.nx + b.mass * b.nx) / mass;
    a.ny = b.ny = (a.mass * a.ny + b.mass * b.ny) / mass;
    a.held = b.held = true;
  }
  for (RestrainedNode& at : nodes_) {
    Node& node = g.node[at.node];
    if (!(node.mass > 0)) continue;
    at.stuck = false;
    const Vec2 free(node.nx, node.ny);
    const Vec2 v = restrain(at, time, absorbed(at, time, dt, g, free), true, at.stuck, dt == 0);
    if (g.velocity_fields > 1) at.mobility = mobility_of(at, time, free, dt == 0);
    if (v == free) continue;
    const Vec2 wall = given_velocity(at, time, dt == 0);
    reactions.push_back({at.node, node.mass * (v.x() - free.x()), node.mass * (v.y() - free.y()), wall.x(), wall.y()});
    node.nx = v.x();
    node.ny = v.y();
    node.held = true;
  }
}

void Restraints::apply_to_remapped(double time, GridState& g, bool equilibrium) const {
  for (const Tie& tie : ties_) {
    const Node &a = g.node[tie.node[0]], &b = g.node[tie.node[1]];
    if (time >= tie.until || !(a.mass > 0 && b.mass > 0)) continue;
    const double mass = a.mass + b.mass;
    const GridState::StrainVelocity u = g.strain_velocity(tie.node[0]), w = g.strain_velocity(tie.node[1]);
    const double x = (a.mass * u.x + b.mass * w.x) / mass, y = (a.mass * u.y + b.mass * w.y) / mass;
    if (equilibrium || g.has_own_strain_velocity(tie.node[0])) u.x = x, u.y = y;
    if (equilibrium || g.has_own_strain_velocity(tie.node[1])) w.x = x, w.y = y;
  }
  for (const RestrainedNode& at : nodes_) {
    if (!(g.node[at.node].mass > 0 && (equilibrium || g.has_own_strain_velocity(at.node)))) continue;
    bool unused = false;
    const GridState::StrainVelocity u = g.strain_velocity(at.node);
    const Vec2 v = at.stuck ? Vec2::Zero() : restrain(at, time, Vec2(u.x, u.y), false, unused, equilibrium);
    u.x = v.x();
    u.y = v.y();
  }
}

Mat2 Restraints::mobility_of(const RestrainedNode& at, double time, const Vec2& free, bool equilibrium) const {
  if (at.stuck) return Mat2::Zero();
  Mat2 left = Mat2::Identity();
  for (std::size_t w = 0; w < at.walls.size(); ++w) {
    const Wall& wall = walls_[at.walls[w]];
    if (time >= at.until[w]) continue;
    if (wall.type == Type::fixed || (equilibrium && wall.type == Type::absorbing)) return Mat2::Zero();
    if (wall.type == Type::absorbing || wall.type == Type::tied || (wall.type == Type::frictional && !(free.dot(wall.normal) > 0))) continue;
    const Vec2 normal = left * wall.normal;
    if (normal.norm() > 1e-6) left -= normal.normalized() * normal.normalized().transpose();
  }
  return left;
}

Mat2 Restraints::mobility(std::size_t node) const {
  const auto at = std::lower_bound(nodes_.begin(), nodes_.end(), node,
                                   [](const RestrainedNode& a, std::size_t n) { return a.node < n; });
  return at != nodes_.end() && at->node == node ? at->mobility : Mat2(Mat2::Identity());
}

Vec2 Restraints::given_velocity(const RestrainedNode& at, double time, bool equilibrium) const {
  for (std::size_t w = 0; w < at.walls.size() && !equilibrium; ++w)
    if (time < at.until[w] && walls_[at.walls[w]].type == Type::fixed) return walls_[at.walls[w]].velocity;
  return Vec2::Zero();
}

double Restraints::next_change(double time) const {
  const auto it = std::upper_bound(changes_.begin(), changes_.end(), time);
  return it == changes_.end() ? std::numeric_limits<double>::infinity() : *it;
}

std::vector<std::uint8_t> Restraints::wall_sides(double time, const Grid& grid) const {
  std::vector<std::uint8_t> sides(grid.node_count(), wall_none);
  for (const RestrainedNode& at : nodes_)
    for (std::size_t w = 0; w < at.walls.size(); ++w)
      if (time < at.until[w]) sides[at.node] = std::uint8_t(sides[at.node] | walls_[at.walls[w]].side);
  return sides;
}

bool Restraints::any_absorbing() const {
  return std::any_of(walls_.begin(), walls_.end(), [](const Wall& w) { return w.type == Type::absorbing; });
}

bool Restraints::any_tied() const { return !ties_.empty(); }

void Restraints::carry_over(double time, Particles& p) const {
  for (const Seam& seam : seams_) {
    if (time >= seam.until) continue;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p.cell[k] == Particles::ended) continue;
      const double share = (Vec2(p.x[k], p.y[k]) - seam.from).dot(seam.across) / seam.across.squaredNorm();
      if (share >= 0 && share <= 1) continue;
      const Vec2 by = share < 0 ? seam.across : Vec2(-seam.across);
      p.x[k] += by.x();
      p.y[k] += by.y();
      p.carried_x[k] += by.x();
      p.carried_y[k] += by.y();
    }
  }
}

}  // namespace pivnp::mpm

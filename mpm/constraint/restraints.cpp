#include "mpm/constraint/restraints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::mpm {

using Type = BoundaryType;

Restraints::Restraints(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const GridGeometry& g,
                       const Vec2& centroid, const Impedance& impedance, bool may_move_nodes)
    : walls_(walls_of(boundaries, g, centroid, impedance, may_move_nodes)) {
  std::vector<RestrainedNode> at_node(g.field_grid.node_count());
  for (std::size_t w = 0; w < walls_.size(); ++w)
    for (std::size_t k = 0; k < walls_[w].nodes.size(); ++k) {
      RestrainedNode& at = at_node[walls_[w].nodes[k]];
      at.walls.push_back(std::uint16_t(w));
      at.until.push_back(walls_[w].release[k]);
    }
  for (std::size_t w = 0; w < walls_.size(); ++w)
    if (walls_[w].type == Type::tied) {
      tied_.tie(walls_[w], walls_[w + 1], g);
      ++w;
    }
  if (g.centred) hold_beyond_ties(at_node);
  for (int field = 0; field < g.velocity_fields; ++field)
    for (std::size_t n = 0; n < at_node.size(); ++n) {
      if (at_node[n].walls.empty()) continue;
      nodes_.push_back(at_node[n]);
      nodes_.back().node = std::uint32_t(std::size_t(field) * g.field_nodes() + n);
      nodes_.back().place = g.position(n);
      for (const std::uint16_t w : nodes_.back().walls)
        for (int axis = 0; axis < 2; ++axis)
          if (walls_[w].shift[axis] != 0) nodes_.back().place[axis] = walls_[w].from[axis];
    }
  for (const RestrainedNode& at : nodes_) changes_.insert(changes_.end(), at.until.begin(), at.until.end());
  std::sort(changes_.begin(), changes_.end());
  changes_.erase(std::unique(changes_.begin(), changes_.end()), changes_.end());
}

// What holds a node holds those that are one with it, beyond the sides, where no wall may reach. (But not what absorbs waves: that acts on
// a length of wall.)
void Restraints::hold_beyond_ties(std::vector<RestrainedNode>& at_node) const {
  for (const TiedSides::Ring& ring : tied_.rings())
    for (const std::uint32_t from : ring.nodes)
      for (const std::uint32_t to : ring.nodes) {
        if (from == to || from >= at_node.size() || to >= at_node.size()) continue;
        const RestrainedNode& one = at_node[from];
        RestrainedNode& other = at_node[to];
        for (std::size_t w = 0; w < one.walls.size(); ++w) {
          const Type type = walls_[one.walls[w]].type;
          if (type == Type::tied || type == Type::absorbing || std::count(other.walls.begin(), other.walls.end(), one.walls[w]) > 0) continue;
          other.walls.push_back(one.walls[w]);
          other.until.push_back(one.until[w]);
        }
      }
}

void Restraints::apply(double time, double dt, GridState& g, std::vector<Reaction>& reactions, std::span<Impulse> of_walls) {
  tied_.apply(time, g, reactions);
  for (RestrainedNode& at : nodes_) {
    Node& node = g.node[at.node];
    if (!(node.mass > 0)) continue;
    at.stuck = false;
    const Vec2 free(node.nx, node.ny);
    const Vec2 dashed = absorbed(at, time, dt, g, free), v = restrain(at, time, dashed, true, at.stuck, dt == 0);
    if (g.velocity_fields > 1) at.mobility = mobility_of(at, time, free, dt == 0);
    if (v == free) continue;
    const Vec2 wall = given_velocity(at, time, dt == 0);
    reactions.push_back({at.node, node.mass * (v.x() - free.x()), node.mass * (v.y() - free.y()), wall.x(), wall.y()});
    if (!of_walls.empty()) add_impulse(at, time, node.mass * (v - free), of_walls);
    node.nx = v.x();
    node.ny = v.y();
    // (Dashpots drive as forces do, and so does the friction of one wall along an axis.)
    const Wall& first = walls_[at.walls.front()];
    const bool slides = at.walls.size() == 1 && first.type == Type::frictional && !at.stuck;
    node.held_x = node.held_x || (v.x() != dashed.x() && !(slides && first.normal.x() == 0));
    node.held_y = node.held_y || (v.y() != dashed.y() && !(slides && first.normal.y() == 0));
  }
}

void Restraints::apply_to_strain_velocity(double time, GridState& g, bool equilibrium) const {
  tied_.apply_to_strain_velocity(time, g, equilibrium);
  for (const RestrainedNode& at : nodes_) {
    if (!(g.node[at.node].mass > 0 && (equilibrium || g.has_own_strain_velocity(at.node)))) continue;
    bool unused = false;
    const GridState::StrainVelocity u = g.strain_velocity(at.node);
    const Vec2 v = at.stuck ? Vec2::Zero() : restrain(at, time, Vec2(u.x, u.y), false, unused, equilibrium);
    u.x = v.x();
    u.y = v.y();
  }
}

bool Restraints::any_rubs() const {
  return std::any_of(walls_.begin(), walls_.end(),
                     [](const Wall& w) { return w.type == Type::frictional && w.friction > 0; });
}

std::vector<std::uint32_t> Restraints::rubbing(double time, const GridState& g) const {
  std::vector<std::uint32_t> nodes;
  if (!any_rubs()) return nodes;
  for (const RestrainedNode& at : nodes_) {
    if (!(g.node[at.node].mass > 0)) continue;
    for (std::size_t w = 0; w < at.walls.size(); ++w)
      if (const Wall& wall = walls_[at.walls[w]];
          wall.type == Type::frictional && wall.friction > 0 && time < at.until[w]) {
        nodes.push_back(at.node);
        break;
      }
  }
  return nodes;
}

void Restraints::press(std::span<const std::uint32_t> nodes, std::span<const Vec2> impulses, const GridState& g) {
  if (!any_rubs()) return;
  std::size_t k = 0;
  for (RestrainedNode& at : nodes_) {
    at.pressed = Vec2::Zero();
    if (k < nodes.size() && nodes[k] == at.node) at.pressed = impulses[k++] / g.node[at.node].mass;
  }
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
    apply_friction(at, time, v, with_friction, stuck);
    if (roller) v -= v.dot(*roller) * *roller;
  }
  return v;
}

// Coulomb's law at the frictional walls one after the other.
void Restraints::apply_friction(const RestrainedNode& at, double time, Vec2& v, bool with_friction, bool& stuck) const {
  for (std::size_t w = 0; w < at.walls.size(); ++w) {
    const Wall& wall = walls_[at.walls[w]];
    if (time >= at.until[w] || wall.type != Type::frictional) continue;
    const double inward = v.dot(wall.normal);
    if (!(inward > 0)) continue;
    Vec2 tangential = v - inward * wall.normal;
    if (with_friction) {
      const double speed = tangential.norm(),
                   most = wall.friction * std::max(0.0, inward - at.pressed.dot(wall.normal));
      stuck = speed <= most;
      tangential *= stuck ? 0.0 : 1 - most / speed;
    }
    v = tangential;
  }
}

// v / (1 + dt C / m), C the dashpots of the node's length of wall: half of it at a wall's ends.
Vec2 Restraints::absorbed(const RestrainedNode& at, double time, double dt, const GridState& g, Vec2 v) const {
  for (const std::uint16_t id : at.walls) {
    const Wall& wall = walls_[id];
    if (wall.type != Type::absorbing || time >= wall.until) continue;
    const double half = 0.5 * g.grid.spacing.minCoeff();
    const double share = (at.place - wall.from).norm() < half || (at.place - wall.to).norm() < half ? 0.5 : 1;
    const double per = share * dt * g.measure(at.node) / g.node[at.node].mass, across = v.dot(wall.normal);
    const Vec2 along = v - across * wall.normal;
    v = across / (1 + per * wall.impedance[0]) * wall.normal + along / (1 + per * wall.impedance[1]);
  }
  return v;
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

Mat2 Restraints::hold(std::size_t node, const Vec2& gravity) const {
  const auto at = std::lower_bound(nodes_.begin(), nodes_.end(), node,
                                   [](const RestrainedNode& a, std::size_t n) { return a.node < n; });
  Mat2 held = Mat2::Zero();
  if (at == nodes_.end() || at->node != node) return held;
  for (std::size_t w = 0; w < at->walls.size(); ++w) {
    const Wall& wall = walls_[at->walls[w]];
    if (at->until[w] <= 0 || wall.type == Type::tied) continue;
    const bool pulls_off = gravity.dot(wall.normal) < -1e-6 * gravity.norm();
    if (wall.type == Type::roller || (wall.type == Type::frictional && wall.friction == 0 && !pulls_off))
      held += wall.normal * wall.normal.transpose();
    else if (wall.type != Type::frictional || !pulls_off)
      held += Mat2::Identity();
  }
  return held;
}

// A fixed wall takes all. In the corner of two others each takes what is along its normal, if that is what it can do.
void Restraints::add_impulse(const RestrainedNode& at, double time, const Vec2& impulse,
                             std::span<Impulse> of_walls) const {
  constexpr double corner = 0.5;  // sine of the least angle between two walls that share an impulse
  const Wall* found[2] = {nullptr, nullptr};
  for (std::size_t w = 0; w < at.walls.size(); ++w) {
    const Wall& wall = walls_[at.walls[w]];
    if (time >= at.until[w] || wall.type == Type::tied) continue;
    if (wall.type == Type::fixed) return of_walls[at.walls[w]].add(impulse, at.place);
    if (!found[0]) found[0] = &wall;
    else if (!found[1]) found[1] = &wall;
  }
  if (!found[0]) return;
  Vec2 of_second(0, 0);
  if (found[1]) {
    const Vec2 &first = found[0]->normal, &second = found[1]->normal;
    const double across = first.x() * second.y() - first.y() * second.x();
    if (std::abs(across) >= corner) of_second = (first.x() * impulse.y() - first.y() * impulse.x()) / across * second;
    const auto cannot = [](const Wall& wall, const Vec2& i) { return wall.type == Type::frictional && i.dot(wall.normal) > 0; };
    if (cannot(*found[1], of_second)) of_second = Vec2(0, 0);
    else if (cannot(*found[0], impulse - of_second)) of_second = impulse;
    of_walls[std::size_t(found[1] - walls_.data())].add(of_second, at.place);
  }
  of_walls[std::size_t(found[0] - walls_.data())].add(impulse - of_second, at.place);
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

std::vector<std::uint8_t> Restraints::wall_sides(double time, const Grid& grid, bool tied) const {
  std::vector<std::uint8_t> sides(grid.node_count(), wall_none);
  for (const RestrainedNode& at : nodes_)
    for (std::size_t w = 0; w < at.walls.size(); ++w)
      if (const Wall& wall = walls_[at.walls[w]]; time < at.until[w] && (tied || wall.type != Type::tied))
        sides[at.node] = std::uint8_t(sides[at.node] | wall.side);
  return sides;
}

std::vector<Vec2> Restraints::node_shifts(double time, const Grid& grid) const {
  std::vector<Vec2> shifts;
  for (const RestrainedNode& at : nodes_)
    for (std::size_t w = 0; w < at.walls.size(); ++w) {
      const Wall& wall = walls_[at.walls[w]];
      if (time >= at.until[w] || wall.shift == Vec2(0, 0)) continue;
      if (shifts.empty()) shifts.assign(grid.node_count(), Vec2::Zero());
      for (int axis = 0; axis < 2; ++axis)
        if (wall.shift[axis] != 0) shifts[at.node][axis] = wall.shift[axis];
    }
  return shifts;
}

bool Restraints::any_absorbing() const {
  return std::any_of(walls_.begin(), walls_.end(), [](const Wall& w) { return w.type == Type::absorbing; });
}

}  // namespace pivnp::mpm

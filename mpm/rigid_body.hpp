// Rigid bodies with prescribed motion. Rough: the nodes inside the moving outline carry its velocity. With a friction
// coefficient (0: smooth) only the motion into the body is stopped there, along the outline's normal (a circle's: from
// its centre), and what slides is slowed by at most friction times the normal impulse (Bardenhagen et al. 2000).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mpm/boundary.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::mpm {

class RigidBodies {
 public:
  /// Throws InputError naming body.<name>.<key>.
  RigidBodies(const std::vector<std::pair<std::string, RigidOptions>>& bodies, const Grid& grid);

  /// Throws InputError naming the body if a point lies inside its outline at time 0.
  void check_clear(const std::vector<Vec2>& points) const;
  /// Sets Node::nx, ny inside the outlines; appends the impulses.
  void apply(double time, GridState& g, std::vector<Reaction>& reactions) const;
  void apply_to_remapped(double time, GridState& g) const;
  /// The first time after `time` at which a body starts or stops.
  double next_change(double time) const;
  bool moving_after(double time) const;
  double fastest() const;  // greatest speed of a body, m/s
  std::size_t size() const { return bodies_.size(); }
  bool empty() const { return bodies_.empty(); }

 private:
  struct Body {
    std::string key;
    std::optional<Polygon> polygon;
    Vec2 centre = Vec2::Zero();
    double radius = 0;
    Vec2 velocity = Vec2::Zero();
    double from = 0, until = 0;
    std::optional<double> friction;

    Vec2 velocity_of_node(const Vec2& v, const Vec2& x_at_time_0, const Vec2& of_body, bool with_friction) const;
    Vec2 offset(double time) const;
    Vec2 velocity_at(double time) const;
    bool contains(const Vec2& x_at_time_0) const;
  };
  template <class Action>
  void for_nodes_inside(const Body& body, double time, GridState& g, Action&& action) const;

  std::vector<Body> bodies_;
};

}  // namespace pivnp::mpm

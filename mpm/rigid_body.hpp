// Rigid bodies with prescribed motion.
//
// Contact is held at points of the outline, at most a cell apart: the material's velocity there, interpolated with the
// shape functions, meets that of the body; the impulses go to the nodes through the same functions (Lagrange multipliers
// on an embedded surface, lumped masses, Gauss-Seidel with projection as in contact dynamics, Jean 1999).
// So the surface is where the outline is, not where the next nodes are. Rough: no relative motion. With a friction
// coefficient mu (0: smooth): no motion into the body, the tangential impulse at most mu times the normal one. A point
// of the outline is in contact where the mass that its nodes give it is a quarter of a full cell's or more (next to a
// half-space it is a half).
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
  /// Corrects Node::n; appends the impulses. `least_mass`: of a point in contact, kg/m.
  void apply(double time, double least_mass, GridState& g, std::vector<Reaction>& reactions);
  /// Corrects Node::u at the points that apply() found in contact; there motion away from the body is not allowed either
  /// (taking only one sign of the scatter would part the material from the body).
  void apply_to_remapped(double time, GridState& g) const;
  /// The first time after `time` at which a body starts or stops.
  double next_change(double time) const;
  bool moving_after(double time) const;
  double fastest() const;  // greatest speed of a body, m/s
  std::size_t size() const { return bodies_.size(); }
  bool empty() const { return bodies_.empty(); }

 private:
  struct SurfacePoint {
    Vec2 x, normal;  // at time 0; out of the body
  };
  struct Body {
    std::string key;
    std::optional<Polygon> polygon;
    Vec2 centre = Vec2::Zero();
    double radius = 0;
    std::vector<SurfacePoint> surface;
    Vec2 velocity = Vec2::Zero();
    double from = 0, until = 0;
    std::optional<double> friction;

    Vec2 offset(double time) const;
    Vec2 velocity_at(double time) const;
    bool contains(const Vec2& x_at_time_0) const;
    void sample_surface(double spacing);
  };
  struct Contact {
    int body;
    Vec2 normal;
    std::size_t node[9];
    double weight[9];
    double per_mass;                   // sum of weight^2 / mass
    double along_normal = 0, along = 0;  // impulses
    bool sticks = true;
  };
  void find_contacts(double time, double least_mass, const GridState& g);

  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
};

}  // namespace pivnp::mpm

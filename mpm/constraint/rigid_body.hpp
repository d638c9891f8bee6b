// Rigid bodies: with prescribed motion, or free with a mass.
//
// Contact is held at pieces of the outline, at most a cell long: the material's velocity there meets that of the body, and
// impulses go to the nodes through the same numbers by which the velocity comes from them (Lagrange multipliers on an embedded
// surface, lumped masses, Gauss-Seidel with projection as in contact dynamics, Jean 1999). Rough: no relative motion. With a friction
// coefficient mu (0: smooth): no motion into the body, the tangential impulse at most mu times the normal one, as far as the
// skeleton bears that.
//
// Under a polygon's sides these numbers are those of a layer of the material (contact_layer.hpp). Contact begins where the
// outermost points end: a gap may close in a step, and no more. On circles, and where there is no layer (few points, material that
// has flowed), they are the shape functions at the piece's middle; it is in contact where the mass that its nodes give it is a quarter
// of a full cell's or more (next to a half-space it is a half).
//
// What is rough grips: a face that has touched goes with the body, pull or push, however stretched its material is. It lets
// go where no material is left within a cell.
//
// A boundary that moves is such a body without an outline: both sides of its line, or the nodes inside its polygon, which go with it.
//
// A free body moves under gravity and these impulses: its velocity and turn are unknowns of the same sweeps (with its
// inverse mass and moment of inertia beside those of the nodes), advanced by symplectic Euler. It meets material only,
// not walls or other bodies. Its mass may rise or fall in time; mass comes at the body's velocity. What a table says of its motion
// is prescribed, the rest is free; a table of forces acts beside its weight.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/contact_layer.hpp"
#include "mpm/constraint/restraints.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::mpm {

class RigidBodies {
 public:
  /// Throws InputError naming body.<name>.<key>.
  RigidBodies(const std::vector<std::pair<std::string, RigidOptions>>& bodies, const Grid& grid, int velocity_fields = 1);

  /// Adds a boundary that moves (fixed: rough; roller: its normal alone), behind the bodies. `centroid`: of the material. Throws
  /// InputError naming boundary.<name>.<key>.
  void grip(const std::string& name, const BoundaryOptions& boundary, const Vec2& centroid);
  /// The place of boundary.NAME among the bodies; -1: it does not move.
  int gripping(const std::string& name) const;

  /// Throws InputError naming the body if a point lies inside its outline at time 0.
  void check_clear(const std::vector<Vec2>& points) const;
  /// Free bodies: gravity for the step that begins at `time`; call once a step before apply().
  /// `field` (may be empty): more acceleration, by place and velocity.
  using Field = std::function<Vec2(const Vec2& x, const Vec2& v)>;
  void accelerate(double time, double dt, const Vec2& gravity, const Field& field = {});
  /// Free bodies: to the end of the step; call once, after apply().
  void advance(double dt);
  /// Corrects Node::n and free bodies' velocities in a step of `dt`; appends the impulses. `least_mass`: of a point in contact,
  /// kg/m. `joined`: nodes that move with another, ascending. Before time 0 (initial equilibrium) prescribed bodies are at rest and
  /// free ones are not there. `in_pores` (may be empty): at nodes, ascending, the pressure of the water in the pores beyond that outside,
  /// Pa: that much of the normal stress does not rub.
  using Pressures = std::function<std::vector<double>(const std::vector<std::uint32_t>& nodes)>;
  void apply(double time, double dt, double least_mass, std::span<const JoinedNode> joined, const Particles& p, GridState& g,
             std::vector<Reaction>& reactions, const Pressures& in_pores = {});
  /// The nodes in contact strain the material by velocities of their own (GridState::separate_strain_velocities()).
  void separate_strain_velocities(GridState& g) const;
  /// Corrects the strain-rate velocity at the points that apply() found in contact; there motion away from the body is not allowed either
  /// (taking only one sign of the scatter would part the material from the body).
  void apply_to_strain_velocity(double time, GridState& g) const;
  /// Those that apply() found in contact, ascending.
  std::vector<std::uint32_t> touched_nodes() const;
  /// Is a place inside a body, or less than `margin` from its outline?
  bool cover(const Vec2& x, double time, double margin) const;
  /// The first time after `time` at which a body starts or stops.
  double next_change(double time) const;
  bool moving_after(double time) const;
  /// Lower left and upper right corner of every body that moves at a time.
  std::vector<std::pair<Vec2, Vec2>> moving_corners(double time) const;
  bool any_free() const;
  double mass(std::size_t body, double time) const;  // kg/m; 0: prescribed
  Vec2 displacement(std::size_t body, double time) const;
  double turn(std::size_t body, double time) const { return bodies_[body].angle_at(time); }
  /// Of every body, six numbers: shift x, y, turn, velocity x, y, rate of turn, as far as they are free; and the gap of every face held.
  std::vector<double> motion() const;
  void set_motion(const std::vector<double>& motion);
  double fastest() const;  // greatest speed of a body, m/s
  std::size_t size() const { return bodies_.size(); }
  bool empty() const { return bodies_.empty(); }

 private:
  struct SurfacePoint {
    Vec2 x, normal;  // at time 0; out of the body
    double piece;    // length
  };
  // A straight side of the outline, at time 0, and its points: `count` of them from `first` on, each in the middle of its piece.
  struct Side {
    Vec2 start, along, normal;
    double length;
    std::size_t first, count;
    double least_depth = 0;  // of points under it
  };
  struct Body {
    std::string key;
    std::optional<Polygon> polygon;
    Vec2 centre = Vec2::Zero();
    double radius = 0;
    std::vector<SurfacePoint> surface;
    std::vector<Side> sides;  // of a polygon
    Vec2 velocity = Vec2::Zero();
    double from = 0, until = 0;
    std::optional<double> friction;
    // Free: mass a metre at the start and later, moment of inertia over mass, and the motion since time 0.
    bool free = false, turns = true;
    double mass = 0, mass_end = 0, mass_from = 0, mass_until = 0, mass_now = 0, inertia_per_mass = 0;
    Vec2 shift = Vec2::Zero(), v = Vec2::Zero();
    double angle = 0, spin = 0;
    // Prescribed by a table, or turning: `shift` to `spin` are those of the step, as far as they are given.
    MotionTable table;
    ForceTable force;
    double turns_at = 0;  // rad/s
    bool moves_freely() const { return free || table.any() || turns_at != 0; }
    bool given(int component) const { return table.any() && (!free || table.courses[std::size_t(component)].given()); }
    // Rough, or a boundary that moves.
    bool grips = false, boundary = false, nodes_inside = false;  // the last: the nodes in its polygon go with it
    double removed = std::numeric_limits<double>::infinity();
    Vec2 way = Vec2::Zero();     // in which alone those nodes are held; zero: both
    std::vector<double> held;    // gap at which each piece holds each velocity field's face; NaN: it does not

    void take_motion(const MotionTable& motion, const std::string& motion_key);
    void take_motion_of_step(double time, double dt);
    double angle_at(double time) const;
    Vec2 shift_at(double time) const;
    double reach() const;  // from the centre to the outline
    double moments_about(Vec2& middle) const;
    double mass_at(double time) const;
    Vec2 place(const Vec2& x_at_time_0, double time) const;
    Vec2 turned(const Vec2& direction) const;
    Vec2 place_at_time_0(const Vec2& x, double time) const;
    /// Velocity of the body's material at a place.
    Vec2 velocity_of(const Vec2& x, double time) const;
    void set_free(const RigidOptions& options);
    Vec2 offset(double time) const;
    Vec2 velocity_at(double time) const;
    bool contains(const Vec2& x_at_time_0) const;
    void sample_surface(double spacing);
    /// The pieces of a polygon's sides that a point is under (place and halves of its sides at time 0), no more than `deepest`.
    void pieces_over(const Vec2& x, const Mat2& halves, double deepest, std::vector<UnderPiece>& list) const;
  };
  struct Contact {
    int body = 0;
    Vec2 x, normal;
    bool layer = false;    // of material under its face; else the nodes around a point of the outline
    bool pulls = false;
    double part = 0;       // velocity at which the face may come nearer the body, m/s
    double body_normal = 0, body_along = 0;  // velocity of a free body there for a unit impulse
    std::size_t begin = 0, end = 0;          // in shares_: what a unit impulse gives to nodes, and what of their velocities is the face's
    double per_mass = 0;                     // sum of share^2 / mass
    double face = 0;                         // of material, m (m^2 a radian)
    double by_water = 0;                     // of the normal impulse
    double along_normal = 0, along = 0;      // impulses
    bool sticks = true;
  };
  void find_contacts(double time, double dt, double least_mass, std::span<const JoinedNode> joined, const Particles& p,
                     const GridState& g);
  void find_nodes_inside(const Body& body, int number, double time, std::span<const JoinedNode> joined, const GridState& g);
  void find_points_under(const Body& body, double time, const Particles& p, const GridState& g);
  void press(double dt, const Pressures& in_pores);
  bool take_shares(Contact& c, std::span<const JoinedNode> joined, const GridState& g);
  void add_nodes_around(const Vec2& x, int field, const GridState& g, double& mass);

  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
  std::vector<NodeShare> shares_;
  ContactLayer layer_;
  double spacing_;
  int fields_;
};

}  // namespace pivnp::mpm

// Material points as a structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm/state/array.hpp"
#include "mpm/state/history.hpp"
#include "mpm/state/views.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

/// Who needs fields that not every case has (particle_fields.hpp).
struct ParticleNeeds {
  bool own_mass = false;    // several bodies, or water
  bool affine = false;      // APIC
  bool sized = false;       // uGIMP
  bool tied = false;        // tied sides
  bool kept = false;        // Where::kept
  bool increments = false;  // stress follows strain in a sweep of its own
  bool averaged = false;    // a law's softening follows the strain around a point
  bool wet = false;         // water in the pores
  bool soils = false;       // of more than one soil
  bool collapses = false;   // as water comes
  bool drains = false;      // some pores are drained
  bool heated = false;      // temperature
  bool swells = false;      // temperature, and water in the pores
  bool banded = false;      // embedded bands
  bool axisymmetric = false;
};

/// Points lie body after body (so that a material is called on a run of them), inside a body in the order of the last
/// re-sort by cell. `index` leads back to the ParticleSet. SI units. Arrays that a case does not need are empty.
struct Particles {
  struct Body {
    std::size_t begin = 0, end = 0;
    int material = 0;
    HistoryVariables::Places history = {};  // of its law's variables
  };
  static constexpr std::int32_t ended = -1;  // as `cell`: no longer simulated

  // Listed, with what they are, in particle_fields.hpp.
  Array x, y, vx, vy;
  Array volume0;
  Array mass;  // one dry body needs none, see mass_of()
  Array F_xx, F_xy, F_yx, F_yy;
  Array J;
  Array tau_xx, tau_yy, tau_zz, tau_xy;
  Array C_xx, C_xy, C_yx, C_yy;
  Array carried_x, carried_y;
  Array half;
  std::vector<std::int32_t> cell;
  std::vector<std::uint32_t> index;
  Array xi, eta;
  Array de_xx, de_yy, de_zz, de_xy, spin;
  Array softened_by;
  Array pressure, content, J_flow;
  Array J_strained;       // where it swells with heat
  Array mobility, solid;  // where they vary (water/pore_water.hpp)
  Array displacing;       // where some pores are drained (water/pore_water.hpp)
  Array wetted;           // where soil collapses
  Array temperature, heated_by, swelling;  // heat/heat.hpp
  Array shift, sheared, band_width, band_work;
  Array F_zz, hoop;       // axisymmetric

  HistoryVariables history;     // of the laws
  double density = 0;  // of one body, kg/m^3
  double outside = 0, level = 0;  // weight of the water outside now, N/m^3 (0: none), and the height of its surface
  std::vector<Body> bodies;

  std::size_t size() const { return x.size(); }
  double mass_of(std::size_t k) const { return mass.empty() ? density * volume0[k] : mass[k]; }
  /// Area at the start of what a point stands for in the plane.
  double area0(std::size_t k) const { return F_zz.empty() ? volume0[k] : volume0[k] * F_zz[k] / x[k]; }
  /// Every field that is needed at `n` zeros, the others without memory; no point is in a cell. Without history.
  void resize(std::size_t n, const ParticleNeeds& needs);
  /// Displacement of a point that started at x0.
  Vec2 displacement(std::size_t k, const Vec2& x0) const {
    const Vec2 d = Vec2(x[k], y[k]) - x0;
    return carried_x.empty() ? d : Vec2(d.x() - carried_x[k], d.y() - carried_y[k]);
  }
  /// As the kernels see them; a const object's are only read.
  PointView view() const;
  /// The increments at `n` zeros.
  void resize_increments(std::size_t n);
  /// Every array of real state, the laws' history among it; some may be empty.
  std::vector<Array*> state();
  /// Puts the points of each body in the order in which they come in `order`, ended ones last, and has `order` tell
  /// where they are now.
  void sort_as(std::vector<std::uint32_t>& order, int threads);
};

}  // namespace pivnp::mpm

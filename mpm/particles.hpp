// Material points as a structure of arrays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pivnp::mpm {

/// Points lie body after body (so that a material is called on a run of them), inside a body in the order of the last
/// re-sort by cell. `index` leads back to the ParticleSet. SI units.
struct Particles {
  struct Body {
    std::size_t begin = 0, end = 0;
    int material = 0;
  };
  static constexpr std::int32_t ended = -1;  // as `cell`: no longer simulated

  // State.
  std::vector<double> x, y, vx, vy;
  std::vector<double> mass, volume0;           // kg/m, m^2
  std::vector<double> F_xx, F_xy, F_yx, F_yy;  // deformation gradient, of the point's own velocity gradient
  std::vector<double> J;                       // volume ratio, of the element's averaged volumetric strain
  std::vector<double> tau_xx, tau_yy, tau_zz, tau_xy;  // Kirchhoff stress, Pa
  std::vector<double> plastic_dev, gap, dissipated;
  std::vector<std::uint8_t> opened;
  std::vector<std::int32_t> cell;    // flat element index, or `ended`
  std::vector<std::uint32_t> index;  // place in the ParticleSet

  // Of one step.
  std::vector<double> xi, eta;                           // natural coordinates in (0, 1)
  std::vector<double> de_xx, de_yy, de_zz, de_xy, spin;  // strain and rotation increments

  std::vector<Body> bodies;

  std::size_t size() const { return x.size(); }
  void resize(std::size_t n);
  /// Every array of real state, for copying, sorting and saving.
  std::array<std::vector<double>*, 18> state();
  /// Sorts each body by cell, ended points last; keeps the order inside a cell.
  void sort_by_cell();
};

}  // namespace pivnp::mpm

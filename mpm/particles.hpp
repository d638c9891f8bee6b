// Material points as a structure of arrays.
#pragma once

#include <cstdint>
#include <vector>

#include "mpm/lanes.hpp"

namespace pivnp::mpm {

/// Points lie body after body (so that a material is called on a run of them), inside a body in the order of the last
/// re-sort by cell. `index` leads back to the ParticleSet. SI units. Arrays that a scheme does not use are empty.
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
  std::vector<double> J;                       // volume ratio, of the averaged volumetric strain
  std::vector<double> tau_xx, tau_yy, tau_zz, tau_xy;  // Kirchhoff stress, Pa
  std::vector<double> plastic_dev, gap, dissipated;
  std::vector<double> C_xx, C_xy, C_yx, C_yy;  // affine velocity field (APIC), 1/s
  std::vector<double> half;                    // half side over the cell's (uGIMP)
  std::vector<std::uint8_t> opened;
  std::vector<std::int32_t> cell;    // index of the lower left node of the stencil, or `ended`
  std::vector<std::uint32_t> index;  // place in the ParticleSet

  // Of one step.
  std::vector<double> xi, eta;                           // natural coordinates (shape.hpp)
  std::vector<double> de_xx, de_yy, de_zz, de_xy, spin;  // increments, where strain and stress are apart (transfer.hpp)

  std::vector<Body> bodies;

  std::size_t size() const { return x.size(); }
  /// All arrays of real state at `n` zeros; those of APIC and uGIMP where asked for.
  void resize(std::size_t n, bool affine, bool sized);
  /// As the kernels see them; a const object's are only read.
  PointView view() const;
  /// The increments at `n` zeros.
  void resize_increments(std::size_t n);
  /// Every array of real state, for copying, sorting and saving; some may be empty.
  std::vector<std::vector<double>*> state();
  /// Puts the points of each body in the order in which they come in `order`, ended ones last, and has `order` tell
  /// where they are now.
  void sort_as(std::vector<std::uint32_t>& order, int threads);
};

}  // namespace pivnp::mpm

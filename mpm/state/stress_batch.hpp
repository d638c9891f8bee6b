// What a law sees of the points, and changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace pivnp::mpm {

/// One step of a run of points. Tensor components, tension positive; plane strain, but de_zz may differ
/// from zero by the averaging against locking (transfer.hpp), or axial symmetry, where zz is the hoop. With f = V R the step's deformation, the strain increment
/// is ln V and the rotation R: a step that turns the point strains it by nothing, however far it turns. The stress is
/// Kirchhoff's, tau = J sigma, Pa: its work per initial volume is tau : de, which lets the elastic energy close exactly.
/// Strengths bound the Cauchy stress, so they enter multiplied by J.
struct StressBatch {
  static constexpr std::size_t most_numbers = 16, most_flags = 4;  // of a law's history

  std::size_t size = 0;
  const std::uint32_t* places = nullptr;  // of the points in the arrays of state; null: they lie one after the other
  const double *de_xx = nullptr, *de_yy = nullptr, *de_zz = nullptr, *de_xy = nullptr;  // log strain increment of the step
  const double* spin = nullptr;                                                         // 2 tan(angle/2) of the step's rotation
  const double* J = nullptr;                                                            // volume over initial volume, after the step
  const double *F_xx = nullptr, *F_xy = nullptr, *F_yx = nullptr, *F_yy = nullptr;      // deformation gradient after the step
  const double* F_zz = nullptr;         // axisymmetric: likewise out of the plane; null: 1
  double *xx = nullptr, *yy = nullptr, *zz = nullptr, *xy = nullptr;                    // stress in and out
  const double* shift = nullptr;        // of the normal stresses, as strength sees them (heat/bands.hpp); null: none
  const double* softened_by = nullptr;  // the strain that softens, where it is not the point's own (transfer/nonlocal.hpp)
  // The law's history variables in the order in which it declares them, component by component; null after the last.
  std::array<double*, most_numbers> history{};
  std::array<std::uint8_t*, most_flags> flags{};
  double dt = 0;  // length of the step, s; 0: initial equilibrium, nothing depends on rate

  /// Points `begin` to `begin + n`.
  StressBatch part(std::size_t begin, std::size_t n) const;
  /// Point `k` by itself, with no `places`.
  StressBatch point(std::size_t k) const;

 private:
  void move_increments(std::size_t by);
  void move_state(std::size_t by);
  template <bool increments>
  void move(std::size_t by);
};

}  // namespace pivnp::mpm

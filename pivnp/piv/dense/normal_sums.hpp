// The Gauss-Newton equations of one pass: both frames warped once, and their sums over hat-weighted cells.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/spline_field.hpp"
#include "pivnp/piv/sampling/anchor_shares.hpp"
#include "pivnp/piv/sampling/pixel_flags.hpp"
#include "pivnp/piv/sampling/spline_image.hpp"

namespace pivnp::piv {

/// What a pass knows: frames, the displacement field that they are warped by, and per lattice point what the robust
/// weights and the illumination correction need.
struct SumsInput {
  const SplineImage* first = nullptr;
  const SplineImage* second = nullptr;
  const PixelFlags* first_flags = nullptr;  // null: all pixels are usable
  const PixelFlags* second_flags = nullptr;
  const SplineField* field = nullptr;  // its lattice is the sums' lattice
  AnchorShares shares;                 // f(x) = first(x + shares.first d), g(x) = second(x + shares.second d)
  // Robust weight of a pixel: 1 / (1 + e^2 / (noise + tolerance |grad|^2))^2 (Geman & McClure 1985). Empty: all 1.
  const std::vector<float>* noise = nullptr;      // grey^2, at lattice points
  const std::vector<float>* tolerance = nullptr;  // px^2
  // Illumination: e = f - gain g - offset. Empty: gain 1, offset 0.
  const std::vector<float>* gain = nullptr;
  const std::vector<float>* offset = nullptr;
  // Cells that matter: of the cell whose upper left point is (i, j), at [j][i] of the lattice; null: all.
  const std::vector<std::uint8_t>* active = nullptr;
  bool scores = false;  // also the sums that correlation coefficients need
};

/// Sums over the pixels x about each lattice point with hat weights (1 - |dx|/step)(1 - |dy|/step), w the robust
/// weight: of w gx gx, w gx gy, w gy gy, w gx e, w gy e, w e e, w, and usable pixels (1); for scores f, g, ff, gg, fg and
/// w ex ex, w ex ey, w ey ey, (ex, ey) the gradient of e.
struct CellSums {
  enum Plane { gxx, gxy, gyy, gxe, gye, wee, weight, usable, f, g, ff, gg, fg, exx, exy, eyy, planes };
  static constexpr int basic = f;
  CellLattice lattice;
  std::vector<float> plane[planes];
  const std::vector<float>& operator[](Plane p) const { return plane[p]; }
};

/// Gradients are those of the mean of both warped frames, by the five-point derivative that is exact for the spectrum
/// of a 3 px grain; e is first minus second. The same bits for any number of threads.
void accumulate_sums(const SumsInput& input, int threads, CellSums& sums);

/// Name of the instruction set in use ("AVX3", "AVX2", "SSE2" ...).
const char* simd_target();

}  // namespace pivnp::piv

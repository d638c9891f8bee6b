// Stress updates in lanes, for the points that take the common paths; the others are left to the laws' own code.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mpm/material/material.hpp"

namespace pivnp::mpm {

/// Most points that one call takes.
constexpr std::size_t most_in_lanes = 1024;

/// Hencky's law (elastic.hpp) for elastic deviators up to 0.12 and steps up to 0.01. The places of the points
/// beyond go to `rare`, which has room for the batch; they are not touched. Returns their number.
std::size_t hencky_lanes(const Elastic& elastic, const StressBatch& batch, std::uint32_t* rare);

/// The cone of MohrCoulomb and its flow, in sorted principal stresses.
struct ConeConstants {
  double sin_friction, sin_dilatancy;
  double cohesion_term;  // 2 c cos phi, at J = 1
  double tension;        // greatest tension of a point that has not separated; a cut-off where it is below the apex
};

/// Elastic points, returns to the plane f_13 or one of its edges, and points that stay open. Points at the apex or the
/// cut-off, and those that close, are rare.
std::size_t cone_lanes(const Elastic& elastic, const ConeConstants& cone, const StressBatch& batch,
                       std::uint32_t* rare);

/// The numbers of a StrengthLaw (strength.hpp); radians, Pa.
struct StrengthConstants {
  double friction, friction_low, per_half, residual_friction;
  double cohesion, residual_cohesion, rate;
  double dilatancy, per_fade;
};

/// The same with each point's own cone, by its history (accumulated plastic deviatoric strain) and its pressure before
/// the step.
std::size_t changing_cone_lanes(const Elastic& elastic, const StrengthConstants& strength, double tension,
                                const double* history, const StressBatch& batch, std::uint32_t* rare);

/// The numbers of SmoothMohrCoulomb and of its surface (abbo_sloan.hpp).
struct SmoothConstants {
  StrengthConstants strength;
  bool constant;  // is the strength; then:
  double sin_friction, cos_friction;
  double sin_dilatancy;  // at the start
  double tension, floor;
  double a[2][2], b[2][2], c[2][2], sin3_transition, hyperbola, short_of_vertex;
  double stress_tolerance, yield_tolerance, near_surface, least_size, least_substep, least_hardness, corner;
};

/// Points that stay elastic, begin to flow within the step or flow all along it, short of the greatest mean stress, and open
/// ones. Those that leave the surface within the step, open or close in it, or need very many substeps are rare. The batch
/// holds no more than most_in_lanes.
std::size_t smooth_lanes(const Elastic& elastic, const SmoothConstants& constants, const StressBatch& batch,
                         std::uint32_t* rare);

/// Calls lanes(part, rare), which returns the number of rare points, on parts of the batch, and point(batch, k) on those;
/// there the batch has no `places`.
template <class Lanes, class Point>
void update_in_lanes(const StressBatch& batch, Lanes&& lanes, Point&& point) {
  std::uint32_t rare[most_in_lanes];
  for (std::size_t begin = 0; begin < batch.size; begin += most_in_lanes) {
    const StressBatch part = batch.part(begin, batch.size - begin < most_in_lanes ? batch.size - begin : most_in_lanes);
    const std::size_t n = lanes(part, rare);
    for (std::size_t r = 0; r < n; ++r) {
      if (part.places) point(part.point(rare[r]), 0);
      else point(part, rare[r]);
    }
  }
}

}  // namespace pivnp::mpm

// The common step, several particles at a time: bilinear, complete elements. Plain numbers only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pivnp::np {

/// One pair for the vectorised step. Nodes that are not usable hold NaN, so that nothing can be read from them.
struct FastField {
  double origin_x, origin_y, per_spacing_x, per_spacing_y;
  int nx, ny;
  bool central, centre_gradient;
  /// u and v as two floats, u in the lower half. Bilinear: nodal values [ny][nx]; cubic B-splines: coefficients
  /// [ny + 2][nx + 2].
  std::vector<std::uint64_t> nodes;
  double error_correlation = 1;
  /// [ny - 1][nx - 1][3]: uu and vv; uv and the gradient's variance; the reading's error u and v. Empty: not known.
  std::vector<std::uint64_t> errors;
};

/// The particles of a block. x: (x, y); F: xx yx xy yy; cov: uu vv uv; bias: x, y; cov_F: xx yy xy.
struct FastParticles {
  double *x, *F, *cov, *bias, *cov_F;
  const std::uint8_t* status;
  std::size_t count;
  std::uint8_t* moved;
  std::int32_t* element;
};

/// Moves those of the particles that it can: alive (status 1 or 2), in an element whose nodes (cubic: its 4 x 4 nodes)
/// are usable, the mid-point found within a few Newton steps, J > 0. moved[k] = 1 and element[k] for these; the others
/// are left as they were, moved[k] = 0. What happens to a particle does not depend on the others. Uncertainties change
/// where the field has errors.
void fast_step(const FastField& field, const FastParticles& particles);
/// The same by cubic B-splines; the covariance of what is read is that for error_correlation = 1.
void fast_spline_step(const FastField& field, const FastParticles& particles);

}  // namespace pivnp::np

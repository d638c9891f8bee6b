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
  std::vector<std::uint64_t> nodes;  // [ny][nx]: u and v as two floats, u in the lower half
  double error_correlation = 1;
  std::vector<std::uint64_t> cov;  // [ny][nx][2]: uu and vv, uv and nothing; empty: not known
};

/// Moves those of `count` particles that it can: alive (status 1 or 2), in an element with four usable nodes, the
/// mid-point found within a few Newton steps, J > 0. moved[k] = 1 and element[k] for these; the others are left as they
/// were, moved[k] = 0. What happens to a particle does not depend on the others. x: (x, y); F: xx yx xy yy;
/// cov: uu vv uv, used where the field has covariances.
void fast_step(const FastField& field, double* x, double* F, double* cov, const std::uint8_t* status,
               std::size_t count, std::uint8_t* moved, std::int32_t* element);

}  // namespace pivnp::np

// What reading a nodal field between its nodes adds to the uncertainty of a path: the error of the interpolation itself,
// and the errors of the gradient.
#pragma once

#include <array>
#include <vector>

#include "pivnp/np/options.hpp"
#include "pivnp/np/support.hpp"

namespace pivnp::np {

/// Of one element, the mean of its four nodes.
struct ElementError {
  float uu = 0, vv = 0, uv = 0;  // covariance of the vectors
  float gradient = 0;            // variance of a component of the gradient
  float u = 0, v = 0;            // expected error of what is read: what is there less what is read, length
};

/// Error of reading a wave between its nodes by `shape`: RMS over a cell and all phases, over the RMS of the wave.
/// `steepness` is 2 - 2 cos(k h), 0 to 4: the ratio of the second differences of a wave to the wave itself.
double wave_reading_error(ShapeFunctions shape, double steepness);

/// Estimated at every node from the field's own differences along each axis. Second and fourth differences tell which
/// wavelength carries the curvature there (steepness^2 = sum of squared fourth over squared second differences, over
/// three nodes), and wave_reading_error() what of such a wave is lost between the nodes. The sign is kept, so that what
/// is noise averages out along a path while a bias adds up. Waves shorter than two spacings cannot be seen.
/// Polynomials that several elements share (Lagrange) are as wrong where a wave passes through zero as beside it: of them it
/// is what they miss in the middle of each element, by six nodes along each axis.
/// The gradient's variance follows from that of the vectors: 4/3 C/h^2 for independent errors, the mean over a bilinear
/// element, and 2 C/correlation_length^2 where errors are alike further than that.
/// Where correlation_length is known, vectors are of a correlation that smooths: the part of the gradient's error that all
/// pairs share, C/(shared_spacings h)^2 for each, adds up linearly, (2 step - 1) times at `step`.
/// docs/theory/particles_error.md.
class ReadingErrors {
 public:
  static constexpr double shared_spacings = 6;   // measured: drawn sequences, nodes a quarter of the window apart
  static constexpr int smoothed_together = 64;   // pairs

  explicit ReadingErrors(ShapeFunctions shape);
  /// Per element; empty where the vectors' covariances are not known. Elements without four usable nodes hold zeros.
  template <class Real>
  const std::vector<ElementError>& of(const Nodes<Real>& nodes, const SupportMap& support);

 private:
  float lost(float steepness) const;  // wave_reading_error / steepness, over what the mean of an element leaves
  void add_axis(std::size_t count, const std::array<const float*, 7>& rows, float* out) const;
  void take_polynomial_error(const Grid& grid, int i, int j, ElementError& e) const;
  static constexpr int steps = 64;
  int degree_;  // of a polynomial that a group of elements shares (Lagrange); 1: none
  std::array<float, steps + 2> table_;
  std::vector<ElementError> errors_;
  std::array<std::vector<float>, 2> values_, biases_;  // a component each, with a rim of three nodes; [ny][nx]
};

extern template const std::vector<ElementError>& ReadingErrors::of(const Nodes<float>&, const SupportMap&);
extern template const std::vector<ElementError>& ReadingErrors::of(const Nodes<double>&, const SupportMap&);

}  // namespace pivnp::np

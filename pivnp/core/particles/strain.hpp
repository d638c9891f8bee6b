// Strain measures of a deformation gradient, plane strain (e_zz = 0 unless said). Tensor components, tension positive.
#pragma once

#include <array>

#include "pivnp/core/math.hpp"

namespace pivnp {

/// Symmetric in-plane tensor.
struct Strain {
  double xx = 0, yy = 0, xy = 0;
};

inline Mat2 matrix(const std::array<float, 4>& F) {
  Mat2 m;
  m << double(F[0]), double(F[1]), double(F[2]), double(F[3]);
  return m;
}

/// Logarithmic (Hencky) strain of the left stretch, ln V = 1/2 ln(F F^T), in world axes. det F > 0 expected; NaN
/// otherwise. Exact for any rotation; closed form by the eigenvalues of F F^T.
Strain log_strain(const Mat2& F);

/// ln V by the other way, ln U = 1/2 ln(F^T F), in material axes.
Strain log_strain_material(const Mat2& F);

/// e_xx + e_yy (of log strain: ln J).
inline double volumetric(const Strain& e) { return e.xx + e.yy; }

/// sqrt(2/3 e:e) of the deviator, e_zz included (plane strain): `strain_dev`.
double deviatoric(const Strain& e);

/// Principal values, first >= second, and the angle of the first from the x axis, radians in (-pi/2, pi/2].
struct Principal {
  double first, second, angle;
};
Principal principal(const Strain& e);

/// Small-strain increment between two states by the anchor of the measurement: sym(G), with F1 = (I + G) F0 (forward)
/// or F1 = (I - G/2)^-1 (I + G/2) F0 (central). Summed over steps it is the thesis' strain (equation 2.7).
Strain increment_forward(const Mat2& F0, const Mat2& F1);
Strain increment_central(const Mat2& F0, const Mat2& F1);

}  // namespace pivnp

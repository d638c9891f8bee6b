#include "pivnp/np/errors/fusion.hpp"

#include <Eigen/LU>
#include <limits>

namespace pivnp::np {

namespace {

Mat2 matrix_of(const std::array<double, 3>& c) {
  Mat2 m;
  m << c[0], c[2], c[2], c[1];
  return m;
}

// Of a symmetric matrix; false if it is not positive definite.
bool inverse_of(const Mat2& S, Mat2& inverse) {
  const double det = S.determinant();
  if (!(S(0, 0) > 0) || !(S(1, 1) > 0) || !(det > 1e-14 * S(0, 0) * S(1, 1))) return false;
  inverse << S(1, 1) / det, -S(0, 1) / det, -S(1, 0) / det, S(0, 0) / det;
  return true;
}

}  // namespace

Estimate fuse(const Estimate& a, const Estimate& b) {
  const Mat2 A = matrix_of(a.cov), B = matrix_of(b.cov);
  Mat2 inverse;
  if (!inverse_of(A + B, inverse)) return b;
  const Mat2 K = A * inverse;
  const Mat2 C = B * inverse * A;  // (I - K) A, written so that it stays symmetric to round-off
  return {a.value + K * (b.value - a.value), {C(0, 0), C(1, 1), 0.5 * (C(0, 1) + C(1, 0))}};
}

Mat2 fusion_weight(const Estimate& a, const Estimate& b) {
  Mat2 inverse;
  if (!inverse_of(matrix_of(a.cov) + matrix_of(b.cov), inverse)) return Mat2::Identity();
  return matrix_of(a.cov) * inverse;
}

Weighted fuse(double variance_a, double variance_b) {
  const double sum = variance_a + variance_b;
  if (!(sum > 0)) return {1, 0};
  return {variance_a / sum, variance_a * variance_b / sum};
}

double disagreement(const Estimate& a, const Estimate& b) {
  Mat2 inverse;
  const Vec2 apart = b.value - a.value;
  if (!inverse_of(matrix_of(a.cov) + matrix_of(b.cov), inverse))
    return apart.squaredNorm() > 0 ? std::numeric_limits<double>::infinity() : 0;
  return apart.dot(inverse * apart);
}

}  // namespace pivnp::np

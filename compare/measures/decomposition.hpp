// Two fields as a few coefficients each: polynomials made orthonormal on the material's own shape (CEN CWA 16799:2014).
#pragma once

#include <string>
#include <vector>

#include "compare/measures/comparison.hpp"
#include "compare/measures/differences.hpp"

namespace pivnp::compare {

/// Polynomials of total degree 0, 1, 2 ... in the coordinates scaled to the points' box, made orthonormal over the
/// points (mean of p_i p_j = delta_ij) by modified Gram-Schmidt, twice; what depends on the others is left out. At most
/// 91 terms (degree 12) and a quarter of the points.
class OrthonormalBasis {
 public:
  static constexpr std::size_t most_terms = 91;

  explicit OrthonormalBasis(const std::vector<Vec2>& x);

  std::size_t size() const { return terms_.size(); }
  const std::vector<double>& term(std::size_t k) const { return terms_[k]; }  // at the points
  int degree(std::size_t k) const { return degree_[k]; }
  std::vector<double> coefficients(const std::vector<double>& field) const;
  /// The field that the first `terms` coefficients describe.
  std::vector<double> reconstruction(const std::vector<double>& coefficients, std::size_t terms) const;

 private:
  std::vector<std::vector<double>> terms_;
  std::vector<int> degree_;
};

/// One field of both sides, by the least whole degrees whose reconstructions both miss their fields by at most
/// `accepted` (RMS), or by all there are.
struct Decomposition {
  std::vector<double> first, second;              // coefficients, in the field's unit
  double residual_first = 0, residual_second = 0;  // RMS of field minus reconstruction
  double cluster_first = 0,
         cluster_second = 0;  // share of neighbouring points missed by more than 3 residuals and `accepted`
  double uncertainty = 0;  // of a coefficient of the first: sqrt(u^2 + residual^2), u the field's own (CWA 16799, 5.4)
  bool adequate = false;   // no cluster of residuals beyond 3 of their RMS with 0.3 % of the points (CWA 16799, annex)

  /// Share of coefficients further than `k` uncertainties from the line s_second = s_first.
  double outside(double k = 2) const;
};
Decomposition decompose(const OrthonormalBasis& basis, const std::vector<Vec2>& x, const std::vector<double>& first,
                        const std::vector<double>& second, double u, double accepted);

/// Adds decomposition_FIELD_outside, _distance, _residual_first, _residual_second, _terms and the tables of
/// coefficients for displacement_x, displacement_y and strain_dev at the last common time. `floor_dev`: noise floor of
/// strain.
void add_decompositions(const Snapshot& last, double floor_dev, const std::string& length_unit, Comparison& out);

}  // namespace pivnp::compare

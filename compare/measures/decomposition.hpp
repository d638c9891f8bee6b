// Two fields as a few coefficients each: polynomials made orthonormal on the material's own shape (CEN CWA 16799:2014).
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "compare/measures/differences.hpp"
#include "pivnp/core/record/comparison.hpp"

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

/// One field of both data sets, by the least whole degrees whose reconstructions both miss their fields by at most
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

/// Fields that are decomposed. L: the motions' unit of length.
struct DecomposedField {
  std::string_view name, symbol, words, unit;
};
inline constexpr std::array<DecomposedField, 3> decomposed_fields{
    {{"displacement_x", "u_x", "displacement x", "L"},
     {"displacement_y", "u_y", "displacement y", "L"},
     {"strain_dev", "deviatoric strain", "deviatoric strain", "1"}}};

struct FieldDecomposition {
  DecomposedField field;
  double u = 0;  // standard uncertainty of the field, NaN if not known
  Decomposition of;
};

/// Those at the last common time that are not zero everywhere in the first data set, in their order; empty with fewer
/// than 16 particles. `u_dev`: standard uncertainty of the deviatoric strain.
std::vector<FieldDecomposition> decompose_fields(const ComparedParticles& last, double u_dev);

/// What is decomposed, and how, for definitions.
std::string definition_of(const DecomposedField& field);
/// The table decomposition_FIELD of coefficients.
ComparisonTable table_of(const FieldDecomposition& decomposition, const std::string& length_unit);

}  // namespace pivnp::compare

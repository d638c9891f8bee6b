#include "compare/uncertainty/strain_errors.hpp"

#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"

namespace pivnp::compare {

StrainErrors::StrainErrors(const std::vector<Vec2>& X, const StrainNotes& notes) {
  PerDataSet<double> side{0, 0};
  for (std::size_t s = 0; s < 2; ++s)
    if (notes[s] && notes[s]->gauge_length > 0) side[s] = notes[s]->gauge_length;
  const double square = side[0] * side[0] - side[1] * side[1];
  averaged_ = square > 0 ? 1 : 0;
  gauge_ = std::sqrt(std::abs(square));
  if (gauge_ > 0) average_ = GaugeAverage(X, gauge_);
}

std::vector<StrainError> StrainErrors::of(const PerDataSet<std::vector<Mat2>>& F,
                                          const PerDataSet<std::vector<std::array<double, 3>>>& row) const {
  std::vector<StrainError> out(F[0].size());
  std::vector<Mat2> averaged;
  if (average_.given()) averaged = average_.of(F[averaged_]);
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (!F[0][p].allFinite() || !F[1][p].allFinite()) continue;
    for (std::size_t s = 0; s < 2; ++s) {
      if (row[s].empty()) continue;
      const StrainVariance v = strain_variance(F[s][p], row[s][p]);
      out[p].random += Vec2(v.dev, v.vol);
    }
    if (averaged.empty()) continue;
    const Strain before = log_strain(F[averaged_][p]), after = log_strain(averaged[p]);
    const Vec2 change(deviatoric(after) - deviatoric(before), volumetric(after) - volumetric(before));
    if (change.allFinite()) out[p].gauge = change;
  }
  return out;
}

}  // namespace pivnp::compare

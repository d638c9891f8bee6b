#include "apps/report/content/quality.hpp"

#include <cmath>
#include <limits>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/material.hpp"

namespace pivnp::report {

std::vector<PairQuality> pair_quality(const Content& content) {
  std::vector<PairQuality> all;
  for (std::size_t k = 0; k < content.pair_count; ++k) {
    const VectorField field = content.pair(k);
    PairQuality q;
    q.frames = field.pair;
    const std::vector<std::uint8_t> material = nodes_in_material(content, field);
    q.material_known = !material.empty();
    std::vector<double> score;
    double variance = 0;
    std::size_t known = 0;
    for (std::size_t n = 0; n < field.status.size(); ++n) {
      if (field.status[n] == VectorStatus::masked) continue;
      if (q.material_known && !material[n]) {
        ++q.outside;
        continue;
      }
      switch (field.status[n]) {
        case VectorStatus::masked:
        case VectorStatus::outside: break;
        case VectorStatus::valid: ++q.valid; break;
        case VectorStatus::replaced: ++q.replaced; break;
        case VectorStatus::rejected: ++q.rejected; break;
        case VectorStatus::failed: ++q.failed; break;
      }
      ++q.nodes;
      if (field.status[n] != VectorStatus::valid) continue;
      if (n < field.score.size()) score.push_back(double(field.score[n]));
      if (n >= field.cov.size()) continue;
      const double v = (double(field.cov[n][0]) + double(field.cov[n][1])) / 2;
      if (!std::isfinite(v)) continue;
      variance += v;
      ++known;
    }
    q.score_median = plot::quantile(score, 0.5);
    q.score_low = plot::quantile(score, 0.05);
    q.score_high = plot::quantile(score, 0.95);
    q.sigma = known == 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(variance / double(known));
    const auto second = std::size_t(field.pair[1]);
    q.flag = field.pair[1] >= 0 && second < content.frames.size() ? content.frames[second].flag : std::uint8_t(0);
    all.push_back(q);
  }
  return all;
}

}  // namespace pivnp::report

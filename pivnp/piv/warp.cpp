#include "pivnp/piv/warp.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/method.hpp"

namespace pivnp::piv {

namespace {

struct RowScratch {
  std::vector<float> du, dv, x, y, predictor;
};

// Places x = column + share * d, kept within the image (the spline has nothing beyond); those outside are marked.
void place_row(const SplineImage& image, const std::vector<std::uint8_t>& mask, const Box& box, int row, float share,
               RowScratch& s, PixelUse* use) {
  const float right = static_cast<float>(image.width() - 1), bottom = static_cast<float>(image.height() - 1);
  for (int k = 0; k < box.width(); ++k) {
    const auto n = static_cast<std::size_t>(k);
    const float x = static_cast<float>(box.x0 + k) + share * s.du[n], y = static_cast<float>(row) + share * s.dv[n];
    s.x[n] = std::clamp(x, 0.0f, right);
    s.y[n] = std::clamp(y, 0.0f, bottom);
    if (!(std::abs(x - s.x[n]) < 0.01f && std::abs(y - s.y[n]) < 0.01f)) use[k] = PixelUse::outside;  // also NaN
  }
  if (mask.empty()) return;
  for (int k = 0; k < box.width(); ++k) {
    const auto n = static_cast<std::size_t>(k);
    const int c = static_cast<int>(s.x[n]), r = static_cast<int>(s.y[n]);
    const int c1 = std::min(static_cast<int>(std::ceil(s.x[n])), image.width() - 1);
    const int r1 = std::min(static_cast<int>(std::ceil(s.y[n])), image.height() - 1);
    const auto usable = [&](int column, int line) {
      return mask[std::size_t(line) * std::size_t(image.width()) + std::size_t(column)] != 0;
    };
    if (use[k] == PixelUse::usable && !(usable(c, r) && usable(c1, r) && usable(c, r1) && usable(c1, r1)))
      use[k] = PixelUse::masked;
  }
}

}  // namespace

void warp_pair(const Level& level, const PredictorField& predictor, Anchor anchor, const Box& box, int threads,
               WarpedPair& warped) {
  const int width = box.width();
  const std::size_t area = std::size_t(width) * std::size_t(box.height());
  warped.box = box;
  if (warped.f.size() < area) {
    warped.f.resize(area);
    warped.g.resize(area);
    warped.use.resize(area);
  }
  const auto decimation = static_cast<float>(level.decimation);
  const auto plan = predictor.plan_row(level.to_full(static_cast<float>(box.x0)), decimation, width);
  const AnchorShares shares = shares_of(anchor);

#pragma omp parallel num_threads(threads)
  {
    RowScratch s;
    for (auto* line : {&s.du, &s.dv, &s.x, &s.y}) line->assign(std::size_t(width), 0.0f);
#pragma omp for schedule(static)
    for (int r = box.y0; r < box.y1; ++r) {
      if (!plan.cell.empty()) {
        predictor.row(plan, level.to_full(static_cast<float>(r)), s.predictor, s.du.data(), s.dv.data());
        for (int k = 0; k < width; ++k) s.du[std::size_t(k)] /= decimation, s.dv[std::size_t(k)] /= decimation;
      }
      const std::size_t start = warped.index(box.x0, r);
      PixelUse* use = warped.use.data() + start;
      std::fill(use, use + width, PixelUse::usable);
      place_row(level.first, level.mask, box, r, shares.first, s, use);
      level.first.sample(s.x.data(), s.y.data(), width, warped.f.data() + start);
      place_row(level.second, level.mask, box, r, shares.second, s, use);
      level.second.sample(s.x.data(), s.y.data(), width, warped.g.data() + start);
    }
  }
}

}  // namespace pivnp::piv

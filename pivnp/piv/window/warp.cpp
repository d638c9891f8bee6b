#include "pivnp/piv/window/warp.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/sampling/anchor_shares.hpp"
#include "pivnp/piv/sampling/sample.hpp"

namespace pivnp::piv {

namespace {

constexpr int lanes = 16;

struct RowScratch {
  std::vector<float> du, dv, ux, uy, predictor;
};

void mask_row(const SplineImage& image, const std::vector<std::uint8_t>& mask, const Box& box, int row,
              const RowScratch& s, float* use, float* masked) {
  const auto usable = [&](int column, int line) {
    return mask[std::size_t(line) * std::size_t(image.width()) + std::size_t(column)] != 0;
  };
  const int right = image.width() - 1, bottom = image.height() - 1;
  for (int k = 0; k < box.width(); ++k) {
    if (use[k] == 0) continue;
    const auto n = static_cast<std::size_t>(k);
    const float x = std::clamp(static_cast<float>(box.x0 + k) + s.ux[n], 0.0f, static_cast<float>(right));
    const float y = std::clamp(static_cast<float>(row) + s.uy[n], 0.0f, static_cast<float>(bottom));
    const int c = static_cast<int>(x), r = static_cast<int>(y);
    const int c1 = std::min(static_cast<int>(std::ceil(x)), right),
              r1 = std::min(static_cast<int>(std::ceil(y)), bottom);
    if (!(usable(c, r) && usable(c1, r) && usable(c, r1) && usable(c1, r1))) use[k] = 0, masked[k] = 1;
  }
}

}  // namespace

void WarpedPair::resize(const Box& to, bool with_mask) {
  box = to;
  // Rows of a window must not fall into the same few lines of the cache: not near a multiple of its 4 KiB.
  constexpr int line = 16;
  stride = (to.width() + line - 1) / line;
  while (stride % 8 != 5) ++stride;
  stride *= line;
  const std::size_t area = std::size_t(stride) * std::size_t(to.height()) + 2 * padding;
  for (auto* plane : {&f, &g, &use})
    if (plane->size() < area) plane->resize(area);
  partial.assign(std::size_t(tiles_across()) * std::size_t((to.height() + tile - 1) / tile), 1);
  with_mask ? masked.assign(area, 0.0f) : masked.clear();
}

void WarpedPair::mark_tiles(int threads) {
  const int across = tiles_across(), down = (box.height() + tile - 1) / tile;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int t = 0; t < down; ++t)
    for (int c = 0; c < across; ++c) {
      unsigned some = 0;
      const int columns = std::min(tile, box.width() - c * tile);
      for (int r = t * tile; r < std::min((t + 1) * tile, box.height()); ++r) {
        const float* line = use.data() + index(box.x0 + c * tile, box.y0 + r);
        for (int k = 0; k < columns; ++k) some |= line[k] != 1.0f;
      }
      partial[std::size_t(t) * std::size_t(across) + std::size_t(c)] = some != 0;
    }
}

void warp_pair(const Level& level, const PredictorField& predictor, Anchor anchor, const Box& box, int threads,
               WarpedPair& warped) {
  const int width = box.width();
  warped.resize(box, !level.mask.empty() || !level.first_mask.empty());
  const auto decimation = static_cast<float>(level.decimation);
  const auto plan = predictor.plan_row(level.to_full(static_cast<float>(box.x0)), decimation, width);
  const AnchorShares shares = shares_of(anchor);

#pragma omp parallel num_threads(threads)
  {
    RowScratch s;
    for (auto* line : {&s.du, &s.dv, &s.ux, &s.uy}) line->assign(std::size_t(width + lanes), 0.0f);
#pragma omp for schedule(static)
    for (int r = box.y0; r < box.y1; ++r) {
      if (!plan.empty()) {
        predictor.row(plan, level.to_full(static_cast<float>(r)), s.predictor, s.du.data(), s.dv.data());
        for (int k = 0; k < width && level.decimation > 1; ++k)
          s.du[std::size_t(k)] /= decimation, s.dv[std::size_t(k)] /= decimation;
      }
      const std::size_t start = warped.index(box.x0, r);
      float* use = warped.use.data() + start;
      std::fill(use, use + width, 1.0f);
      const auto frame = [&](const SplineImage& image, const std::vector<std::uint8_t>& mask, float share, float* out) {  // rows are padded as well
        place_row(image, box.x0, r, s.du.data(), s.dv.data(), share, width, s.ux.data(), s.uy.data(), use);
        if (!mask.empty()) mask_row(image, mask, box, r, s, use, warped.masked.data() + start);
        sample_displaced(image, box.x0, r, s.ux.data(), s.uy.data(), width, out);
      };
      frame(level.first, level.first_mask.empty() ? level.mask : level.first_mask, shares.first, warped.f.data() + start);
      frame(level.second, level.mask, shares.second, warped.g.data() + start);
    }
  }
  warped.mark_tiles(threads);
}

}  // namespace pivnp::piv

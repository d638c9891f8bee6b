#include "pivnp/piv/recorrelation.hpp"

#include <omp.h>

#include <algorithm>

#include "pivnp/piv/method.hpp"

namespace pivnp::piv {

namespace {

constexpr int side_px = 32;  // of the windows, pixels of the level

}  // namespace

Mismatch::Mismatch(const MatchQuality& quality, float rounding)
    : textured(quality.score.size()), poor(quality.score.size()) {
  constexpr float poor_score = 0.6f, most_poor = 0.4f;
  std::size_t compared = 0;
  for (std::size_t k = 0; k < textured.size(); ++k) {
    textured[k] = quality.usable[k] >= 0.3f && quality.variance[k] > 4 * rounding && quality.contrast[k] > 0.1f;
    poor[k] = textured[k] && quality.score[k] < poor_score;
    compared += textured[k], count += poor[k];
  }
  frames_poor = static_cast<float>(count) > most_poor * static_cast<float>(compared);
}

Recorrelation::Recorrelation(const PivOptions& options, int threads)
    : median_threshold_(options.median_threshold),
      median_floor_px_(options.median_floor_px),
      min_usable_(static_cast<float>(options.min_usable)),
      anchor_(options.anchor),
      threads_(threads) {
  for (int t = 0; t < threads_; ++t) tools_.emplace_back(side_px, true);
}

void Recorrelation::search(const GnLevel& level, const Mismatch& mismatch, std::vector<float>& u,
                           std::vector<float>& v) {
  const CellLattice& lattice = level.lattice();
  const auto scale = static_cast<float>(level.decimation());
  known_ = {lattice.nx, lattice.ny, std::vector<std::array<float, 2>>(lattice.size()),
            std::vector<std::uint8_t>(lattice.size(), 0)};
  std::vector<std::size_t> open;  // points next to a poor one
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      bool near_poor = false;
      for (int b = std::max(0, j - 1); b <= std::min(lattice.ny - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(lattice.nx - 1, i + 1); ++a)
          near_poor = near_poor || mismatch.poor[lattice.index(a, b)];
      known_.displacement[k] = {scale * u[k], scale * v[k]};
      known_.good[k] = mismatch.textured[k] && !near_poor;
      if (near_poor) open.push_back(k);
    }
  constexpr float sigma = 0.5f;  // lattice steps: hardly smoothed
  around_.fit(level.even(), known_.displacement, known_.good, sigma, threads_);
  const Level& images = level.images();
  warp_pair(images, around_, anchor_, {0, 0, images.first.width(), images.first.height()}, threads_, warped_);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 4)
  for (std::size_t n = 0; n < open.size(); ++n)
    find(level, open[n], tools_[std::size_t(omp_get_thread_num())], mismatch.textured);
  median_test(known_, median_threshold_, median_floor_px_ * scale, threads_);
  around_.fit(level.even(), known_.displacement, known_.good, sigma, threads_);
  for (const std::size_t k : open) {
    const auto d = around_.at(level.column(static_cast<int>(k % std::size_t(lattice.nx))),
                              level.row(static_cast<int>(k / std::size_t(lattice.nx))));
    u[k] = d[0] / scale, v[k] = d[1] / scale;
  }
}

void Recorrelation::find(const GnLevel& level, std::size_t k, WindowTools& tools,
                         const std::vector<std::uint8_t>& textured) {
  constexpr float least_score = 0.5f;
  const CellLattice& lattice = level.lattice();
  const int i = static_cast<int>(k % std::size_t(lattice.nx)), j = static_cast<int>(k / std::size_t(lattice.nx));
  const auto scale = static_cast<float>(level.decimation());
  const auto predicted = around_.at(level.column(i), level.row(j));
  known_.displacement[k] = predicted;
  tools.window.cut(warped_, static_cast<float>(lattice.x0 + i * lattice.step),
                   static_cast<float>(lattice.y0 + j * lattice.step));
  if (!textured[k] || !(tools.window.usable >= min_usable_)) return;
  const Peak peak = tools.find(Search::far);
  if (!peak.interior || peak.score < least_score) return;
  known_.displacement[k] = {predicted[0] + scale * peak.dx, predicted[1] + scale * peak.dy};
  known_.good[k] = 1;
}

}  // namespace pivnp::piv

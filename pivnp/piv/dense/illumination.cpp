#include "pivnp/piv/dense/illumination.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/dense/lattice_filter.hpp"

namespace pivnp::piv {

void IlluminationCorrection::take(const CellSums& sums, int decimation, int threads, float rounding) {
  constexpr int reach = 2;  // cells
  constexpr float most_gain = 4;
  std::vector<float> before, offset_before;  // what the sums' second frame has been corrected by
  if (known()) at(sums.lattice, decimation, threads, before, offset_before);
  lattice_ = sums.lattice;
  decimation_ = decimation;
  using Plane = CellSums::Plane;
  std::vector<float> n, f, g, ff, gg;
  for (const auto& [plane, mean] : {std::pair<Plane, std::vector<float>*>{CellSums::usable, &n},
                                    {CellSums::f, &f},
                                    {CellSums::g, &g},
                                    {CellSums::ff, &ff},
                                    {CellSums::gg, &gg}})
    box_mean(lattice_, sums[plane], reach, *mean);
  gain_.assign(lattice_.size(), 1.0f);
  offset_.assign(lattice_.size(), 0.0f);
  for (std::size_t k = 0; k < lattice_.size(); ++k) {
    if (n[k] < 1) {
      if (!before.empty()) gain_[k] = before[k], offset_[k] = offset_before[k];
      continue;
    }
    const float mf = f[k] / n[k], mg = g[k] / n[k], vf = ff[k] / n[k] - mf * mf, vg = gg[k] / n[k] - mg * mg;
    if (std::min(vf, vg) > rounding) gain_[k] = std::clamp(std::sqrt(vf / vg), 1 / most_gain, most_gain);
    offset_[k] = mf - gain_[k] * mg;
    if (before.empty()) continue;
    offset_[k] += gain_[k] * offset_before[k];
    gain_[k] *= before[k];
  }
}

void IlluminationCorrection::at(const CellLattice& lattice, int decimation, int threads, std::vector<float>& gain,
                                std::vector<float>& offset) const {
  gain.resize(lattice.size());
  offset.resize(lattice.size());
  const float ratio = static_cast<float>(decimation) / static_cast<float>(decimation_);
  const auto place = [&](int point, int origin, int own_origin, int points, int& cell) {
    // pixel of this level -> of the other: centres of blocks of pixels
    const float x = (static_cast<float>(origin + point * lattice.step) + 0.5f) * ratio - 0.5f;
    const float s = std::clamp((x - static_cast<float>(own_origin)) / static_cast<float>(lattice_.step), 0.0f,
                               static_cast<float>(points - 1));
    cell = std::min(static_cast<int>(s), points - 2);
    return s - static_cast<float>(cell);
  };
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      int a = 0, b = 0;
      const float s = place(i, lattice.x0, lattice_.x0, lattice_.nx, a),
                  t = place(j, lattice.y0, lattice_.y0, lattice_.ny, b);
      const auto mix = [&](const std::vector<float>& v) {
        const float* top = v.data() + lattice_.index(a, b);
        const float* low = v.data() + lattice_.index(a, b + 1);
        return (1 - t) * (top[0] + s * (top[1] - top[0])) + t * (low[0] + s * (low[1] - low[0]));
      };
      gain[lattice.index(i, j)] = mix(gain_);
      offset[lattice.index(i, j)] = mix(offset_);
    }
}

}  // namespace pivnp::piv

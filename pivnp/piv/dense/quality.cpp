#include "pivnp/piv/dense/quality.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/dense/lattice_filter.hpp"

namespace pivnp::piv {

namespace {

struct WindowMoments {
  std::vector<float> n, f, g, ff, gg, fg;

  float variance_f(std::size_t k) const { return ff[k] - f[k] * f[k] / std::max(n[k], 1e-3f); }
  float variance_g(std::size_t k) const { return gg[k] - g[k] * g[k] / std::max(n[k], 1e-3f); }
  float coefficient(std::size_t k) const {
    const float vf = variance_f(k), vg = variance_g(k);
    return vf > 0 && vg > 0 ? (fg[k] - f[k] * g[k] / std::max(n[k], 1e-3f)) / std::sqrt(vf * vg) : 0.0f;
  }
};

}  // namespace

void match_quality(const CellSums& sums, MatchQuality& quality) {
  constexpr int wide = 3;  // points on each side
  const CellLattice& lattice = sums.lattice;
  WindowMoments near, far;
  const auto take = [&](CellSums::Plane plane, std::vector<float> WindowMoments::*member) {
    binomial_mean(lattice, sums[plane], near.*member);
    box_mean(lattice, near.*member, wide, far.*member);
  };
  take(CellSums::usable, &WindowMoments::n);
  take(CellSums::f, &WindowMoments::f);
  take(CellSums::g, &WindowMoments::g);
  take(CellSums::ff, &WindowMoments::ff);
  take(CellSums::gg, &WindowMoments::gg);
  take(CellSums::fg, &WindowMoments::fg);
  std::vector<float> gxx, gxy, gyy;
  binomial_mean(lattice, sums[CellSums::gxx], gxx);
  binomial_mean(lattice, sums[CellSums::gxy], gxy);
  binomial_mean(lattice, sums[CellSums::gyy], gyy);
  const std::size_t count = lattice.size();
  for (auto* v :
       {&quality.score, &quality.wide_score, &quality.usable, &quality.variance, &quality.contrast, &quality.slant})
    v->resize(count);
  double sum = 0, seen = 0;
  const float whole = static_cast<float>(lattice.step) * static_cast<float>(lattice.step);
  for (std::size_t k = 0; k < count; ++k) {
    quality.score[k] = near.coefficient(k);
    quality.wide_score[k] = far.coefficient(k);
    quality.usable[k] = near.n[k] / whole;
    quality.variance[k] = std::min(near.variance_f(k), near.variance_g(k)) / std::max(near.n[k], 1e-3f);
    if (near.n[k] > 0) sum += static_cast<double>(quality.variance[k]), ++seen;
    quality.slant[k] = -gxy[k] / std::sqrt(std::max(gxx[k] * gyy[k], 1e-20f));
  }
  const auto mean = static_cast<float>(std::max(sum, 1e-30) / std::max(seen, 1.0));
  for (std::size_t k = 0; k < count; ++k) quality.contrast[k] = quality.variance[k] / mean;
}

void truncation_variance(const CellLattice& lattice, const std::vector<float>& u, int threads,
                         std::vector<float>& variance) {
  constexpr float share = 0.15f;
  const int nx = lattice.nx, ny = lattice.ny;
  variance.assign(lattice.size(), 0.0f);
  const auto sixth = [](const float* at, std::ptrdiff_t s) {
    return (-20 * at[0] + 15 * (at[s] + at[-s]) - 6 * (at[2 * s] + at[-2 * s]) + at[3 * s] + at[-3 * s]) / 64;
  };
  std::vector<float> square(lattice.size(), 0.0f);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const float* at = u.data() + lattice.index(i, j);
      const float x = i >= 3 && i + 3 < nx ? sixth(at, 1) : 0.0f, y = j >= 3 && j + 3 < ny ? sixth(at, nx) : 0.0f;
      square[lattice.index(i, j)] = share * share * (x * x + y * y);
    }
  // The differences alternate in sign: what a neighbour shows concerns this point as well.
  binomial_mean(lattice, square, variance);
}

float trusted_sigma(float most, float wide_score) { return most * std::exp(3 * (std::min(wide_score, 1.0f) - 1)); }

}  // namespace pivnp::piv

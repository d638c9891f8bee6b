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

std::vector<std::size_t> moving_light(const CellSums& sums, float rounding) {
  constexpr float least_change = 0.012f, usual = 6, least_share = 0.02f, most_sigma = 0.45f, all_round = 0.9f;
  constexpr std::size_t least_points = 8;
  constexpr int reach = 4;
  const CellLattice& lattice = sums.lattice;
  std::vector<float> f, g, usable, change(lattice.size()), known;
  binomial_mean(lattice, sums[CellSums::f], f);
  binomial_mean(lattice, sums[CellSums::g], g);
  binomial_mean(lattice, sums[CellSums::usable], usable);
  const float whole = 0.999f * static_cast<float>(lattice.step * lattice.step);  // no mask in sight
  for (std::size_t k = 0; k < change.size(); ++k) {
    if (usable[k] > whole && f[k] + g[k] > 0) known.push_back(change[k] = std::abs(f[k] - g[k]) / (f[k] + g[k]));
  }
  std::vector<std::size_t> out;
  if (known.empty()) return out;
  const auto middle = known.begin() + std::ptrdiff_t(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  const float most = std::max(least_change, usual * *middle);
  for (std::size_t k = 0; k < change.size(); ++k)
    if (change[k] > most) out.push_back(k);
  const auto enough = [&] { return out.size() >= std::max(least_points, static_cast<std::size_t>(least_share * static_cast<float>(known.size()))); };
  if (!enough()) return {};
  // Material all round: beside air, what is seen changes as its edge moves.
  std::vector<float> variance, textured(lattice.size()), share;
  own_variance(sums, true, rounding, variance);
  for (std::size_t k = 0; k < textured.size(); ++k) textured[k] = usable[k] > 0 && variance[k] <= most_sigma * most_sigma ? 1.0f : 0.0f;
  box_mean(lattice, textured, reach, share);
  std::erase_if(out, [&](std::size_t k) { return share[k] < all_round; });
  if (!enough()) out.clear();
  return out;
}

void own_variance(const CellSums& sums, bool window, float rounding, std::vector<float>& variance) {
  // Hats average noise like an even window of one and a half cells a side, seen through weights 1/4, 1/2, 1/4 of three.
  const float even_cells = window ? 3.0f : 1.5f;
  constexpr float kept = 0.733f;  // of the variance of normal residuals under robust weights
  const CellLattice& lattice = sums.lattice;
  const auto step = static_cast<float>(lattice.step);
  // Products of both frames' gradients, in which noise cancels: those of the mean less a quarter of the difference's.
  std::vector<float> common(lattice.size()), xx, xy, yy, wee, weight, grey(lattice.size());
  const auto both = [&](CellSums::Plane mean, CellSums::Plane difference, std::vector<float>& out) {
    for (std::size_t k = 0; k < common.size(); ++k) common[k] = sums[mean][k] - 0.25f * sums[difference][k];
    window ? binomial_mean(lattice, common, out) : out.assign(common.begin(), common.end());
  };
  both(CellSums::gxx, CellSums::exx, xx);
  both(CellSums::gxy, CellSums::exy, xy);
  both(CellSums::gyy, CellSums::eyy, yy);
  if (window) {
    binomial_mean(lattice, sums[CellSums::wee], wee);
    binomial_mean(lattice, sums[CellSums::weight], weight);
  } else {
    wee = sums[CellSums::wee], weight = sums[CellSums::weight];
  }
  for (std::size_t k = 0; k < grey.size(); ++k)
    grey[k] = 0.5f * (sums[CellSums::f][k] + sums[CellSums::g][k]) / std::max(sums[CellSums::usable][k], 1e-3f);
  variance.resize(lattice.size());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      const int left = std::max(i - 1, 0), right = std::min(i + 1, lattice.nx - 1);
      const int above = std::max(j - 1, 0), below = std::min(j + 1, lattice.ny - 1);
      // Shading has gradients too, but nothing to hold on to.
      const float shade_x = (grey[lattice.index(right, j)] - grey[lattice.index(left, j)]) / (step * float(right - left));
      const float shade_y = (grey[lattice.index(i, below)] - grey[lattice.index(i, above)]) / (step * float(below - above));
      const float w = std::max(weight[k], 1e-3f), residual = wee[k] / (kept * w) + rounding;
      const float a = xx[k] / w - shade_x * shade_x, c = yy[k] / w - shade_y * shade_y, b = xy[k] / w - shade_x * shade_y;
      const float least = 0.5f * (a + c) - std::sqrt(0.25f * (a - c) * (a - c) + b * b);
      variance[k] = least > 0 ? residual / (even_cells * even_cells * w * least) : HUGE_VALF;
    }
}

void open_correction(const CellSums& sums, std::vector<float>& square) {
  constexpr float most = 1.5f;  // level pixels: beyond it the linearisation means nothing
  constexpr int reach = 2;
  const CellLattice& lattice = sums.lattice;
  std::vector<float> xx, xy, yy, xe, ye, seen, own(lattice.size()), all;
  binomial_mean(lattice, sums[CellSums::gxx], xx);
  binomial_mean(lattice, sums[CellSums::gxy], xy);
  binomial_mean(lattice, sums[CellSums::gyy], yy);
  binomial_mean(lattice, sums[CellSums::gxe], xe);
  binomial_mean(lattice, sums[CellSums::gye], ye);
  binomial_mean(lattice, sums[CellSums::usable], seen);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const float scale = 1 / (xx[k] * yy[k] - xy[k] * xy[k]);
    const float du = (yy[k] * xe[k] - xy[k] * ye[k]) * scale, dv = (xx[k] * ye[k] - xy[k] * xe[k]) * scale;
    const float moved = du * du + dv * dv;
    if (!std::isfinite(moved)) seen[k] = 0;
    own[k] = seen[k] > 0 ? seen[k] * std::min(moved, most * most) : 0.0f;
  }
  box_mean(lattice, own, reach, square);
  box_mean(lattice, seen, reach, all);
  for (std::size_t k = 0; k < square.size(); ++k) square[k] = all[k] > 0 ? square[k] / all[k] : 0.0f;
}

bool settled(float square, float own, int decimation) {
  constexpr float converged_px = 0.18f, deviations = 2, most_px = 0.35f;
  const float d2 = static_cast<float>(decimation * decimation);
  return !(d2 * square > std::min(converged_px * converged_px + deviations * deviations * d2 * own, most_px * most_px));
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

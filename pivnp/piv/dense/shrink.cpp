#include "pivnp/piv/dense/shrink.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/dense/shrink.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/lanes-inl.hpp"

#ifndef PIVNP_PIV_SHRINK_ONCE
#define PIVNP_PIV_SHRINK_ONCE
namespace pivnp::piv {

constexpr int block_sides[] = {8, 16, 32, 64};
constexpr float strength = 2.5f;    // of the shrinkage, in noise powers
constexpr float most_power = 4.0f;  // what a coefficient may lend to its neighbours
constexpr float plane_terms = 3.0f;
// Power at which a coefficient stands out by itself: the universal threshold 2 ln(n n), so that chance yields hardly
// one in a block (Donoho & Johnstone 1994), not below 12 (chance 5e-4).
template <int n>
constexpr float clear = n <= 16 ? 12.0f : n == 32 ? 13.9f : 16.6f;

// The stated variance is noise power times the terms kept. Terms kept next to the threshold have lost signal besides,
// so each counts `term_weight` times; `spread` covers what the blocks' averaging adds. Both measured on waves, bands
// and shears with noise and loss (docs/theory/piv.md).
constexpr float term_weight = 12.0f;
template <int n>
constexpr float spread = n < 64 ? 1.20f : 0.80f;

template <int n>
struct Cosines {
  alignas(64) float forward[n][n];  // [frequency][point], orthonormal
  alignas(64) float back[n][n];     // transposed
  float noise[n];                   // spectrum of unit noise along one axis
  float neighbours[n];              // 1 / weight of the neighbours that exist
  Cosines() {
    for (int k = 0; k < n; ++k) {
      for (int x = 0; x < n; ++x)
        forward[k][x] = back[x][k] =
            static_cast<float>(std::sqrt((k == 0 ? 1.0 : 2.0) / n) * std::cos(M_PI * (x + 0.5) * k / n));
      noise[k] = static_cast<float>(1 + 0.5 * std::cos(M_PI * k / n));
      neighbours[k] = k == 0 || k == n - 1 ? 1.0f / 3 : 0.25f;
    }
  }
};

}  // namespace pivnp::piv
#endif

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

template <int n>
using Tag = hn::CappedTag < float,
      n<16 ? n : 16>;

// out = a in b, all n x n; a is read by rows, b by rows.
template <int n>
HWY_INLINE void multiply(const float (*a)[n], const float (*in)[n], const float (*b)[n], float (*half)[n],
                         float (*out)[n]) {
  const Tag<n> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += lanes) {
      auto sum = hn::Mul(hn::Set(d, a[r][0]), hn::Load(d, in[0] + c));
      for (int k = 1; k < n; ++k) sum = hn::MulAdd(hn::Set(d, a[r][k]), hn::Load(d, in[k] + c), sum);
      hn::Store(sum, d, half[r] + c);
    }
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += lanes) {
      auto sum = hn::Mul(hn::Set(d, half[r][0]), hn::Load(d, b[0] + c));
      for (int k = 1; k < n; ++k) sum = hn::MulAdd(hn::Set(d, half[r][k]), hn::Load(d, b[k] + c), sum);
      hn::Store(sum, d, out[r] + c);
    }
}

template <int n>
float sum_of(const float (*v)[n]) {
  const Tag<n> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  // Sixteen partial sums in the same order for any vector length.
  float total = 0;
  alignas(64) float part[n < 16 ? n : 16] = {};
  constexpr int width = n < 16 ? n : 16;
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += width)
      for (int l = 0; l < width; l += lanes)
        hn::Store(hn::Add(hn::Load(d, part + l), hn::Load(d, v[r] + c + l)), d, part + l);
  for (float p : part) total += p;
  return total;
}

// Noise power of the coefficients `first` ... `end` - 1 along both axes, of those that change fast, where structures
// hardly reach: the mean of powers clipped at twice the result, by fixed-point iteration from the plain mean.
template <int n, int first = n / 4, int end = n>
float noise_power(const float (*power)[n]) {
  constexpr int width = 4, columns = (end - first) / width * width;
  constexpr float clip = 2.0f, kept = 0.742192f;  // mean of a squared normal variable clipped at 2
  const hn::CappedTag<float, width> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  float noise = 0;
  constexpr float count = static_cast<float>((end - first) * columns);
  const auto mean = [&](float limit) {
    alignas(64) float part[width] = {};
    const auto most = hn::Set(d, limit);
    for (int r = first; r < end; ++r)
      for (int c = end - columns; c < end; c += width)
        for (int l = 0; l < width; l += lanes)
          hn::Store(hn::Add(hn::Load(d, part + l), hn::Min(most, hn::LoadU(d, power[r] + c + l))), d, part + l);
    float sum = 0;
    for (float p : part) sum += p;
    return sum / count;
  };
  noise = mean(3e38f);
  for (int k = 0; k < 14; ++k) noise = mean(clip * noise) / kept;
  return std::max(noise, 1e-14f);
}

// Power over the octave n/4 ... n/2 by that of the faster ones. Structures only add to it.
template <int n>
float octave_ratio(const float (*power)[n]) {
  if constexpr (n < 16) return 1;
  return noise_power<n, n / 4, n / 2>(power) / noise_power<n, n / 2, n>(power);
}

template <int n>
void shrink_block(const float* values, std::ptrdiff_t stride, float caution, bool risk, Shrinker::Block& out) {
  static const Cosines<n> cosines;
  const Tag<n> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  alignas(64) float block[n][n], half[n][n], spectrum[n][n], power[n][n], smooth[n][n];
  for (int r = 0; r < n; ++r) std::copy_n(values + r * stride, n, block[r]);

  constexpr float middle = 0.5f * (n - 1), square = n * (float(n) * n * n - n) / 12;  // sum of x^2 over the block
  float slope_x = 0, slope_y = 0;
  const float mean = sum_of<n>(block) / (n * n);
  for (int r = 0; r < n; ++r) {
    float row = 0;
    for (int c = 0; c < n; ++c) row += block[r][c], slope_x += (float(c) - middle) * (block[r][c] - mean);
    slope_y += (float(r) - middle) * (row - n * mean);
  }
  slope_x /= square, slope_y /= square;
  const auto plane = [&](float sign) {
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c)
        block[r][c] += sign * (mean + slope_x * (float(c) - middle) + slope_y * (float(r) - middle));
  };
  plane(-1);
  multiply<n>(cosines.forward, block, cosines.back, half, spectrum);

  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += lanes) {
      const auto v = hn::Load(d, spectrum[r] + c);
      const auto shape = hn::Mul(hn::Set(d, cosines.noise[r]), hn::LoadU(d, cosines.noise + c));
      hn::Store(hn::Div(hn::Mul(v, v), shape), d, power[r] + c);
    }
  const float noise = noise_power<n>(power);
  out.octave = octave_ratio<n>(power);

  // Neighbours: 1, 2, 1 along both axes, each clipped.
  const auto scale = hn::Set(d, 1 / noise);
  const auto most = hn::Set(d, most_power);
  alignas(64) float padded[n + 2][n + 32] = {};  // columns from 16 on
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += lanes) {
      const auto p = hn::Mul(scale, hn::Load(d, power[r] + c));
      hn::Store(p, d, power[r] + c);
      hn::StoreU(hn::Min(p, most), d, padded[r + 1] + 16 + c);
    }
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += lanes) {
      const auto column = [&](int shift) {
        const float* at = padded[r] + 16 + c + shift;
        const auto here = hn::LoadU(d, at + (n + 32));
        return hn::Add(hn::Add(hn::LoadU(d, at), hn::LoadU(d, at + 2 * (n + 32))), hn::Add(here, here));
      };
      const auto here = column(0);
      const auto sum = hn::Add(hn::Add(column(-1), column(1)), hn::Add(here, here));
      hn::Store(hn::Mul(sum, hn::Mul(hn::Set(d, cosines.neighbours[r]), hn::LoadU(d, cosines.neighbours + c))), d,
                smooth[r] + c);
    }

  const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d), force = hn::Set(d, caution * strength),
             limit = hn::Set(d, caution * clear<n>);
  const auto tiny = hn::Set(d, 1e-6f);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; c += lanes) {
      const auto p = hn::Load(d, power[r] + c);
      const auto by_neighbours = hn::Max(zero, hn::Sub(one, hn::Div(force, hn::Max(hn::Load(d, smooth[r] + c), tiny))));
      const auto by_itself = hn::IfThenElseZero(hn::Gt(p, limit), hn::Sub(one, hn::Div(force, hn::Max(p, tiny))));
      const auto gain = hn::Max(by_neighbours, by_itself);
      hn::Store(hn::Mul(gain, hn::Load(d, spectrum[r] + c)), d, spectrum[r] + c);
      const auto shape = hn::Mul(hn::Set(d, cosines.noise[r]), hn::LoadU(d, cosines.noise + c));
      hn::Store(hn::Mul(hn::Mul(gain, shape), hn::MulAdd(hn::Set(d, term_weight), hn::Sub(one, gain), one)), d,
                smooth[r] + c);
      hn::Store(hn::Mul(hn::Mul(gain, gain), shape), d, power[r] + c);  // and their noise
      if (!risk) continue;
      // g^2 of the noise, and (1 - g)^2 of the signal, whose power over noise is P - 1 = strength/(1 - g) - 1.
      const auto left_over = hn::MulAdd(force, hn::Sub(one, gain), hn::Sub(hn::Add(gain, gain), one));
      hn::Store(hn::IfThenElseZero(hn::Gt(gain, zero), hn::Mul(shape, left_over)), d, half[r] + c);
    }
  const float terms = sum_of<n>(smooth), kept = sum_of<n>(power);
  const float left = risk ? sum_of<n>(half) : 0.0f;
  multiply<n>(cosines.back, spectrum, cosines.forward, half, block);
  plane(1);
  out.value.resize(n * n);
  for (int r = 0; r < n; ++r) std::copy_n(block[r], n, out.value.data() + r * n);
  out.variance = spread<n> * noise * (plane_terms + terms) / (n * n);
  out.terms = plane_terms + kept;
  out.risk = spread<n> * noise * (plane_terms + left) / (n * n);
}

void shrink(int side, const float* values, std::ptrdiff_t stride, float caution, bool risk, Shrinker::Block& out) {
  if (side == 8)
    shrink_block<8>(values, stride, caution, risk, out);
  else if (side == 16)
    shrink_block<16>(values, stride, caution, risk, out);
  else if (side == 32)
    shrink_block<32>(values, stride, caution, risk, out);
  else
    shrink_block<64>(values, stride, caution, risk, out);
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(shrink);

namespace {

std::vector<int> starts(int points, int side) {
  std::vector<int> at;
  for (int k = 0; k < points - side; k += side / 2) at.push_back(k);
  at.push_back(points - side);
  return at;
}

}  // namespace

// What the kept terms' noise is of that of the fast ones, block by block. The texture's own noise in clean frames that
// are deformed has less power at long wavelengths: its fall over one octave, as a mean over some blocks about, is
// carried on by three octaves (where kept terms lie; by six in the largest blocks). Where structures hide the
// fall, nothing is subtracted.
static void find_slow_shares(int side, std::size_t across, std::vector<Shrinker::Block>& blocks, std::size_t count) {
  const float octaves = side >= 64 ? 6.0f : 3.0f;
  const int reach = side >= 32 ? 3 : 6, nx = static_cast<int>(across), ny = static_cast<int>(count / across);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      float sum = 0, some = 0;
      for (int b = std::max(0, j - reach); b <= std::min(ny - 1, j + reach); ++b)
        for (int a = std::max(0, i - reach); a <= std::min(nx - 1, i + reach); ++a) {
          const Shrinker::Block& block = blocks[std::size_t(b) * across + std::size_t(a)];
          if (block.terms > 0) sum += block.octave, ++some;
        }
      const float fall = some > 0 ? std::min(1.0f, sum / some) : 1.0f;
      blocks[std::size_t(j) * across + std::size_t(i)].slow = std::pow(fall, octaves);
    }
}

Shrinker::Shrinker(const CellLattice& lattice) : lattice_(lattice) {
  for (const int side : block_sides) {
    if (side > lattice.nx || side > lattice.ny) continue;
    Layer layer;
    layer.side = side;
    layer.x = starts(lattice.nx, side);
    layer.y = starts(lattice.ny, side);
    const auto axis = [&](int k) { return 0.05f + std::sin(float(M_PI) * (float(k) + 0.5f) / float(side)); };
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) layer.window.push_back(axis(r) * axis(c));
    layers_.push_back(std::move(layer));
  }
}

void Shrinker::run(const std::vector<float>& value, const std::vector<std::uint8_t>& wanted, int threads,
                   SmoothedField& out, float caution, bool risk) const {
  const std::size_t points = lattice_.size();
  for (auto* v : {&out.value, &out.variance, &out.area}) v->assign(points, 0.0f);
  std::vector<float> weight(points, 0.0f);
  std::vector<Block> blocks;
  for (const Layer& layer : layers_) {
    const int side = layer.side;
    const std::size_t across = layer.x.size(), count = across * layer.y.size();
    blocks.resize(std::max(blocks.size(), count));
#pragma omp parallel for num_threads(threads) schedule(static)
    for (std::size_t b = 0; b < count; ++b) {
      const int x0 = layer.x[b % across], y0 = layer.y[b / across];
      bool any = wanted.empty();
      for (int r = 0; r < side && !any; ++r)
        for (int c = 0; c < side && !any; ++c) any = wanted[lattice_.index(x0 + c, y0 + r)] != 0;
      blocks[b].terms = 0;
      if (!any) continue;
      HWY_DYNAMIC_DISPATCH(shrink)
      (side, value.data() + lattice_.index(x0, y0), lattice_.nx, caution, risk, blocks[b]);
    }
    find_slow_shares(side, across, blocks, count);
    for (std::size_t b = 0; b < count; ++b) {  // in a fixed order
      const Block& block = blocks[b];
      if (block.terms == 0) continue;
      const int x0 = layer.x[b % across], y0 = layer.y[b / across];
      const float variance = block.slow * (risk ? block.risk : block.variance);
      const float trust = static_cast<float>(side * side) / block.terms;
      for (int r = 0; r < side; ++r) {
        const std::size_t to = lattice_.index(x0, y0 + r);
        const float* from = block.value.data() + r * side;
        const float* window = layer.window.data() + r * side;
        for (std::size_t c = 0; c < std::size_t(side); ++c) {
          const float w = trust * window[c];
          out.value[to + c] += w * from[c];
          out.variance[to + c] += w * variance;
          out.area[to + c] += w * trust;
          weight[to + c] += w;
        }
      }
    }
  }
  for (std::size_t k = 0; k < points; ++k) {
    if (weight[k] > 0) {
      for (auto* v : {&out.value, &out.variance, &out.area}) (*v)[k] /= weight[k];
    } else {
      out.value[k] = value[k];
      out.area[k] = 1;
    }
  }
}

}  // namespace pivnp::piv
#endif

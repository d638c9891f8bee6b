#include "pivnp/piv/shrink.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstdio>

namespace pivnp::piv {

namespace {

constexpr int most = 32;  // points of a block along an axis
const float VG = std::getenv("VG") ? std::atof(std::getenv("VG")) : 0;
const float VA = std::getenv("VA") ? std::atof(std::getenv("VA")) : 1, VF = std::getenv("VF") ? std::atof(std::getenv("VF")) : 1;
const float cap = std::getenv("SCAP") ? std::atof(std::getenv("SCAP")) : 4;
const float clear = std::getenv("SCLEAR") ? std::atof(std::getenv("SCLEAR")) : 12;
using Block = std::array<float, most * most>;

std::vector<float> dct_matrix(int n) {
  std::vector<float> m(std::size_t(n) * std::size_t(n));
  for (int k = 0; k < n; ++k)
    for (int x = 0; x < n; ++x)
      m[std::size_t(k * n + x)] =
          static_cast<float>(std::sqrt((k == 0 ? 1.0 : 2.0) / n) * std::cos(M_PI * (x + 0.5) * k / n));
  return m;
}

std::vector<int> starts(int points, int side, int block_step) {
  std::vector<int> at;
  for (int k = 0; k < points - side; k += block_step) at.push_back(k);
  at.push_back(points - side);
  return at;
}

// out = A in B^T for A [ny][ny], B [nx][nx] (or their transposes), in [ny][nx].
void transform(const float* a, const float* b, int ny, int nx, bool back, const Block& in, Block& out) {
  Block half;
  for (int r = 0; r < ny; ++r) {
    float* line = half.data() + r * most;
    std::fill(line, line + most, 0.0f);
    for (int k = 0; k < ny; ++k) {
      const float factor = back ? a[k * ny + r] : a[r * ny + k];
      const float* from = in.data() + k * most;
      for (int x = 0; x < nx; ++x) line[x] += factor * from[x];
    }
  }
  for (int r = 0; r < ny; ++r) {
    float* line = out.data() + r * most;
    std::fill(line, line + most, 0.0f);
    for (int k = 0; k < nx; ++k) {
      const float factor = half[std::size_t(r * most + k)];
      if (back)
        for (int x = 0; x < nx; ++x) line[x] += factor * b[k * nx + x];
      else
        for (int x = 0; x < nx; ++x) line[x] += factor * b[x * nx + k];
    }
  }
}

struct Plane {
  float mean = 0, slope_x = 0, slope_y = 0;
};

Plane remove_plane(Block& block, int nx, int ny) {
  Plane plane;
  const float mx = 0.5f * static_cast<float>(nx - 1), my = 0.5f * static_cast<float>(ny - 1);
  float sum = 0, sx = 0, sy = 0, qx = 0, qy = 0;
  for (int r = 0; r < ny; ++r)
    for (int c = 0; c < nx; ++c) {
      const float v = block[std::size_t(r * most + c)], x = static_cast<float>(c) - mx, y = static_cast<float>(r) - my;
      sum += v, sx += x * v, sy += y * v, qx += x * x, qy += y * y;
    }
  plane.mean = sum / static_cast<float>(nx * ny);
  plane.slope_x = qx > 0 ? sx / qx : 0.0f;
  plane.slope_y = qy > 0 ? sy / qy : 0.0f;
  for (int r = 0; r < ny; ++r)
    for (int c = 0; c < nx; ++c)
      block[std::size_t(r * most + c)] -=
          plane.mean + plane.slope_x * (static_cast<float>(c) - mx) + plane.slope_y * (static_cast<float>(r) - my);
  return plane;
}

// Median power of the coefficients that change fast along both axes, where structures hardly reach, over that of unit
// noise (the median of a squared normal variable).
float noise_scale(const Block& ratio, int nx, int ny) {
  std::array<float, most * most> power;
  int count = 0;
  for (int r = ny / 4; r < ny; ++r)
    for (int c = nx / 4; c < nx; ++c) power[std::size_t(count++)] = ratio[std::size_t(r * most + c)];
  const auto middle = power.begin() + count / 2;
  std::nth_element(power.begin(), middle, power.begin() + count);
  return std::max(*middle / 0.4549f, 1e-6f);
}

}  // namespace

BlockLayer::BlockLayer(const CellLattice& lattice, int side, int block_step)
    : lattice_(lattice),
      step_(block_step),
      bx_(std::min(side, lattice.nx)),
      by_(std::min(side, lattice.ny)),
      dct_x_(dct_matrix(bx_)),
      dct_y_(dct_matrix(by_)) {
  const auto axis = [](int k, int n) { return 0.05f + std::sin(static_cast<float>(M_PI) * (float(k) + 0.5f) / float(n)); };
  const auto noise = [](int k, int n) { return 1 + 0.5f * std::cos(static_cast<float>(M_PI) * float(k) / float(n)); };
  for (int r = 0; r < by_; ++r)
    for (int c = 0; c < bx_; ++c) {
      window_.push_back(axis(r, by_) * axis(c, bx_));
      spectrum_.push_back(noise(r, by_) * noise(c, bx_));
    }
}

void BlockLayer::add(const NoisyField& in, float strength, int threads, Shrunk& out, std::vector<float>& weight) const {
  const std::vector<int> rows = starts(lattice_.ny, by_, step_), columns = starts(lattice_.nx, bx_, step_);
  // Blocks of one row of blocks overlap those of the next three only: every fourth row at once, in a fixed order.
  struct Result {
    Block value;
    float variance, removed, lost, weight;
  };
  std::vector<Result> results(columns.size() * rows.size());
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::size_t b = 0; b < results.size(); ++b) {
    const int x0 = columns[b % columns.size()], y0 = rows[b / columns.size()];
    Result& result = results[b];
    Block block{}, spectrum{}, ratio{};
    float variance = 0;
    for (int r = 0; r < by_; ++r)
      for (int c = 0; c < bx_; ++c) {
        block[std::size_t(r * most + c)] = in.value[lattice_.index(x0 + c, y0 + r)];
        variance += in.variance[lattice_.index(x0 + c, y0 + r)];
      }
    variance = std::max(variance / static_cast<float>(bx_ * by_), 1e-12f);
    const Plane plane = remove_plane(block, bx_, by_);
    transform(dct_y_.data(), dct_x_.data(), by_, bx_, false, block, spectrum);
    for (int r = 0; r < by_; ++r)
      for (int c = 0; c < bx_; ++c) {
        const std::size_t k = std::size_t(r * most + c);
        ratio[k] = spectrum[k] * spectrum[k] / (variance * spectrum_[std::size_t(r * bx_ + c)]);
      }
    const float scale = noise_scale(ratio, bx_, by_);
    variance *= scale;
    for (float& q : ratio) q /= scale;
    float kept = 3, left = 3, removed = 0, lost = 0;
    for (int r = 0; r < by_; ++r)
      for (int c = 0; c < bx_; ++c) {
        float sum = 0, all = 0;
        for (int b2 = -1; b2 <= 1; ++b2)
          for (int a2 = -1; a2 <= 1; ++a2) {
            if (r + b2 < 0 || r + b2 >= by_ || c + a2 < 0 || c + a2 >= bx_) continue;
            const float w = (a2 == 0 ? 2.0f : 1.0f) * (b2 == 0 ? 2.0f : 1.0f);
            sum += w * std::min(ratio[std::size_t((r + b2) * most + c + a2)], cap), all += w;
          }
        const std::size_t k = std::size_t(r * most + c);
        float gain = std::max(0.0f, 1 - strength * all / std::max(sum, 1e-6f));
        if (ratio[k] > clear) gain = std::max(gain, 1 - strength / ratio[k]);
        const float shape = spectrum_[std::size_t(r * bx_ + c)];
        kept += gain * gain * shape, left += gain * shape;
        removed += (1 - gain) * (1 - gain) * shape;
        lost += (1 - gain) * (1 - gain) * std::max(0.0f, spectrum[k] * spectrum[k] - variance * shape);
        spectrum[k] *= gain;
      }
    transform(dct_y_.data(), dct_x_.data(), by_, bx_, true, spectrum, block);
    const float count = static_cast<float>(bx_ * by_);
    result.variance = variance * (3 + VA * (left - 3) + VG * std::sqrt(left - 3)) / count * VF;
    result.removed = removed / count;
    result.lost = lost / count;
    result.weight = count / 256 / kept;
    const float mx = 0.5f * static_cast<float>(bx_ - 1), my = 0.5f * static_cast<float>(by_ - 1);
    for (int r = 0; r < by_; ++r)
      for (int c = 0; c < bx_; ++c)
        result.value[std::size_t(r * most + c)] = block[std::size_t(r * most + c)] + plane.mean +
                                                  plane.slope_x * (static_cast<float>(c) - mx) +
                                                  plane.slope_y * (static_cast<float>(r) - my);
  }
  for (std::size_t b = 0; b < results.size(); ++b) {
    const int x0 = columns[b % columns.size()], y0 = rows[b / columns.size()];
    const Result& result = results[b];
    for (int r = 0; r < by_; ++r)
      for (int c = 0; c < bx_; ++c) {
        const std::size_t k = lattice_.index(x0 + c, y0 + r);
        const float w = result.weight * window_[std::size_t(r * bx_ + c)];
        out.value[k] += w * result.value[std::size_t(r * most + c)];
        out.variance[k] += w * result.variance;
        out.removed[k] += w * result.removed;
        out.lost[k] += w * result.lost;
        weight[k] += w;
      }
  }
}

Shrinker::Shrinker(const CellLattice& lattice) {
  const char* spec = std::getenv("LAYERS") ? std::getenv("LAYERS") : "8,4/16,8/32,16";
  int a, b, n;
  while (std::sscanf(spec, "%d,%d%n", &a, &b, &n) == 2) { layers_.emplace_back(lattice, a, b); spec += n; if (*spec) ++spec; }
}

void Shrinker::run(const NoisyField& in, float strength, int threads, Shrunk& out) const {
  const std::size_t points = in.value.size();
  for (auto* v : {&out.value, &out.variance, &out.removed, &out.lost}) v->assign(points, 0.0f);
  std::vector<float> weight(points, 0.0f);
  for (const BlockLayer& layer : layers_) layer.add(in, strength, threads, out, weight);
  for (std::size_t k = 0; k < points; ++k)
    for (auto* v : {&out.value, &out.variance, &out.removed, &out.lost}) (*v)[k] /= weight[k];
}

}  // namespace pivnp::piv

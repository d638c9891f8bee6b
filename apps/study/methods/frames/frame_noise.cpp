#include "apps/study/methods/frames/frame_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "apps/study/methods/frames/texture.hpp"

namespace pivnp::app {

namespace {

constexpr int block = 16, kernel_reach = 4;  // px
constexpr std::size_t least_blocks = 30, most_blocks = 3000;
using Spectrum = std::array<double, std::size_t(block) * block>;  // by (row, column) of frequency

double frequency(int k) { return 2 * std::numbers::pi * k / block; }

// Periodogram of a block after its mean is off, by rows and columns.
void add_periodogram(std::vector<double> values, Spectrum& sum) {
  double mean = 0;
  for (const double v : values) mean += v / double(values.size());
  std::array<double, block> taper;  // Hann
  for (int k = 0; k < block; ++k) taper[std::size_t(k)] = std::pow(std::sin(std::numbers::pi * (k + 0.5) / block), 2);
  std::vector<std::complex<double>> rows(values.size());
  const auto at = [](int r, int c) { return std::size_t(r) * block + std::size_t(c); };
  std::array<std::complex<double>, block> turn;
  for (int k = 0; k < block; ++k) turn[std::size_t(k)] = std::polar(1.0, -frequency(k));
  for (int r = 0; r < block; ++r)
    for (int k = 0; k < block; ++k)
      for (int c = 0; c < block; ++c)
        rows[at(r, k)] += (values[at(r, c)] - mean) * taper[std::size_t(r)] * taper[std::size_t(c)] * turn[std::size_t(k * c % block)];
  for (int k = 0; k < block; ++k)
    for (int l = 0; l < block; ++l) {
      std::complex<double> all = 0;
      for (int r = 0; r < block; ++r) all += rows[at(r, k)] * turn[std::size_t(l * r % block)];
      sum[at(l, k)] += std::norm(all);
    }
}

// Squared response of the interpolating cubic B-spline, read a share `f` of a pixel beyond one.
double response(double f, double omega) {
  std::complex<double> shifted = 0;
  double still = 0;
  for (int m = -3; m <= 3; ++m) {
    const auto spline = [](double x) {
      const double a = std::abs(x);
      return a < 1 ? 2.0 / 3 - a * a + a * a * a / 2 : a < 2 ? std::pow(2 - a, 3) / 6 : 0.0;
    };
    shifted += spline(f - m) * std::polar(1.0, -omega * m);
    still += spline(m) * std::cos(omega * m);
  }
  return std::norm(shifted) / (still * still);
}

// Displacement about a node, and its gradient from the valid nodes beside it.
struct Local {
  Vec2 at, displacement;
  Mat2 gradient = Mat2::Zero();
};

std::optional<Local> local(const piv::NodeLattice& nodes, const piv::PixelVectors& found, int i, int j) {
  const auto index = [&](int a, int b) { return std::size_t(b) * std::size_t(nodes.nx) + std::size_t(a); };
  const auto ok = [&](int a, int b) { return a >= 0 && b >= 0 && a < nodes.nx && b < nodes.ny && found.status[index(a, b)] == VectorStatus::valid; };
  const auto vec = [](const std::array<float, 2>& a) { return Vec2(double(a[0]), double(a[1])); };
  if (!ok(i, j) || !ok(i - 1, j) || !ok(i + 1, j) || !ok(i, j - 1) || !ok(i, j + 1)) return std::nullopt;
  Mat2 along, change;
  along.col(0) = vec(nodes.pixel[index(i + 1, j)]) - vec(nodes.pixel[index(i - 1, j)]);
  along.col(1) = vec(nodes.pixel[index(i, j + 1)]) - vec(nodes.pixel[index(i, j - 1)]);
  change.col(0) = vec(found.displacement[index(i + 1, j)]) - vec(found.displacement[index(i - 1, j)]);
  change.col(1) = vec(found.displacement[index(i, j + 1)]) - vec(found.displacement[index(i, j - 1)]);
  Local out{vec(nodes.pixel[index(i, j)]), vec(found.displacement[index(i, j)]), {}};
  out.gradient = change * along.inverse();
  return out;
}

}  // namespace

NoiseShape noise_shape(const Image& first, const Image& second, const piv::NodeLattice& nodes, const piv::PixelVectors& found,
                       const std::vector<std::uint8_t>& used) {
  const CarriedTexture a(first, 0), b(second, 0);
  std::vector<Local> blocks;
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i) {
      if (!used[std::size_t(j) * std::size_t(nodes.nx) + std::size_t(i)]) continue;
      if (const auto here = local(nodes, found, i, j)) blocks.push_back(*here);
    }
  const std::size_t stride = blocks.size() / most_blocks + 1;
  Spectrum seen{}, of_white{};
  std::size_t count = 0;
  for (std::size_t n = 0; n < blocks.size(); n += stride) {
    const Local& l = blocks[n];
    // The first frame is read at its pixels, the second where they have gone.
    const double back = found.anchor == Anchor::central ? 0.5 : 0;
    const Vec2 start = l.at - back * l.displacement;
    const int left = int(std::lround(start.x())) - block / 2, top = int(std::lround(start.y())) - block / 2;
    const Vec2 middle(left + 0.5 * (block - 1), top + 0.5 * (block - 1));
    const double rim = 4;
    const auto inside = [&](const Vec2& x) {
      const double half = 0.5 * block + rim;
      return x.x() > half && x.y() > half && x.x() < a.width() - half && x.y() < a.height() - half;
    };
    if (!inside(middle) || !inside(middle + l.displacement)) continue;
    std::vector<double> difference;
    for (int r = 0; r < block; ++r)
      for (int c = 0; c < block; ++c) {
        const Vec2 x(left + c, top + r);
        const Vec2 d = l.displacement + l.gradient * (x - start);
        difference.push_back(b.at(x + d) - double(a.still(left + c, top + r)));
      }
    add_periodogram(difference, seen);
    const Vec2 d = l.displacement + l.gradient * (middle - start), part = d - Vec2(std::floor(d.x()), std::floor(d.y()));
    for (int row = 0; row < block; ++row)
      for (int column = 0; column < block; ++column)
        of_white[std::size_t(row * block + column)] += 1 + response(part.x(), frequency(column)) * response(part.y(), frequency(row));
    ++count;
  }
  if (count < least_blocks) return {};
  // The zero frequency went with the mean: it is like its neighbours.
  const auto at = [](int r, int c) { return std::size_t((r + block) % block) * block + std::size_t((c + block) % block); };
  Spectrum noise;
  for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = seen[k] / of_white[k];
  noise[0] = 0.25 * (noise[at(0, 1)] + noise[at(1, 0)] + noise[at(1, 1)] + noise[at(1, -1)]);
  double all = 0;
  for (const double v : noise) all += v;
  if (!(all > 0)) return {};
  std::vector<double> weights;  // of least reach: no phase
  for (int r = -kernel_reach; r <= kernel_reach; ++r)
    for (int c = -kernel_reach; c <= kernel_reach; ++c) {
      double sum = 0;
      for (int l = 0; l < block; ++l)
        for (int k = 0; k < block; ++k)
          sum += std::sqrt(0.5 * (noise[at(l, k)] + noise[at(-l, -k)])) * std::cos(frequency(k) * c + frequency(l) * r);
      weights.push_back(sum);
    }
  return NoiseShape(kernel_reach, std::move(weights));
}

}  // namespace pivnp::app

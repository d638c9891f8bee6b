#include "pivnp/image/frames/compression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pivnp/core/regular_file.hpp"

namespace pivnp::image {

namespace {

constexpr int block = 8;
constexpr std::size_t most_blocks = 1000, least_blocks = 100, least_values = 60;

// Steps at quality 50, by the frequency along y and x.
constexpr int luminance[block][block] = {{16, 11, 10, 16, 24, 40, 51, 61},     {12, 12, 14, 19, 26, 58, 60, 55},
                                         {14, 13, 16, 24, 40, 57, 69, 56},     {14, 17, 22, 29, 51, 87, 80, 62},
                                         {18, 22, 37, 56, 68, 109, 103, 77},   {24, 35, 55, 64, 81, 104, 113, 92},
                                         {49, 64, 78, 87, 103, 121, 120, 101}, {72, 92, 95, 98, 112, 100, 103, 99}};

using Block = std::array<std::array<double, block>, block>;

Block transformed(const ImageView& image, int left, int top) {
  static const Block basis = [] {  // [frequency][place]
    Block b{};
    for (int k = 0; k < block; ++k)
      for (int n = 0; n < block; ++n)
        b[std::size_t(k)][std::size_t(n)] = (k == 0 ? std::sqrt(1.0 / block) : std::sqrt(2.0 / block)) *
                                            std::cos((2 * n + 1) * k * std::numbers::pi / (2 * block));
    return b;
  }();
  Block rows{}, out{};
  for (std::size_t r = 0; r < block; ++r)
    for (std::size_t k = 0; k < block; ++k)
      for (std::size_t n = 0; n < block; ++n)
        rows[r][k] += basis[k][n] * (double(image.row<std::uint8_t>(top + int(r))[left + int(n)]) - 128);
  for (std::size_t j = 0; j < block; ++j)
    for (std::size_t k = 0; k < block; ++k)
      for (std::size_t n = 0; n < block; ++n) out[j][k] += basis[j][n] * rows[n][k];
  return out;
}

// Values beyond black and white are lost, and with them the multiples.
bool clipped(const ImageView& image, int left, int top) {
  for (int r = top; r < top + block; ++r)
    for (int c = left; c < left + block; ++c)
      if (const std::uint8_t grey = image.row<std::uint8_t>(r)[c]; grey == 0 || grey == 255) return true;
  return false;
}

// The greatest step at whose multiples values lie; 0: none. What would be zero at that step tells nothing.
int step_of(const std::vector<double>& values) {
  constexpr int most = 100;
  constexpr double share =
      0.14;  // of a step, median distance from its multiples: .25 without any, rounding leaves .2 to .4 of a grey value
  for (int step = most; step >= 4; --step) {
    std::vector<double> off;
    for (const double value : values)
      if (const int times = int(value / step + 0.5); times >= 1) off.push_back(std::abs(value / step - times));
    if (off.size() < least_values) continue;
    const auto middle = off.begin() + std::ptrdiff_t(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    if (*middle < std::min(share, 0.5 / step + 0.02)) return step;
  }
  return 0;
}

int quality_of_scale(double scale) {
  return std::clamp(int(std::lround(scale <= 100 ? 100 - scale / 2 : 5000 / scale)), 1, 100);
}

using Values = std::vector<double>[block][block];  // absolute values by frequency

// Of all frequencies together, by the standard's table: the least quality at whose steps' multiples the values lie; 0:
// none.
int standard_quality(const Values& values) {
  constexpr double most_off = 0.45,
                   uniform_off =
                       1.2;  // grey: rounding leaves .2 to .4; what values without multiples would leave at least
  for (int quality = 5; quality <= 90; ++quality) {
    const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
    std::vector<double> off;
    double uniform = 0;
    for (int j = 0; j < block; ++j)
      for (int k = 0; k < block; ++k) {
        const int step = std::clamp((luminance[j][k] * scale + 50) / 100, 1, 255);
        if (j + k == 0 || step < 4) continue;
        for (const double value : values[j][k])
          if (const int times = int(value / step + 0.5); times >= 1)
            off.push_back(std::abs(value - step * times)), uniform += step / 4.0;
      }
    if (off.size() < least_values || uniform < uniform_off * double(off.size())) continue;
    const auto middle = off.begin() + std::ptrdiff_t(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    if (*middle < most_off) return quality;
  }
  return 0;
}

// By steps that are found frequency by frequency: of a table of its own.
int own_quality(const Values& values) {
  std::vector<double> scales;
  for (int j = 0; j < block; ++j)
    for (int k = 0; k < block; ++k)
      if (const int found = j + k > 0 && j + k < 7 ? step_of(values[j][k]) : 0; found > 0)
        scales.push_back(100.0 * found / luminance[j][k]);
  if (scales.size() < 4) return 0;
  std::sort(scales.begin(), scales.end());
  const double scale = scales[scales.size() / 2];
  // Steps of one table agree; those of an accident do not.
  const auto near =
      std::count_if(scales.begin(), scales.end(), [&](double s) { return std::abs(s - scale) < 0.25 * scale; });
  if (2 * std::size_t(near) < scales.size()) return 0;
  return quality_of_scale(scale);
}

}  // namespace

std::optional<int> jpeg_quality(const std::filesystem::path& file) {
  std::ifstream in = open_regular_file(file);
  std::vector<unsigned char> head(std::size_t(1) << 16);
  in.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
  head.resize(std::size_t(in.gcount()));
  if (head.size() < 4 || head[0] != 0xFF || head[1] != 0xD8) return std::nullopt;
  // Segments: FF, marker, length of what follows with itself (ITU-T T.81, B.1.1.4); DB is a table of steps, 8 bits each
  // as a rule.
  for (std::size_t at = 2; at + 4 <= head.size() && head[at] == 0xFF;) {
    const std::size_t length = std::size_t(head[at + 2]) << 8 | head[at + 3];
    if (head[at + 1] == 0xDB && at + 5 + 64 <= head.size() && head[at + 4] == 0) {
      double given = 0, standard = 0;  // the order of frequencies does not matter to sums
      for (std::size_t k = 0; k < 64; ++k) given += head[at + 5 + k], standard += luminance[k / block][k % block];
      return quality_of_scale(100 * given / standard);
    }
    at += 2 + length;
  }
  return std::nullopt;
}

std::optional<int> jpeg_quality(const ImageView& image) {
  if (image.depth != PixelDepth::u8) return std::nullopt;
  const int across = image.width / block, down = image.height / block;
  if (across < 2 || down < 2) return std::nullopt;
  const std::size_t count = std::size_t(across) * std::size_t(down),
                    step = std::max<std::size_t>(1, count / most_blocks);
  // Blocks of black and white pixels only where there are no others.
  Values values;
  for (const bool all : {false, true}) {
    for (std::size_t b = 0; b < count; b += step) {
      const int left = block * int(b % std::size_t(across)), top = block * int(b / std::size_t(across));
      if (!all && clipped(image, left, top)) continue;
      const Block at = transformed(image, left, top);
      for (int j = 0; j < block; ++j)
        for (int k = 0; k < block; ++k) values[j][k].push_back(std::abs(at[std::size_t(j)][std::size_t(k)]));
    }
    if (values[0][0].size() >= least_blocks) break;
    for (auto& row : values)
      for (std::vector<double>& held : row) held.clear();
  }
  if (const int quality = standard_quality(values); quality > 0) return quality;
  if (const int quality = own_quality(values); quality > 0) return quality;
  return std::nullopt;
}

}  // namespace pivnp::image

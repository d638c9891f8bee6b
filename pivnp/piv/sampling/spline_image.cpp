#include "pivnp/piv/sampling/spline_image.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "pivnp/piv/sampling/prefilter.hpp"

namespace pivnp::piv {

namespace {

// Means of blocks of pixels that may all be used: rows first, side by side, then along them.
template <class Grey>
void average_plain(const ImageView& image, int decimation, int row, int width, float* out) {
  constexpr int most = 512;  // columns at a time
  assert(decimation <= most);
  std::array<float, most> sums;
  const int blocks = most / decimation;
  const float share = 1 / static_cast<float>(decimation * decimation);
  for (int first = 0; first < width; first += blocks) {
    const int end = std::min(first + blocks, width), columns = (end - first) * decimation;
    for (int dr = 0; dr < decimation; ++dr) {
      const Grey* in = image.row<Grey>(row * decimation + dr) + std::ptrdiff_t(first) * decimation;
      if (dr == 0)
        for (int k = 0; k < columns; ++k) sums[std::size_t(k)] = static_cast<float>(in[k]);
      else
        for (int k = 0; k < columns; ++k) sums[std::size_t(k)] += static_cast<float>(in[k]);
    }
    for (int c = first; c < end; ++c) {
      const float* block = sums.data() + (c - first) * decimation;
      float sum = 0;
      for (int k = 0; k < decimation; ++k) sum += block[k];
      out[c] = share * sum;
    }
  }
}

// Sum of the usable pixels of one block.
template <class Grey>
float usable_sum(const ImageView& image, const MaskView& mask, int decimation, int row, int column) {
  float sum = 0;
  for (int dr = 0; dr < decimation; ++dr) {
    const int r = row * decimation + dr;
    const Grey* in = image.row<Grey>(r) + column * decimation;
    for (int dc = 0; dc < decimation; ++dc)
      sum += mask.usable(column * decimation + dc, r) ? static_cast<float>(in[dc]) : 0.0f;
  }
  return sum;
}

template <class Grey>
void average_row(const ImageView& image, const MaskView& mask, int decimation, int row, int width, float* out) {
  if (decimation == 1) {
    const Grey* in = image.row<Grey>(row);
    for (int c = 0; c < width; ++c) out[c] = static_cast<float>(in[c]);
    return;
  }
  average_plain<Grey>(image, decimation, row, width, out);
  if (mask.data == nullptr) return;
  constexpr int most = 512;  // columns at a time
  std::array<std::uint16_t, most> usable_rows;
  const int blocks = most / decimation;
  for (int first = 0; first < width; first += blocks) {
    const int end = std::min(first + blocks, width), columns = (end - first) * decimation;
    std::fill_n(usable_rows.begin(), columns, std::uint16_t{0});
    for (int dr = 0; dr < decimation; ++dr) {
      const std::uint8_t* in =
          mask.data + std::ptrdiff_t(row * decimation + dr) * mask.stride + std::ptrdiff_t(first) * decimation;
      for (int k = 0; k < columns; ++k) usable_rows[std::size_t(k)] += in[k] != 0;
    }
    for (int c = first; c < end; ++c) {
      int usable = 0;
      for (int k = 0; k < decimation; ++k) usable += usable_rows[std::size_t((c - first) * decimation + k)];
      if (usable > 0 && usable < decimation * decimation)
        out[c] = usable_sum<Grey>(image, mask, decimation, row, c) / static_cast<float>(usable);
    }
  }
}

// Averages of 4 x 4 pixels by (1, 3, 3, 1)/8 along each axis, at the places of the means of 2 x 2. Of waves of three pixels and
// less, whose aliases are long waves that move the wrong way, they let through the cube of what those do. The image's own edge
// is repeated; beside a pixel that may not be used the block's own usable ones are averaged.
template <class Grey>
void average_overlapping(const ImageView& image, const MaskView& mask, int row, int width, float* out) {
  constexpr int most = 256;  // averages at a time
  std::array<float, 2 * most + 2> sums;
  std::array<int, 4> rows;
  for (int k = 0; k < 4; ++k) rows[std::size_t(k)] = std::clamp(2 * row - 1 + k, 0, image.height - 1);
  const Grey *a = image.row<Grey>(rows[0]), *b = image.row<Grey>(rows[1]), *c = image.row<Grey>(rows[2]), *d = image.row<Grey>(rows[3]);
  const auto along = [&](int x) {
    return (static_cast<float>(a[x]) + static_cast<float>(d[x])) + 3 * (static_cast<float>(b[x]) + static_cast<float>(c[x]));
  };
  for (int first = 0; first < width; first += most) {
    const int end = std::min(first + most, width), left = 2 * first - 1, columns = 2 * (end - first) + 2;
    const int inner = std::min(columns, image.width - left);
    for (int k = first == 0 ? 1 : 0; k < inner; ++k) sums[std::size_t(k)] = along(left + k);
    if (first == 0) sums[0] = sums[1];
    for (int k = inner; k < columns; ++k) sums[std::size_t(k)] = sums[std::size_t(inner - 1)];
    for (int x = first; x < end; ++x) {
      const float* s = sums.data() + 2 * (x - first);
      out[x] = (1 / 64.0f) * ((s[0] + s[3]) + 3 * (s[1] + s[2]));
    }
  }
  if (mask.data == nullptr) return;
  for (int x = 0; x < width; ++x) {
    int usable = 0, around = 0;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 4; ++i) {
        const bool may = mask.usable(std::clamp(2 * x - 1 + i, 0, image.width - 1), rows[std::size_t(k)]);
        around += may;
        usable += may && (k == 1 || k == 2) && (i == 1 || i == 2);
      }
    if (around < 16 && usable > 0) out[x] = usable_sum<Grey>(image, mask, 2, row, x) / static_cast<float>(usable);
  }
}

}  // namespace

void SplineImage::assign(const ImageView& image, const MaskView& mask, int decimation, int threads, float smoothing) {
  assert(decimation >= 1 && image.width >= decimation && image.height >= decimation);
  width_ = image.width / decimation;
  height_ = image.height / decimation;
  stride_ = (width_ + 2 * padding + 15) / 16 * 16;
  data_.resize(std::size_t(stride_) * std::size_t(height_ + 2 * padding));
  average(image, mask, decimation, smoothing > 0, threads);
  prefilter(threads, smoothing);
  mirror_edges();
}

void SplineImage::average(const ImageView& image, const MaskView& mask, int decimation, bool overlapping, int threads) {
  const auto rows = [&]<class Grey>(Grey) {
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int r = 0; r < height_; ++r) {
      if (overlapping && decimation == 2)
        average_overlapping<Grey>(image, mask, r, width_, pixel(0, r));
      else
        average_row<Grey>(image, mask, decimation, r, width_, pixel(0, r));
    }
  };
  if (image.depth == PixelDepth::u8) return rows(std::uint8_t{});
  if (image.depth == PixelDepth::u16) return rows(std::uint16_t{});
  rows(0.0f);
}

// The padding right of the image and below it is written too; mirroring fills it afterwards.
void SplineImage::prefilter(int threads, float smoothing) {
  constexpr int column_lanes = 4 * prefilter_lanes, row_lanes = 2 * prefilter_lanes;
  const int columns = (width_ + prefilter_lanes - 1) / prefilter_lanes * prefilter_lanes;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int c = 0; c < columns; c += column_lanes)
    prefilter_lines(pixel(c, 0), height_, stride_, std::min(column_lanes, columns - c), smoothing);

#pragma omp parallel num_threads(threads)
  {
    std::vector<float> lines(std::size_t(width_ + 3) * row_lanes);  // transposed, so that rows advance together
#pragma omp for schedule(static)
    for (int r = 0; r < height_; r += row_lanes) {
      const int rows = std::min(row_lanes, height_ - r);
      transpose_rows(pixel(0, r), stride_, rows, width_, row_lanes, lines.data());
      prefilter_lines(lines.data(), width_, row_lanes, row_lanes, smoothing);
      transpose_back(lines.data(), row_lanes, rows, width_, stride_, pixel(0, r));
    }
  }
}

void SplineImage::mirror_edges() {
  const auto mirrored = [](int k, int n) {
    if (n == 1) return 0;
    const int period = 2 * (n - 1);
    k = ((k % period) + period) % period;
    return k < n ? k : period - k;
  };
  for (int r = 0; r < height_; ++r)
    for (int p = 1; p <= padding; ++p) {
      *pixel(-p, r) = *pixel(mirrored(-p, width_), r);
      *pixel(width_ - 1 + p, r) = *pixel(mirrored(width_ - 1 + p, width_), r);
    }
  for (int p = 1; p <= padding; ++p) {
    const auto copy_row = [&](int to) {
      const float* from = pixel(-padding, mirrored(to, height_));
      std::copy(from, from + width_ + 2 * padding, pixel(-padding, to));
    };
    copy_row(-p);
    copy_row(height_ - 1 + p);
  }
}

}  // namespace pivnp::piv

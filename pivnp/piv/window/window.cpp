#include "pivnp/piv/window/window.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::piv {

Window::Window(int side_px)
    : side(side_px),
      stride(std::max(padded_columns(side_px), padded_columns(side_px + 2 * near_lags))),
      axis_x_(std::size_t(padded_columns(side_px))),
      axis_y_(std::size_t(padded_columns(side_px))) {
  const std::size_t size = std::size_t(stride) * std::size_t(side + 2 * near_lags) + 32;  // loops reach beyond the end
  a.assign(size, 0.0f);
  b.assign(size, 0.0f);
  weight.assign(size, 0.0f);
}

void Window::cut(const WarpedPair& pair, float column, float row, bool weights) {
  const float half = 0.5f * static_cast<float>(side);
  const int x0 = static_cast<int>(std::ceil(column - half)), y0 = static_cast<int>(std::ceil(row - half));
  const float whole = taper_weights(static_cast<float>(x0) - column, side, axis_x_.data()) *
                      taper_weights(static_cast<float>(y0) - row, side, axis_y_.data());
  // Columns and rows that the box has.
  const auto clip = [&](int from, int first, int end, int& begin, int& stop) {
    begin = std::clamp(first - from, 0, side), stop = std::clamp(end - from, begin, side);
  };
  int left = 0, right = 0;
  WindowCut in{};
  clip(x0, pair.box.x0, pair.box.x1, left, right);
  clip(y0, pair.box.y0, pair.box.y1, in.first_row, in.end_row);
  if (left == right) in.end_row = in.first_row;
  std::fill_n(axis_x_.begin(), left, 0.0f);
  std::fill(axis_x_.begin() + right, axis_x_.end(), 0.0f);
  const std::ptrdiff_t at = (y0 - pair.box.y0) * pair.stride + (x0 - pair.box.x0) + pair.padding;
  const auto source = [&](const std::vector<float>& plane) { return plane.empty() ? nullptr : plane.data() + at; };
  in.f = source(pair.f), in.g = source(pair.g), in.use = source(pair.use), in.masked = source(pair.masked);
  in.source_stride = pair.stride;
  in.wx = axis_x_.data(), in.wy = axis_y_.data();
  in.side = side, in.stride = stride;
  in.a = a.data() + index(0, 0), in.b = b.data() + index(0, 0);
  in.weight = weights ? weight.data() + index(0, 0) : nullptr;
  in.whole = right - left == side && in.end_row - in.first_row == side && pair.whole(x0, y0, x0 + side, y0 + side);
  in.whole_weight = whole;
  const CutSums sums = cut_window(in);
  usable = whole > 0 ? sums.weight / whole : 0.0f;
  masked = whole > 0 ? sums.masked / whole : 0.0f;
  outside = std::max(0.0f, 1 - usable - masked);
  energy_a = sums.energy_a, energy_b = sums.energy_b;
  variance_f = sums.weight > 0 ? energy_a / sums.weight : 0.0f;
  variance_g = sums.weight > 0 ? energy_b / sums.weight : 0.0f;
}

int support_of_window(int window_px) { return 2 * static_cast<int>(std::lround(0.6 * window_px)); }

std::vector<float> taper_correlation(int side, int count) {
  std::vector<float> w(static_cast<std::size_t>(padded_columns(side)));
  taper_weights(-0.5f * static_cast<float>(side - 1), side, w.data());
  std::vector<float> share(static_cast<std::size_t>(count));
  double whole = 0;
  for (int lag = 0; lag < count; ++lag) {
    double sum = 0;
    for (int k = 0; k + lag < side; ++k) sum += double(w[std::size_t(k)]) * double(w[std::size_t(k + lag)]);
    if (lag == 0) whole = sum;
    share[std::size_t(lag)] = static_cast<float>(sum / whole);
  }
  return share;
}

}  // namespace pivnp::piv

#include "apps/study/methods/frames/repeated_cause.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr int half = 12;  // px
constexpr std::size_t most_windows = 600;

float grey_at(const Image& image, int column, int row) {
  const ImageView view = image.view();
  switch (view.depth) {
    case PixelDepth::u8: return view.row<std::uint8_t>(row)[column];
    case PixelDepth::u16: return view.row<std::uint16_t>(row)[column];
    case PixelDepth::f32: return view.row<float>(row)[column];
  }
  return 0;
}

// Freed of a plane each: light that falls off, and follows no one, is no texture.
double correlation(const Image& a, const Image& b, int column, int row) {
  double ab = 0, aa = 0, bb = 0, sum_a = 0, sum_b = 0, ax = 0, ay = 0, bx = 0, by = 0, xx = 0, n = 0;
  for (int y = -half; y <= half; ++y)
    for (int x = -half; x <= half; ++x) {
      const double p = double(grey_at(a, column + x, row + y)), q = double(grey_at(b, column + x, row + y));
      ab += p * q, aa += p * p, bb += q * q, sum_a += p, sum_b += q;
      ax += p * x, ay += p * y, bx += q * x, by += q * y, xx += double(x) * x, ++n;
    }
  ab -= sum_a * sum_b / n + (ax * bx + ay * by) / xx;
  aa -= sum_a * sum_a / n + (ax * ax + ay * ay) / xx;
  bb -= sum_b * sum_b / n + (bx * bx + by * by) / xx;
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace

StillPicture still_picture(const Image& first, const Image& second, const std::vector<Vec2>& places) {
  StillPicture out;
  double sum = 0, square = 0;
  const std::size_t stride = places.size() / most_windows + 1;
  for (std::size_t k = 0; k < places.size(); k += stride) {
    const int column = int(std::lround(places[k].x())), row = int(std::lround(places[k].y()));
    if (column < half || row < half || column + half >= first.width() || row + half >= first.height()) continue;
    const double c = correlation(first, second, column, row);
    sum += c, square += c * c, ++out.windows;
  }
  if (out.windows < 2) return out;
  out.correlation = sum / out.windows;
  // Windows a few nodes apart overlap: about four of them make one independent one.
  out.error = 2 * std::sqrt(std::max(0.0, square / out.windows - out.correlation * out.correlation) / out.windows);
  return out;
}

std::vector<Vec2> amid_motion(const Setting& setting, int frame, const std::vector<double>& moved_px, double least_px) {
  constexpr double surroundings_px = 48;  // a window of 25 px, and as far as vectors see across a boundary
  const Grid& grid = setting.grid;
  const int reach = int(std::ceil(surroundings_px / node_spacing_px(setting)));
  std::vector<Vec2> out;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      if (!(moved_px[grid.node(i, j)] >= least_px)) continue;
      int moving = 0, resting = 0, unknown = 0;
      for (int b = std::max(0, j - reach); b <= std::min(grid.ny - 1, j + reach); ++b)
        for (int a = std::max(0, i - reach); a <= std::min(grid.nx - 1, i + reach); ++a) {
          const double moved = moved_px[grid.node(a, b)];
          ++(!std::isfinite(moved) ? unknown : moved >= least_px ? moving : resting);
        }
      if (resting == 0 && moving >= unknown) out.push_back(setting.camera_at(frame).to_pixel(grid.position(i, j)));
    }
  return out;
}

Bent bent_share(const std::vector<std::array<float, 3>>& repeated, const VectorField& field, int steps, double pixel) {
  const Grid& grid = field.grid;
  double all = 0, bent = 0, nodes = 0, known = 0;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const std::size_t n = grid.node(i, j);
      const double variance = double(repeated[n][0]) + double(repeated[n][1]);
      double most = 0;
      const auto look = [&](std::size_t before, std::size_t after) {
        for (const std::size_t q : {before, n, after})
          if (field.status[q] != VectorStatus::valid) return;
        for (std::size_t c = 0; c < 2; ++c)
          most = std::max(most, std::abs(double(field.displacement[before][c]) - 2 * double(field.displacement[n][c]) +
                                         double(field.displacement[after][c])));
      };
      if (i > 0 && i + 1 < grid.nx) look(grid.node(i - 1, j), grid.node(i + 1, j));
      if (j > 0 && j + 1 < grid.ny) look(grid.node(i, j - 1), grid.node(i, j + 1));
      const bool bends = most > 0.1 * pixel * steps;
      if (!std::isfinite(variance)) continue;
      all += variance, ++known;
      if (bends) bent += variance, ++nodes;
    }
  return all > 0 ? Bent{bent / all, nodes / known} : Bent{};
}

std::string repeated_cause(const StillPicture& still, const Bent& bent) {
  std::string text;
  if (still.seen())
    text = "a part of the picture stands still while the material moves (light, dirt, reflections: frames that far apart correlate by " +
           number(still.correlation, 2) + " at the same pixels)";
  if (bent.seen())
    text += (text.empty() ? "" : "; and ") + number(100 * bent.variance, 2) + " % of it lies in the " + number(100 * bent.nodes, 2) +
            " % of the nodes where the motion bends within a window, as in a shear band";
  return text;
}

}  // namespace pivnp::app

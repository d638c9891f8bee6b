#include "pivnp/image/masks/raster.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::image {

namespace {

// A boundary that passes through a pixel's centre takes the pixel in, whatever the crossing's last bit.
constexpr double tolerance_px = 1e-9;

void add_run(double from, double to, int width, std::vector<Run>& runs) {
  const double first = std::max(0.0, std::ceil(from - tolerance_px));
  const double last = std::min(double(width - 1), std::floor(to + tolerance_px));
  if (first <= last) runs.push_back({int(first), int(last)});
}

// Where the sides cut the line just above (`upper`) or just below y = row, taken at the row itself. In between pairs of
// cuts lies the inside; both limits together are the closed polygon, vertices and level sides included.
void add_limit(const std::vector<Vec2>& v, double row, bool upper, int width, std::vector<double>& cuts,
               std::vector<Run>& runs) {
  cuts.clear();
  for (std::size_t k = 0; k < v.size(); ++k) {
    const Vec2* a = &v[k];
    const Vec2* b = &v[k + 1 < v.size() ? k + 1 : 0];
    if (a->y() > b->y()) std::swap(a, b);
    const bool cut = upper ? a->y() < row && row <= b->y() : a->y() <= row && row < b->y();
    if (cut) cuts.push_back(a->x() + (row - a->y()) / (b->y() - a->y()) * (b->x() - a->x()));
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t k = 0; k + 1 < cuts.size(); k += 2) add_run(cuts[k], cuts[k + 1], width, runs);
}

}  // namespace

void polygon_runs(const std::vector<Vec2>& vertices_px, int row, int width, std::vector<Run>& runs) {
  runs.clear();
  thread_local std::vector<double> cuts;
  add_limit(vertices_px, row, true, width, cuts, runs);
  add_limit(vertices_px, row, false, width, cuts, runs);
}

void circle_runs(const Vec2& centre_px, double radius_px, int row, int width, std::vector<Run>& runs) {
  runs.clear();
  const double rise = row - centre_px.y();
  const double square = radius_px * radius_px - rise * rise;
  if (square < 0) return;
  const double half = std::sqrt(square);
  add_run(centre_px.x() - half, centre_px.x() + half, width, runs);
}

}  // namespace pivnp::image

#include "compare/shapes/slope.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compare/data/statistics.hpp"

namespace pivnp::compare {

namespace {

constexpr double thin_share = 0.02;  // of the area: the thin end

// Place below which `share` of the sum lies; values sit in bins of one width, spread evenly over each.
double place_of_share(const std::vector<double>& bins, double share) {
  double total = 0, sum = 0;
  for (double b : bins) total += b;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (sum + bins[k] >= share * total && bins[k] > 0) return double(k) + (share * total - sum) / bins[k];
    sum += bins[k];
  }
  return double(bins.size());
}

// Columns of the descent on one side: from the last one above 90 % outwards to the last one of at least 10 %.
struct Descent {
  std::ptrdiff_t from = 0, to = 0;  // from the crest outwards
  std::ptrdiff_t columns() const { return std::abs(to - from); }
};

Descent descent(const std::vector<double>& h, double height, int side) {
  const std::ptrdiff_t n = std::ptrdiff_t(h.size());
  const std::ptrdiff_t outer = side > 0 ? n - 1 : 0;
  std::ptrdiff_t high = outer, low = outer;
  while (high >= 0 && high < n && h[std::size_t(high)] < 0.9 * height) high -= side;
  while (low >= 0 && low < n && h[std::size_t(low)] < 0.1 * height) low -= side;
  return {high, low};
}

}  // namespace

Profile profile_above(const Cover& cover, double base_y) {
  const Lattice& l = cover.lattice;
  Profile profile{l.first.x(), l.cell, std::vector<double>(std::size_t(l.nx), 0.0)};
  for (int j = 0; j < l.ny; ++j) {
    if (l.centre(0, j).y() < base_y) continue;
    for (int i = 0; i < l.nx; ++i) profile.height[std::size_t(i)] += cover.share(l.index(i, j)) * l.cell;
  }
  return profile;
}

void fit_slope(const Profile& profile, double crest_height, double spacing, SlopeShape& shape) {
  const std::vector<double>& h = profile.height;
  // An overhang's voids can leave every column below the crest.
  const double height = std::min(crest_height, *std::max_element(h.begin(), h.end()));
  const Descent right = descent(h, height, 1), left = descent(h, height, -1);
  shape.faces = right.columns() >= left.columns() ? 1 : -1;
  shape.angle_deg = shape.angle_uncertainty_deg = shape.face_length = not_known;
  const Descent& d = shape.faces > 0 ? right : left;
  const double n = double(d.columns());
  if (n < 4) return;

  // Columns after `from` up to and with `to`.
  double mean_x = 0, mean_h = 0, xx = 0, xh = 0, hh = 0;
  auto each = [&](auto&& use) {
    for (std::ptrdiff_t k = d.from + shape.faces;; k += shape.faces) {
      use(profile.x(std::size_t(k)), h[std::size_t(k)]);
      if (k == d.to) break;
    }
  };
  each([&](double x, double y) {
    mean_x += x / n;
    mean_h += y / n;
  });
  each([&](double x, double y) {
    xx += (x - mean_x) * (x - mean_x);
    xh += (x - mean_x) * (y - mean_h);
    hh += (y - mean_h) * (y - mean_h);
  });
  const double gradient = xh / xx;
  shape.angle_deg = std::atan(std::abs(gradient)) * 180 / std::numbers::pi;
  shape.face_length = n * profile.width * std::hypot(1.0, gradient);

  // Neighbouring columns see the same particles: one independent value a spacing.
  const double independent = n * std::min(1.0, profile.width / spacing);
  if (independent <= 2) return;
  const double residual = std::max(0.0, hh - gradient * xh) / n * independent / (independent - 2);
  const double gradient_error = std::sqrt(residual / (xx / n * independent));
  shape.angle_uncertainty_deg = gradient_error / (1 + gradient * gradient) * 180 / std::numbers::pi;
}

SlopeShape slope_shape(const Cover& cover, double base_y, double spacing) {
  SlopeShape shape{0, not_known, not_known, not_known, not_known, not_known, not_known, 0};
  const Lattice& l = cover.lattice;
  const Profile profile = profile_above(cover, base_y);
  std::vector<double> rows(std::size_t(l.ny), 0.0);
  double area = 0;
  for (int j = 0; j < l.ny; ++j) {
    if (l.centre(0, j).y() < base_y) continue;
    for (int i = 0; i < l.nx; ++i) rows[std::size_t(j)] += cover.share(l.index(i, j));
    area += rows[std::size_t(j)];
  }
  if (!(area > 0)) return shape;

  const double lowest = l.first.y() - l.cell / 2, leftmost = l.first.x() - l.cell / 2;
  shape.crest_height = lowest + l.cell * place_of_share(rows, run_out_share) - base_y;
  fit_slope(profile, shape.crest_height, spacing, shape);
  const auto within = [&](double share) {
    return leftmost + l.cell * place_of_share(profile.height, shape.faces > 0 ? share : 1 - share);
  };
  shape.run_out_x = within(run_out_share);
  // Of a wedge of that angle, the part beyond which a share f of the area lies is sqrt(2 f area cot) long.
  shape.thin_from = within(1 - thin_share);
  const double apart = (shape.run_out_x - shape.thin_from) / (std::sqrt(thin_share) - std::sqrt(1 - run_out_share));
  shape.thinness = apart * apart / (2 * area * l.cell * l.cell);
  return shape;
}

}  // namespace pivnp::compare

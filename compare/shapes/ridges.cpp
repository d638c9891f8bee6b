#include "compare/shapes/ridges.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "compare/data/statistics.hpp"
#include "compare/data/triangulation.hpp"
#include "compare/shapes/outline.hpp"

namespace pivnp::compare {

namespace {

// The field on a lattice, NaN outside the material.
struct Raster {
  Lattice lattice;
  std::vector<double> value;

  double at(int i, int j) const {
    if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) return not_known;
    return value[lattice.index(i, j)];
  }
  // Bilinear; NaN beside the outside.
  double sample(const Vec2& x) const {
    const Vec2 t = (x - lattice.first) / lattice.cell;
    const int i = int(std::floor(t.x())), j = int(std::floor(t.y()));
    const double a = t.x() - i, b = t.y() - j;
    return (1 - a) * (1 - b) * at(i, j) + a * (1 - b) * at(i + 1, j) + (1 - a) * b * at(i, j + 1) +
           a * b * at(i + 1, j + 1);
  }
};

Raster rasterise(const MaterialMesh& mesh, const std::vector<double>& value, double cell) {
  Raster r{lattice_around(mesh, mesh, cell, cell, std::nullopt), {}};
  r.value.assign(std::size_t(r.lattice.nx) * std::size_t(r.lattice.ny), not_known);
  for (int j = 0; j < r.lattice.ny; ++j)
    for (int i = 0; i < r.lattice.nx; ++i) {
      const auto place = mesh.find(r.lattice.centre(i, j));
      if (!place) continue;
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        if (place->vertex[k] >= 0) sum += place->weight[k] * value[std::size_t(place->vertex[k])];
      r.value[r.lattice.index(i, j)] = sum;
    }
  return r;
}

// Gaussian of `sigma` cells over what is known, row by row and column by column.
Raster smoothed(const Raster& raw, double sigma) {
  const int reach = int(std::ceil(3 * sigma));
  std::vector<double> weight;
  for (int d = 0; d <= reach; ++d) weight.push_back(std::exp(-0.5 * d * d / (sigma * sigma)));
  Raster out = raw;
  for (const bool rows : {true, false}) {
    const Raster from = out;
    for (int j = 0; j < raw.lattice.ny; ++j)
      for (int i = 0; i < raw.lattice.nx; ++i) {
        if (std::isnan(raw.at(i, j))) continue;
        double sum = 0, total = 0;
        for (int d = -reach; d <= reach; ++d) {
          const double v = rows ? from.at(i + d, j) : from.at(i, j + d);
          if (std::isnan(v)) continue;
          sum += weight[std::size_t(std::abs(d))] * v;
          total += weight[std::size_t(std::abs(d))];
        }
        out.value[out.lattice.index(i, j)] = sum / total;
      }
  }
  return out;
}

struct RidgePoint {
  int i = 0, j = 0;
  Vec2 x = Vec2::Zero(), normal = Vec2::Zero();  // across the ridge
  double value = 0;
};

std::optional<RidgePoint> ridge_point(const Raster& f, int i, int j, double threshold, double spacing) {
  const double c = f.at(i, j);
  if (!(c >= 0.5 * threshold)) return std::nullopt;
  const double l = f.at(i - 1, j), r = f.at(i + 1, j), d = f.at(i, j - 1), u = f.at(i, j + 1);
  const double cross = f.at(i + 1, j + 1) - f.at(i - 1, j + 1) - f.at(i + 1, j - 1) + f.at(i - 1, j - 1);
  if (!std::isfinite(l + r + d + u + cross)) return std::nullopt;
  const Vec2 g((r - l) / 2, (u - d) / 2);
  Mat2 H;
  H << r - 2 * c + l, cross / 4, cross / 4, u - 2 * c + d;
  const Eigen::SelfAdjointEigenSolver<Mat2> solver(H);  // ascending
  const double curvature = solver.eigenvalues()[0];
  if (!(curvature < 0) || std::abs(solver.eigenvalues()[1]) > std::abs(curvature)) return std::nullopt;
  const Vec2 n = solver.eigenvectors().col(0);
  const Vec2 step = -(g.dot(n) / curvature) * n;  // cells
  if (step.cwiseAbs().maxCoeff() > 0.6) return std::nullopt;
  const double reach = 2 * spacing / f.lattice.cell;
  const double top = c + 0.5 * g.dot(step);
  if (-0.5 * curvature * reach * reach < 0.1 * top) return std::nullopt;
  return RidgePoint{i, j, f.lattice.centre(i, j) + f.lattice.cell * step, n, top};
}

// Width at half height across the ridge, above the lower of both feet within eight spacings.
double width_across(const Raster& raw, const RidgePoint& p, double spacing) {
  const double step = raw.lattice.cell / 4;
  const int reach = int(8 * spacing / step);
  const double top = raw.sample(p.x);
  std::array<double, 2> foot{top, top};
  for (int side = 0; side < 2; ++side)
    for (int k = 1; k <= reach; ++k) {
      const double v = raw.sample(p.x + (side ? 1 : -1) * k * step * p.normal);
      if (!std::isfinite(v)) break;
      foot[std::size_t(side)] = std::min(foot[std::size_t(side)], v);
    }
  const double half = (top + std::min(foot[0], foot[1])) / 2;
  double width = 0;
  for (int side = 0; side < 2; ++side) {
    double before = top;
    int k = 1;
    for (; k <= reach; ++k) {
      const double v = raw.sample(p.x + (side ? 1 : -1) * k * step * p.normal);
      if (!std::isfinite(v)) return not_known;
      if (v <= half) {
        width += step * (k - 1 + (before > v ? (before - half) / (before - v) : 0));
        break;
      }
      before = v;
    }
    if (k > reach) return not_known;
  }
  return width;
}

// Integral of the strain across the ridge; NaN where the material ends first on either side.
double strain_across(const Raster& raw, const RidgePoint& p, double spacing) {
  const double step = raw.lattice.cell / 2;
  const double top = raw.sample(p.x);
  if (!(top > 0)) return not_known;
  const int reach = int(12 * spacing / step);
  double sum = 0;
  for (const bool side : {false, true}) {
    double before = top;
    for (int k = 1; k <= reach; ++k) {
      const double v = raw.sample(p.x + (side ? 1 : -1) * k * step * p.normal);
      if (!std::isfinite(v)) return not_known;
      if (v < 0.1 * top || v > 1.05 * before) break;
      sum += step * (before + v) / 2;
      before = v;
    }
  }
  return sum;
}

double median(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return not_known;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Connected ridge points of similar direction.
std::vector<std::vector<RidgePoint>> groups_of(const std::vector<RidgePoint>& points, const Lattice& lattice) {
  std::vector<int> at(std::size_t(lattice.nx) * std::size_t(lattice.ny), -1);
  for (std::size_t k = 0; k < points.size(); ++k) at[lattice.index(points[k].i, points[k].j)] = int(k);
  std::vector<char> taken(points.size(), 0);
  std::vector<std::vector<RidgePoint>> groups;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (taken[k]) continue;
    std::vector<std::size_t> todo{k};
    taken[k] = 1;
    groups.emplace_back();
    while (!todo.empty()) {
      const RidgePoint& p = points[todo.back()];
      todo.pop_back();
      groups.back().push_back(p);
      for (int dj = -2; dj <= 2; ++dj)
        for (int di = -2; di <= 2; ++di) {
          const int i = p.i + di, j = p.j + dj;
          if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) continue;
          const int q = at[lattice.index(i, j)];
          if (q < 0 || taken[std::size_t(q)] || std::abs(points[std::size_t(q)].normal.dot(p.normal)) < 0.8) continue;
          taken[std::size_t(q)] = 1;
          todo.push_back(std::size_t(q));
        }
    }
  }
  return groups;
}

// What its places amount to.
void sum_up(ShearBand& band) {
  band.centre = Vec2::Zero();
  for (const Vec2& x : band.ridge) band.centre += x / double(band.ridge.size());
  Mat2 spread = Mat2::Zero();
  for (const Vec2& x : band.ridge) spread += (x - band.centre) * (x - band.centre).transpose();
  const Vec2 along = Eigen::SelfAdjointEigenSolver<Mat2>(spread).eigenvectors().col(1);
  double least = 0, most = 0;
  for (const Vec2& x : band.ridge) {
    const double s = (x - band.centre).dot(along);
    least = std::min(least, s);
    most = std::max(most, s);
  }
  band.length = most - least;
  band.inclination_deg = std::atan2(along.y(), along.x()) * 180 / std::numbers::pi;
  if (band.inclination_deg > 90) band.inclination_deg -= 180;
  if (band.inclination_deg <= -90) band.inclination_deg += 180;
  const auto median_of = [&](double ShearBand::Place::*value) {
    std::vector<double> values;
    for (const ShearBand::Place& place : band.places) values.push_back(place.*value);
    return median(std::move(values));
  };
  band.thickness = median_of(&ShearBand::Place::width);
  band.peak = median_of(&ShearBand::Place::strain);
  band.slip = std::sqrt(3.0) * median_of(&ShearBand::Place::slip);
  band.rate = median_of(&ShearBand::Place::rate);
  // Half of all its particles: those that never reached the threshold come last.
  std::vector<double> begin;
  for (const ShearBand::Place& place : band.places)
    if (!std::isnan(place.onset)) begin.push_back(place.onset);
  std::sort(begin.begin(), begin.end());
  band.onset = begin.empty() ? not_known : begin[(begin.size() - 1) / 2];
  if (std::isinf(band.onset)) band.onset = not_known;
}

ShearBand band_of(const std::vector<RidgePoint>& points, const Raster& raw, const MaterialMesh& mesh,
                  const ScatteredField& field, double spacing) {
  ShearBand band;
  for (const RidgePoint& p : points) {
    band.ridge.push_back(p.x);
    const double here = raw.sample(p.x);
    band.strain = std::max(band.strain, std::isfinite(here) ? here : p.value);
    ShearBand::Place at{width_across(raw, p, spacing), here, strain_across(raw, p, spacing), not_known, not_known};
    if (const auto place = mesh.find(p.x)) {
      const auto k = std::size_t(std::max_element(place->weight.begin(), place->weight.end()) - place->weight.begin());
      const auto particle = std::size_t(place->vertex[k]);
      at.onset = std::isnan(field.onset[particle]) ? std::numeric_limits<double>::infinity() : field.onset[particle];
      if (!field.rate.empty()) at.rate = field.rate[particle];
    }
    band.places.push_back(at);
  }
  sum_up(band);
  return band;
}

}  // namespace

ShearBand ShearBand::between(const Vec2& origin, const Vec2& direction, double from, double to) const {
  ShearBand part;
  part.strain = strain;
  for (std::size_t k = 0; k < ridge.size(); ++k) {
    const double s = (ridge[k] - origin).dot(direction);
    if (s < from || s > to) continue;
    part.ridge.push_back(ridge[k]);
    part.places.push_back(places[k]);
  }
  if (!part.ridge.empty()) sum_up(part);
  return part;
}

std::vector<ShearBand> find_bands(const ScatteredField& field, double spacing, double threshold) {
  if (field.x.size() < 3) return {};
  const MaterialMesh mesh(field.x, field.spacing);
  if (mesh.triangles().empty()) return {};
  const Raster raw = rasterise(mesh, field.value, spacing / 2);
  const Raster soft = smoothed(raw, spacing / raw.lattice.cell);
  std::vector<RidgePoint> points;
  for (int j = 1; j + 1 < raw.lattice.ny; ++j)
    for (int i = 1; i + 1 < raw.lattice.nx; ++i) {
      const auto p = ridge_point(soft, i, j, threshold, spacing);
      if (p && raw.sample(p->x) >= threshold) points.push_back(*p);
    }
  std::vector<ShearBand> bands;
  for (const auto& group : groups_of(points, raw.lattice)) {
    ShearBand band = band_of(group, raw, mesh, field, spacing);
    if (band.length >= 4 * spacing) bands.push_back(std::move(band));
  }
  std::stable_sort(bands.begin(), bands.end(), [](const ShearBand& a, const ShearBand& b) {
    return a.length * a.strain > b.length * b.strain;
  });
  return bands;
}

}  // namespace pivnp::compare

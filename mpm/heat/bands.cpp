#include "mpm/heat/bands.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

namespace {

constexpr double least_excess = 1.01;  // of a zone's width over its band's: what is narrower has no deviation that matters
constexpr double most_spread = 0.6;    // of what a zone swells by
constexpr std::size_t N = ShearBand::volumes, P = ShearBand::pressures, outside = N - ShearBand::inside;
using Row = std::array<double, N>;
using Wide = std::array<double, P>;

// The volume at the band's edge, on both sides; inside each is twice the one further out.
double edge_volume(double thickness) { return 0.5 * thickness / double((1 << ShearBand::inside) - 1); }

double sum_outside(double growth) {
  double sum = 0, term = 1;
  for (std::size_t k = 0; k < outside; ++k, term *= growth) sum += term;
  return sum;
}

template <class Values>
void keep_mean_zero(Values& of, const Values& volume) {
  double sum = 0, all = 0;
  for (std::size_t k = 0; k < of.size(); ++k) sum += of[k] * volume[k], all += volume[k];
  for (double& value : of) value -= sum / all;
}

// Between neighbouring volumes, in a step.
template <class Values>
Values passing(const Values& volume, double conductance, double dt) {
  Values off{};
  for (std::size_t k = 0; k + 1 < off.size() && volume[k + 1] > 0; ++k) off[k] = dt * conductance / (0.5 * (volume[k] + volume[k + 1]));
  return off;
}
Wide passing(const Wide& volume, const Wide& conductance, double dt) {  // in series
  Wide off{};
  for (std::size_t k = 0; k + 1 < P && volume[k + 1] > 0; ++k) off[k] = dt / (0.5 * (volume[k] / conductance[k] + volume[k + 1] / conductance[k + 1]));
  return off;
}

// (storage volume) (x - x0) = (what passes between volumes) + source volume, by backward Euler: the matrix, eliminated
// row by row. What takes time is the chain of divisions; those of two matrices run side by side where they are taken in
// one loop.
template <class Values>
struct Factors {
  Values inverse, passed;  // of the diagonal as eliminated; of a row that is passed on to the next
  double last = 0;

  void take(std::size_t k, const Values& volume, double storage, const Values& off) {
    const double before = k > 0 ? off[k - 1] : 0, diagonal = storage * volume[k] + off[k] + before - before * last;
    inverse[k] = 1 / diagonal;
    passed[k] = last = off[k] * inverse[k];
  }
  /// In place; `source` per volume.
  void solve(Values& x, const Values& volume, double storage, const Values& source, std::size_t n) const {
    double carried = 0;
    for (std::size_t k = 0; k < n; ++k) {
      carried = volume[k] * (storage * x[k] + source[k]) + (k > 0 ? passed[k - 1] : 0) * carried;
      x[k] = carried * inverse[k];
    }
    for (std::size_t k = n - 1; k-- > 0;) x[k] += passed[k] * x[k + 1];
  }
};

// The zone's volumes, and those of a cell beside it; of nothing where nothing is spread.
Wide with_beside(const Row& volume, double cell) {
  Wide wide;
  std::copy(volume.begin(), volume.end(), wide.begin());
  for (std::size_t k = N; k < P; ++k) wide[k] = cell / double(ShearBand::beside);
  return wide;
}

}  // namespace

double growth_of(double thickness, double width, double near) {
  const double wanted = 0.5 * (width - thickness) / edge_volume(thickness);
  const double least = 0.7;  // (less would leave no volume at the end of a zone hardly wider than its band)
  if (sum_outside(least) >= wanted) return least;
  // The sum is convex in the growth, so that Newton's steps come from above after the first.
  double growth = near > least ? near : 2;
  for (int k = 0; k < 100; ++k) {
    double sum = 1, slope = 0;
    for (std::size_t n = 1; n < outside; ++n) slope = slope * growth + sum, sum = sum * growth + 1;
    const double next = std::max(least, growth - (sum - wanted) / slope);
    if (std::abs(next - growth) <= 1e-14 * growth) return next;
    growth = next;
  }
  return growth;
}

Row volumes_of(double thickness, double width, double growth) {
  Row volume;
  const double edge = edge_volume(thickness);
  for (std::size_t k = 0; k < ShearBand::inside; ++k) volume[k] = edge * double(1 << (ShearBand::inside - 1 - k));
  double size = 0.5 * (width - thickness) / sum_outside(growth);
  for (std::size_t k = ShearBand::inside; k < N; ++k, size *= growth) volume[k] = size;
  return volume;
}

double ShearBand::mean(const double* of, double thickness) const {
  double sum = 0;
  const double edge = edge_volume(thickness);
  for (std::size_t k = 0; k < inside; ++k) sum += of[k] * edge * double(1 << (inside - 1 - k));
  return sum / (0.5 * thickness);
}

double advance_band(ShearBand& band, const HeatSoil& soil, double width, double work, double dt, double from_c, double to_c) {
  if (!(width > least_excess * soil.band)) {
    band = {};
    return soil.swells(from_c, to_c);
  }
  const double beside = soil.spread > 0 ? soil.cell : 0;
  if (width != band.width) {
    band.width = width;
    band.growth = growth_of(soil.band, width, band.growth);
    const Row volume = volumes_of(soil.band, width, band.growth);
    keep_mean_zero(band.temperature, volume);
    keep_mean_zero(band.pressure, with_beside(volume, beside));
  }
  const Row volume = volumes_of(soil.band, width, band.growth);
  const bool open = soil.exchange == BandExchange::deviation;
  const Row before = band.temperature;
  Row source;
  for (std::size_t k = 0; k < N; ++k) source[k] = work * ((k < ShearBand::inside ? width / soil.band : 0) - 1);
  const Row through = passing(volume, open ? soil.conductivity : 0, dt);
  Factors<Row> of_heat;
  if (!(soil.storage > 0)) {
    for (std::size_t k = 0; k < N; ++k) of_heat.take(k, volume, soil.capacity, through);
    of_heat.solve(band.temperature, volume, soil.capacity, source, N);
    return soil.swells(from_c, to_c);
  }
  const std::size_t n = soil.spread > 0 ? P : N;
  const Wide wide = with_beside(volume, beside);
  Factors<Wide> of_water;
  Wide swelling{}, off{};
  if (!soil.by_temperature && open) off = passing(wide, soil.mobility, dt);
  for (std::size_t k = 0; k < N; ++k) {
    of_heat.take(k, volume, soil.capacity, through);
    if (!soil.by_temperature) of_water.take(k, wide, soil.storage, off);
  }
  of_heat.solve(band.temperature, volume, soil.capacity, source, N);
  double swollen = 0, of_zone = 0;  // of the zone in the mean: of water and grains, and over the skeleton
  if (!soil.by_temperature) {
    for (std::size_t k = 0; k < N; ++k) swelling[k] = soil.pressurising() * (band.temperature[k] - before[k]);
    swollen = soil.swells(from_c, to_c);
    of_zone = soil.pressurising() * work / soil.capacity;
  } else {
    Wide mobility;
    double all = 0;
    for (std::size_t k = 0; k < N; ++k) {
      swelling[k] = soil.swells(from_c + before[k], to_c + band.temperature[k]);
      swollen += swelling[k] * volume[k];
      all += volume[k];
      mobility[k] = std::max(soil.mobility_at(to_c + band.temperature[k]), 1e-30);
    }
    swollen /= all;
    for (std::size_t k = 0; k < N; ++k) swelling[k] -= swollen + soil.skeleton * (band.temperature[k] - before[k]);
    for (std::size_t k = N; k < P; ++k) mobility[k] = std::max(soil.mobility_at(to_c), 1e-30);
    if (open && soil.mobility > 0) off = passing(wide, mobility, dt);
    of_zone = swollen - soil.skeleton * (to_c - from_c);
    for (std::size_t k = 0; k < N; ++k) of_water.take(k, wide, soil.storage, off);
  }
  for (std::size_t k = N; k < n; ++k) of_water.take(k, wide, soil.storage, off);
  if (soil.spread > 0) {
    const double spread = of_zone * std::min(most_spread, soil.spread * soil.cell / width);
    for (std::size_t k = 0; k < P; ++k) swelling[k] += k < N ? spread : -spread * 0.5 * width / soil.cell;
  }
  of_water.solve(band.pressure, wide, soil.storage, swelling, n);
  return swollen;
}

}  // namespace pivnp::mpm

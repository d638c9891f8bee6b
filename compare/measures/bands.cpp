#include "compare/measures/bands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "compare/data/statistics.hpp"
#include "compare/uncertainty/strain_errors.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

Bands::Bands(double threshold, const DataSet& first, const DataSet& second)
    : threshold_(threshold), onset_{std::vector<double>(first.size(), not_known),
                                    std::vector<double>(second.size(), not_known)},
      rate_(onset_), before_(onset_) {}

void Bands::add(const DataSetState& first, const DataSetState& second) {
  const double step = first.time - time_;
  if (std::isfinite(time_)) longest_step_ = std::max(longest_step_, step);
  time_ = first.time;
  const PerDataSet<const DataSetState*> states{&first, &second};
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t p = 0; p < onset_[s].size(); ++p)
      if (states[s]->followed[p] && std::isnan(onset_[s][p])) {
        const double strain = deviatoric(log_strain(states[s]->F[p]));
        if (strain >= threshold_) onset_[s][p] = states[s]->time, rate_[s][p] = (strain - before_[s][p]) / step;
        before_[s][p] = strain;
      }
}

namespace {

ScatteredField present_field(const DataSet& set, const RigidMotion& frame, const std::vector<double>& onset,
                            const std::vector<double>& rate) {
  ScatteredField f;
  for (std::size_t p = 0; p < set.size(); ++p) {
    const DataSetState& state = set.state();
    if (!state.followed[p]) continue;
    const Strain e = log_strain(state.F[p]);
    const double dev = deviatoric(e);
    if (!std::isfinite(dev)) continue;
    f.x.push_back(frame.undo(set.material_position()[p] + state.u[p]));
    f.value.push_back(dev);
    f.spacing.push_back(set.spacing()[p] * std::clamp(std::exp(principal(e).first), 1.0, 4.0));
    f.onset.push_back(onset[p]);
    f.rate.push_back(rate[p]);
  }
  return f;
}

// Mean variance of the deviatoric strain at those followed particles that lie next to a ridge; 0 where no covariance of F is
// known.
double variance_along(const std::vector<Vec2>& ridge, const DataSet& set, const RigidMotion& frame) {
  const DataSetState& state = set.state();
  if (state.cov_F.empty()) return 0;
  double sum = 0, count = 0;
  const double near = set.median_spacing();
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!state.followed[p]) continue;
    const Vec2 x = frame.undo(set.material_position()[p] + state.u[p]);
    if (std::none_of(ridge.begin(), ridge.end(), [&](const Vec2& y) { return (x - y).norm() < near; })) continue;
    const double variance = strain_variance(state.F[p], state.cov_F[p]).dev;
    if (!std::isfinite(variance)) continue;
    sum += variance, ++count;
  }
  return count > 0 ? sum / count : not_known;
}

// Mean distance from the points of one ridge to the nearest of the other.
double mean_distance(const std::vector<Vec2>& from, const std::vector<Vec2>& to) {
  double sum = 0;
  for (const Vec2& a : from) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec2& b : to) nearest = std::min(nearest, (a - b).norm());
    sum += nearest / double(from.size());
  }
  return sum;
}

BandMeasures::Difference difference_of(const ShearBand& a, const ShearBand& b, const PerDataSet<double>& spacing,
                                       double longest_step, double u_dev, double gauge, double threshold) {
  BandMeasures::Difference d;
  d.offset = (mean_distance(a.ridge, b.ridge) + mean_distance(b.ridge, a.ridge)) / 2;
  d.place_uncertainty = std::hypot(spacing[0], spacing[1], gauge) / std::sqrt(12.0);
  double turn = b.inclination_deg - a.inclination_deg;
  turn -= 180 * std::round(turn / 180);
  d.inclination_deg = turn;
  d.inclination_uncertainty_deg = std::hypot(spacing[0] / a.length, spacing[1] / b.length, 2 * gauge / (a.length + b.length)) * 180 / std::numbers::pi /
                                  std::sqrt(12.0);
  d.thickness = b.thickness - a.thickness;
  d.onset = b.onset - a.onset;
  d.peak = b.peak - a.peak;
  // Averaged over the gauge, a ridge is lower by about what it is wider.
  const double lower = gauge > 0 ? 1 - b.thickness / std::hypot(b.thickness, gauge) : 0;
  d.peak_uncertainty = std::hypot(u_dev, b.peak * lower);
  d.slip = b.slip - a.slip;
  // Averaging moves the places where the strain has fallen to a tenth outwards, by half the gauge on either side at most: what lies
  // between is counted in one and not in the other, rectangular within sqrt(3) of a tenth of the ridge's strain times the gauge.
  d.slip_uncertainty = std::hypot(std::sqrt(3.0) * u_dev * std::hypot(a.thickness, b.thickness), 0.1 * std::max(a.peak, b.peak) * gauge);
  // A strain that is averaged over the gauge is lower, and reaches the threshold later by what it lacks over its rate; by a step
  // more or less.
  const double rate = std::isfinite(a.rate) && std::isfinite(b.rate) ? std::min(a.rate, b.rate) : std::isfinite(a.rate) ? a.rate : b.rate;
  double late = 0;
  if (rate > 0 && gauge > 0) late = std::hypot(threshold * (std::isfinite(lower) ? lower : 1), std::isfinite(u_dev) ? u_dev : 0) / rate;
  d.onset_uncertainty = std::hypot(longest_step / std::sqrt(gauge > 0 ? 3.0 : 6.0), late);
  return d;
}

}  // namespace

namespace {

const ShearBand& counterpart(const ShearBand& band, const std::vector<ShearBand>& others) {
  const auto strength = [](const ShearBand& b) { return b.length * b.strain; };
  const ShearBand* nearest = &others[0];
  double least = mean_distance(band.ridge, nearest->ridge);
  for (const ShearBand& other : others) {
    if (strength(other) < 0.5 * strength(others[0])) continue;
    if (const double d = mean_distance(band.ridge, other.ridge); d < least) least = d, nearest = &other;
  }
  return *nearest;
}

// Bands that cross are not one band seen twice.
bool alike(const ShearBand& a, const ShearBand& b) {
  constexpr double most_turn = 30;  // degrees
  const double turn = b.inclination_deg - a.inclination_deg;
  return std::abs(turn - 180 * std::round(turn / 180)) < most_turn;
}

// The parts of both that lie beside each other: what is read off a band varies along it, and one data set may see it further.
std::pair<ShearBand, ShearBand> in_common(const ShearBand& a, const ShearBand& b) {
  const auto direction = [](const ShearBand& band) -> Vec2 {
    const double turn = band.inclination_deg * std::numbers::pi / 180;
    return {std::cos(turn), std::sin(turn)};
  };
  // Along the line between both, whichever is the first.
  const Vec2 first = direction(a), second = direction(b), middle = (a.centre + b.centre) / 2;
  const Vec2 along = (first.dot(second) < 0 ? Vec2(first - second) : Vec2(first + second)).normalized();
  const auto reach = [&](const ShearBand& band) {
    std::pair<double, double> r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Vec2& x : band.ridge)
      r.first = std::min(r.first, (x - middle).dot(along)), r.second = std::max(r.second, (x - middle).dot(along));
    return r;
  };
  const auto [from_a, to_a] = reach(a);
  const auto [from_b, to_b] = reach(b);
  const double from = std::max(from_a, from_b), to = std::min(to_a, to_b);
  return {a.between(middle, along, from, to), b.between(middle, along, from, to)};
}

}  // namespace

BandMeasures Bands::measure(const DataSet& first, const DataSet& second, const Tally& last, double gauge) const {
  const PerDataSet<RigidFit>& frame = last.frame;
  const double floor = last.floor_dev;
  const PerDataSet<const DataSet*> sets{&first, &second};
  BandMeasures out;
  out.threshold = threshold_;
  out.floor_dev = floor;
  out.gauge = gauge;
  for (std::size_t s = 0; s < 2; ++s) {
    const ScatteredField field = present_field(*sets[s], frame[s].motion, onset_[s], rate_[s]);
    const auto with = [&](double threshold) { return find_bands(field, sets[s]->median_spacing(), threshold); };
    out.bands[s] = with(threshold_);
    out.number_uncertainty[s] = not_known;
    if (!std::isfinite(floor)) continue;
    const auto count = [&](double threshold) { return double(with(std::max(threshold, 0.1 * threshold_)).size()); };
    out.number_uncertainty[s] = std::abs(count(threshold_ - floor) - count(threshold_ + floor)) / 2;
  }
  if (out.bands[0].empty() || out.bands[1].empty()) return out;
  const auto [band, other] = in_common(out.bands[0][0], counterpart(out.bands[0][0], out.bands[1]));
  if (band.length < 4 * first.median_spacing() || other.length < 4 * second.median_spacing() || !alike(band, other)) return out;
  const double own = std::sqrt(variance_along(band.ridge, first, frame[0].motion) + variance_along(other.ridge, second, frame[1].motion));
  out.strongest = difference_of(band, other, {first.median_spacing(), second.median_spacing()}, longest_step_,
                                strain_uncertainty(own, last.rest_dev, floor), gauge, threshold_);
  return out;
}

std::string BandMeasures::words() const {
  return "shear bands (ridges of deviatoric strain above " + number(threshold) +
         " at the last common time, at least four spacings long)";
}

std::vector<ComparisonTable> BandMeasures::tables(const std::string& unit, const std::string& time_unit) const {
  std::vector<ComparisonTable> out;
  for (const DataSetRole role : data_set_roles) {
    const std::vector<ShearBand>& list = bands[std::size_t(role)];
    if (list.empty()) continue;
    const std::string name(name_of(role));
    ComparisonTable t{"bands_" + name, words() + " of the " + name + ", strongest first",
                      {{"x", unit, {}}, {"y", unit, {}}, {"inclination", "deg", {}}, {"length", unit, {}},
                       {"thickness", unit, {}}, {"strain_dev", "1", {}}, {"onset", time_unit, {}}, {"strain_dev_median", "1", {}},
                       {"slip", unit, {}}}};
    for (const ShearBand& b : list) {
      const std::array<double, 9> row{b.centre.x(), b.centre.y(), b.inclination_deg, b.length, b.thickness,
                                      b.strain,     b.onset, b.peak, b.slip};
      for (std::size_t c = 0; c < row.size(); ++c) t.columns[c].values.push_back(row[c]);
    }
    out.push_back(std::move(t));
  }
  return out;
}

}  // namespace pivnp::compare

#include "compare/measures/differences.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

constexpr std::size_t most_field_values = std::size_t(1) << 23;  // of one field

void raise_peak(double magnitude, double sigma, bool begins, double& peak, double& peak_sigma) {
  if (magnitude <= peak && !begins) return;
  peak = magnitude;
  peak_sigma = sigma;
}

// Which of the places lie in the zone that stands still, or moves as one piece.
std::vector<std::uint8_t> in_zone(const CompareOptions& options, const std::vector<Vec2>& places) {
  const Points& given = options.fixed_zone_m.empty() ? options.reference_m : options.fixed_zone_m;
  if (given.empty()) return {};
  const Polygon zone(positions_of(given), options.fixed_zone_m.empty() ? "compare.reference_m" : "compare.fixed_zone_m");
  std::vector<std::uint8_t> inside;
  for (const Vec2& x : places) inside.push_back(zone.contains(x));
  return inside;
}

double rms_or_none(const ScalarStatistics& s) { return s.count() > 0 ? s.rms() : not_known; }

const Vec2 no_vector = Vec2::Constant(not_known);

}  // namespace

PerDataSet<double> Tally::known_sigma() const {
  PerDataSet<double> own;
  for (std::size_t s = 0; s < 2; ++s) own[s] = std::isfinite(sum_cov_trace[s]) ? sum_cov_trace[s] : 0;
  const double given = std::isfinite(sum_measurement) ? std::max(0.0, sum_measurement - own[0] - own[1]) : 0;
  return {rms_part(own[0] + given), rms_part(own[1] + sum_numerical - sum_grid + sum_input)};
}

// One data set's view of one particle at one time, in the frame of the comparison.
struct Differences::Sample {
  Vec2 u;
  double dev, vol, path;
  Vec2 cov;  // uu, vv, NaN if not known

  double trace() const { return cov.sum(); }
  Vec2 strain() const { return {dev, vol}; }
};

// One field of differences: what it holds at a particle.
struct Differences::Field {
  const char *name, *unit, *definition;
  double (*value)(const Sample& first, const Sample& second);
};

const std::vector<Differences::Field>& Differences::difference_fields() {
  static const std::vector<Field> rows{
      {"difference_x", "L", "u_x of the second minus that of the first",
       [](const Sample& a, const Sample& b) { return (b.u - a.u).eval().x(); }},
      {"difference_y", "L", "u_y of the second minus that of the first",
       [](const Sample& a, const Sample& b) { return (b.u - a.u).eval().y(); }},
      {"difference_magnitude", "L", "|u of the second minus u of the first|",
       [](const Sample& a, const Sample& b) { return (b.u - a.u).norm(); }},
      {"difference_strain_dev", "1", "deviatoric log strain of the second minus that of the first",
       [](const Sample& a, const Sample& b) { return b.dev - a.dev; }}};
  return rows;
}

namespace {

// One column of the table over_space: what it holds of one time.
struct StatisticOverSpace {
  std::string name, unit, definition;
  std::function<double(const Tally&)> value;
};

const std::vector<StatisticOverSpace>& statistics_over_space() {
  static const std::vector<StatisticOverSpace> rows = [] {
    const auto count = [](const Tally& t) { return double(t.displacement.count()); };
    std::vector<StatisticOverSpace> list{
        {"displacement_rms", "L", "RMS over the particles of |u_second - u_first|",
         [](const Tally& t) { return t.displacement.rms(); }},
        {"displacement_uncertainty", "L", "u_val: root mean trace of the variance of u_second - u_first",
         [](const Tally& t) { return t.displacement.rms_uncertainty(); }},
        {"displacement_mean_first", "L", "mean |u| of the first, over the particles compared",
         [=](const Tally& t) { return t.sum_first / count(t); }},
        {"displacement_mean_second", "L", "mean |u| of the second, over the particles compared",
         [=](const Tally& t) { return t.sum_second / count(t); }},
        {"strain_dev_rms", "1", "RMS over the particles of the difference of deviatoric strain",
         [](const Tally& t) { return rms_or_none(t.strain_dev); }},
        {"strain_dev_uncertainty", "1",
         "u_val of the deviatoric strain: covariance of F, gauge length and noise floor (stated, or of compare.fixed_zone_m or "
         "compare.reference_m), as far as they are known",
         [](const Tally& t) { return t.dev_uncertainty(); }},
        {"particles_compared", "1", "particles of the first that have a partner", count},
        {"displacement_bias_x", "L", "mean of u_x of the second minus that of the first",
         [](const Tally& t) { return t.displacement.bias().x(); }},
        {"displacement_bias_y", "L", "mean of u_y of the second minus that of the first",
         [](const Tally& t) { return t.displacement.bias().y(); }},
        {"displacement_p95", "L", "95th percentile of |u_second - u_first|",
         [](const Tally& t) { return t.displacement.p95(); }},
        {"displacement_max", "L", "greatest |u_second - u_first|", [](const Tally& t) { return t.displacement.max(); }}};
    const auto add = [&](const std::string& name, const std::string& of, ScalarStatistics Tally::*strain, bool with_rms) {
      const auto row = [&](const char* what, const char* words, double (*value)(const ScalarStatistics&)) {
        list.push_back({name + what, "1", words + of, [=](const Tally& t) {
                          return (t.*strain).count() > 0 ? value(t.*strain) : not_known;
                        }});
      };
      row("_bias", "mean difference of ", [](const ScalarStatistics& s) { return s.bias(); });
      if (with_rms) row("_rms", "RMS difference of ", [](const ScalarStatistics& s) { return s.rms(); });
      row("_p95", "95th percentile of the size of the difference of ", [](const ScalarStatistics& s) { return s.p95(); });
      row("_max", "greatest difference of ", [](const ScalarStatistics& s) { return s.max(); });
    };
    add("strain_dev", "deviatoric log strain", &Tally::strain_dev, false);  // its RMS stands above
    add("strain_vol", "ln J", &Tally::strain_vol, true);
    add("strain_dev_path", "deviatoric strain along the path", &Tally::strain_path, true);
    return list;
  }();
  return rows;
}

}  // namespace

Differences::Differences(std::vector<std::size_t> paired, const DataSet& first, std::size_t times,
                         const CompareOptions& options, const StrainNotes& notes, double clock)
    : paired_(std::move(paired)), length_unit_(first.motion().length_unit()), time_unit_(first.motion().time_unit()),
      most_times_(times),
      rows_kept_(std::clamp<std::size_t>(most_field_values / std::max<std::size_t>(1, paired_.size()), 2,
                                         std::max<std::size_t>(2, times))),
      budget_(options), notes_(notes), rates_({}, {}, 0), mean_total_(paired_.size()),
      mean_last_(paired_.size()), strain_mean_total_(paired_.size()), strain_mean_last_(paired_.size()),
      strain_errors_({}, {}), clock_(clock), given_correlation_(options.correlation_m.value_or(not_known)),
      second_before_(paired_.size(), no_vector), strain_before_(paired_.size(), no_vector), over_displacement_(paired_.size(), times),
      over_strain_(paired_.size(), times), begun_(paired_.size(), 0), fields_(difference_fields().size()),
      statistics_(statistics_over_space().size()) {
  for (const std::size_t p : paired_) {
    id_.push_back(first.motion().particles().id[p]);
    X_.push_back(first.material_position()[p]);
  }
  rates_ = Rates(X_, options.increments_outside_m, times);
  strain_errors_ = StrainErrors(X_, notes_);
  zone_ = in_zone(options, X_);
  for (std::size_t s = 0; s < 2; ++s) {
    F_before_[s].assign(paired_.size(), Mat2::Identity());
    path_[s].assign(paired_.size(), 0.0);
  }
}

// The first time, the last, and evenly between them.
bool Differences::keeps_fields() const {
  if (rows_kept_ >= most_times_ || most_times_ < 2) return true;
  const std::size_t k = time_.size(), n = most_times_ - 1, m = rows_kept_ - 1;
  return k == 0 || k * m / n != (k - 1) * m / n;
}

double Differences::path_step(std::vector<Mat2>& before, std::size_t row, const Mat2& F, std::vector<double>& path) {
  if (begun_[row]) path[row] += deviatoric(increment_central(before[row], F));
  before[row] = F;
  return path[row];
}

bool Differences::add(const DataSetState& first, const DataSetState& second, const std::vector<Partner>& partners,
                      const PerDataSet<RigidFit>& frame, const std::vector<Vec2>& numerical) {
  auto compared = [&](std::size_t p) { return first.followed[p] && has_partner(partners[p]); };
  if (std::none_of(paired_.begin(), paired_.end(), compared)) return false;
  last_ = Tally{};
  last_.frame = frame;
  last_particles_ = ComparedParticles{};
  mean_last_.clear();
  strain_mean_last_.clear();
  const PerDataSet<bool> known{!first.cov.empty(), !second.cov.empty()};
  const bool keep = keeps_fields();
  const PerDataSet<Mat2> back{frame[0].motion.rotation().transpose(), frame[1].motion.rotation().transpose()};
  PerDataSet<StillZone> still;
  std::vector<Vec2> u_first(paired_.size(), no_vector), difference(paired_.size(), no_vector),
      variances(paired_.size(), no_vector), grid(paired_.size(), Vec2::Zero());
  const double step = time_.empty() ? not_known : first.time - time_.back();
  std::vector<PartnerState> seconds(paired_.size());
  for (std::size_t row = 0; row < paired_.size(); ++row)
    if (compared(paired_[row])) seconds[row] = partner_state(partners[paired_[row]], second);
  std::vector<StrainError> strain = strain_errors(first, second, partners, seconds);
  if (keep) field_time_.push_back(first.time);

  const auto sample = [&](std::size_t set, std::size_t row, const Vec2& u, const Mat2& F,
                          const std::array<double, 3>* cov) {
    Sample s;
    const RigidMotion& m = frame[set].motion;
    s.u = m.angle == 0 ? Vec2(u - m.shift) : Vec2(m.undo(X_[row] + u) - X_[row]);
    const Mat2 turned = m.angle == 0 ? F : Mat2(back[set] * F);
    const Strain e = log_strain(turned);
    s.dev = deviatoric(e);
    s.vol = volumetric(e);
    s.path = path_step(F_before_[set], row, turned, path_[set]);
    s.cov = cov ? Vec2((*cov)[0], (*cov)[1]) : no_vector;
    return s;
  };
  for (std::size_t row = 0; row < paired_.size(); ++row) {
    const std::size_t p = paired_[row];
    if (!compared(p)) {
      begun_[row] = 0;
      if (keep)
        for (std::vector<float>& field : fields_) field.push_back(float(not_known));
      continue;
    }
    const PartnerState& partner = seconds[row];
    const Sample a = sample(0, row, first.u[p], first.F[p], known[0] ? &first.cov[p] : nullptr);
    const Sample b = sample(1, row, partner.u, partner.F, known[1] ? &partner.cov : nullptr);
    begun_[row] = 1;
    // A clock that is wrong by a little moves the second along its path.
    const auto late_by = [&](const Vec2& now, Vec2& before) {
      const Vec2 late = clock_ > 0 ? Vec2((now - before) / step * clock_) : Vec2(Vec2::Zero());
      before = now;
      return late.allFinite() ? late : Vec2(Vec2::Zero());
    };
    const Vec2 late = late_by(b.u, second_before_[row]);
    strain[row].late = late_by(b.strain(), strain_before_[row]);
    Variance variance =
        budget_.at(a.cov, b.cov, a.u, frame[0].variance_at(X_[row]) + frame[1].variance_at(X_[row]) + late.cwiseAbs2(),
                   numerical.empty() ? nullptr : &numerical[p]);
    // A data set that measures, but not the error of this particle.
    if ((known[0] && a.cov.hasNaN()) || (known[1] && b.cov.hasNaN())) variance.measurement = no_vector;
    add_particle(row, a, b, variance, strain[row]);
    if (!zone_.empty() && zone_[row]) {
      still[0].add(a.dev, a.vol, a.path);
      still[1].add(b.dev, b.vol, b.path);
    }
    const Vec2 d = b.u - a.u;
    u_first[row] = a.u;
    difference[row] = d;
    grid[row] = numerical.empty() ? Vec2(Vec2::Zero()) : numerical[p];
    variances[row] = variance.total() - variance.grid;
    if (!keep) continue;
    for (std::size_t f = 0; f < fields_.size(); ++f) fields_[f].push_back(float(difference_fields()[f].value(a, b)));
  }
  for (std::size_t s = 0; s < 2; ++s) {
    cov_known_[s] = cov_known_[s] && known[s];
    cov_F_known_[s] = cov_F_known_[s] && !(s == 0 ? first : second).cov_F.empty();
  }
  add_floors(known, still);
  find_correlation(known);
  rates_.add(first.time, u_first, difference, variances, grid);
  for (std::size_t s = 0; s < statistics_.size(); ++s)
    statistics_[s].push_back(statistics_over_space()[s].value(last_));
  time_.push_back(first.time);
  return true;
}

void Differences::find_correlation(const PerDataSet<bool>& known) {
  correlation_ = given_correlation_;
  if (std::isfinite(correlation_)) return;
  double greatest = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    if (!known[s]) continue;
    const double own = notes_[s] ? notes_[s]->gauge_length : not_known;
    if (!(own > 0)) return;
    greatest = std::max(greatest, own);
  }
  if (greatest > 0) correlation_ = greatest;
}

std::optional<Vec2> Differences::mean_uncertainty(bool last) const {
  const Vec2 u = (last ? mean_last_ : mean_total_).uncertainty(X_, correlation_);
  return u.allFinite() ? std::optional(u) : std::nullopt;
}

std::optional<FieldMean::Weighted> Differences::weighted() const {
  const ComparedParticles& last = last_particles_;
  std::vector<Vec2> difference, random, common;
  for (std::size_t k = 0; k < last.X.size(); ++k) {
    difference.push_back(last.u_second[k] - last.u_first[k]);
    const bool known = last.random[k].allFinite();
    random.push_back(known ? last.random[k] : Vec2(Vec2::Zero()));
    common.push_back(last.variance[k] - random.back());
  }
  return FieldMean::weighted(last.X, difference, random, common, correlation_);
}

void Differences::add_particle(std::size_t row, const Sample& a, const Sample& b, const Variance& variance,
                               const StrainError& strain) {
  const Vec2 d = b.u - a.u, total = variance.total();
  for (Tally* tally : {&last_, &total_}) {
    const bool begins = tally->displacement.count() == 0;
    tally->displacement.add(d, total.x(), total.y());
    tally->sum_cov_trace[0] += a.trace();
    tally->sum_cov_trace[1] += b.trace();
    tally->sum_measurement += variance.measurement.sum();
    tally->sum_numerical += variance.numerical.sum();
    tally->sum_grid += variance.grid.sum();
    tally->sum_input += variance.input.sum();
    tally->sum_first += a.u.norm();
    tally->sum_second += b.u.norm();
    raise_peak(a.u.norm(), std::sqrt(a.trace()), begins, tally->peak_first, tally->peak_first_sigma);
    raise_peak(b.u.norm(), std::sqrt(b.trace()), begins, tally->peak_second, tally->peak_second_sigma);
    if (!std::isfinite(a.dev) || !std::isfinite(b.dev)) continue;  // F not positive: no strain
    tally->strain_dev.add(b.dev - a.dev, strain.variance()[0]);
    tally->strain_vol.add(b.vol - a.vol, strain.variance()[1]);
    tally->sum_gauge += strain.gauge;
    if (std::isfinite(a.path) && std::isfinite(b.path)) tally->strain_path.add(b.path - a.path);
  }
  const Vec2 random = sum_known(a.cov, b.cov);
  for (FieldMean* mean : {&mean_total_, &mean_last_}) mean->add(row, d, random, total - random);
  over_displacement_.add(row, d);
  if (std::isfinite(b.dev - a.dev)) {
    over_strain_.add(row, Vec2(b.dev - a.dev, 0));
    for (FieldMean* mean : {&strain_mean_total_, &strain_mean_last_})
      mean->add(row, b.strain() - a.strain(), strain.random, strain.late.cwiseAbs2());
  }
  last_particles_.particle.push_back(paired_[row]);
  last_particles_.X.push_back(X_[row]);
  last_particles_.u_first.push_back(a.u);
  last_particles_.u_second.push_back(b.u);
  last_particles_.dev_first.push_back(a.dev);
  last_particles_.dev_second.push_back(b.dev);
  last_particles_.strain_first.push_back(a.strain());
  last_particles_.strain_second.push_back(b.strain());
  last_particles_.strain_error.push_back(strain);
  last_particles_.variance.push_back(total);
  last_particles_.random.push_back(random);
}

std::vector<ComparisonField> Differences::take_fields() {
  std::vector<ComparisonField> out;
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    const Field& row = difference_fields()[f];
    out.push_back({row.name, unit_in(row.unit, length_unit_, time_unit_), row.definition, field_time_, id_,
                   std::move(fields_[f])});
  }
  const auto add = [&](const std::string& name, const std::string& unit, const std::string& definition, auto&& value) {
    ComparisonField field{"over_time_" + name, unit, definition + ", over the times of each particle", {time_.back()},
                          id_, {}};
    for (std::size_t row = 0; row < paired_.size(); ++row) field.values.push_back(float(value(row)));
    out.push_back(std::move(field));
  };
  const auto sizes = [&](const std::string& name, const std::string& unit, const std::string& of, const OverTime& o) {
    add(name + "_rms", unit, "RMS of " + of, [&](std::size_t r) { return o.rms(r); });
    add(name + "_p95", unit, "95th percentile (nearest rank) of the size of " + of,
        [&](std::size_t r) { return o.p95(r); });
    add(name + "_max", unit, "greatest size of " + of, [&](std::size_t r) { return o.max(r); });
  };
  add("displacement_bias_x", length_unit_, "mean of u_x, second minus first",
      [&](std::size_t r) { return over_displacement_.bias(r).x(); });
  add("displacement_bias_y", length_unit_, "mean of u_y, second minus first",
      [&](std::size_t r) { return over_displacement_.bias(r).y(); });
  sizes("displacement", length_unit_, "u_second - u_first", over_displacement_);
  sizes("velocity", length_unit_ + "/" + time_unit_, "v_second - v_first", rates_.over_time());
  add("strain_dev_bias", "1", "mean of the deviatoric strain, second minus first",
      [&](std::size_t r) { return over_strain_.bias(r).x(); });
  sizes("strain_dev", "1", "the deviatoric strain's difference", over_strain_);
  return out;
}

ComparisonTable Differences::over_space() const {
  ComparisonTable table{std::string(over_space_table), "statistics over the particles, time by time", {}};
  table.columns.push_back({"time", time_unit_, time_});
  for (std::size_t s = 0; s < statistics_.size(); ++s) {
    const StatisticOverSpace& row = statistics_over_space()[s];
    table.columns.push_back({row.name, unit_in(row.unit, length_unit_, time_unit_), statistics_[s], row.definition});
  }
  for (ComparisonTable::Column& column : rates_.velocity_columns(length_unit_, time_unit_)) {
    column.values.resize(time_.size(), not_known);  // a comparison of one time has no room for two ends
    table.columns.push_back(std::move(column));
  }
  return table;
}

}  // namespace pivnp::compare

#include "compare/measures/differences.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

constexpr std::size_t most_field_values = std::size_t(1) << 23;  // of one field

void raise_peak(double magnitude, double sigma, bool begins, double& peak, double& peak_sigma) {
  if (magnitude <= peak && !begins) return;
  peak = magnitude;
  peak_sigma = sigma;
}

// Both sides' floors together, of those sides that know their error: as the record states it, else as found.
double combined(const std::array<bool, 2>& known, const StrainNotes& notes, double StrainNote::*stated,
                const std::array<double, 2>& found) {
  double sum = 0;
  bool any = false;
  for (std::size_t s = 0; s < 2; ++s) {
    const bool has = notes[s] && std::isfinite((*notes[s]).*stated);
    if (!has && !known[s]) continue;
    const double floor = has ? (*notes[s]).*stated : found[s];
    sum += floor * floor;
    any = true;
  }
  return any ? std::sqrt(sum) : not_known;
}

double larger_known(double a, double b) { return std::isnan(a) ? b : std::isnan(b) ? a : std::max(a, b); }

double rms_or_none(const ScalarStatistics& s) { return s.count() > 0 ? s.rms() : not_known; }

const Vec2 no_vector = Vec2::Constant(not_known);

}  // namespace

std::array<double, 2> Tally::known_sigma() const {
  std::array<double, 2> own;
  for (std::size_t s = 0; s < 2; ++s) own[s] = std::isfinite(sum_cov_trace[s]) ? sum_cov_trace[s] : 0;
  const double given = std::isfinite(sum_measurement) ? std::max(0.0, sum_measurement - own[0] - own[1]) : 0;
  return {rms_part(own[0] + given), rms_part(own[1] + sum_numerical + sum_input)};
}

// One side of one particle at one time, in the frame of the comparison.
struct Differences::Sample {
  Vec2 u;
  double dev, vol, path;
  Vec2 cov;  // uu, vv, NaN if not known

  double trace() const { return cov.sum(); }
};

Differences::Differences(std::vector<std::size_t> paired, const std::vector<Vec2>& X, std::size_t times,
                         const CompareOptions& options, const StrainNotes& notes, const std::string& length_unit,
                         const std::string& time_unit)
    : paired_(std::move(paired)), length_unit_(length_unit), time_unit_(time_unit), times_(times),
      rows_kept_(std::clamp<std::size_t>(most_field_values / std::max<std::size_t>(1, paired_.size()), 2,
                                         std::max<std::size_t>(2, times))),
      budget_(options), notes_(notes), rates_({}, {}, 0), over_displacement_(paired_.size(), times),
      over_strain_(paired_.size(), times), begun_(paired_.size(), 0) {
  for (const std::size_t p : paired_) X_.push_back(X[p]);
  rates_ = Rates(X_, options.increments_outside_m, times);
  for (std::size_t s = 0; s < 2; ++s) {
    F_before_[s].assign(paired_.size(), Mat2::Identity());
    path_[s].assign(paired_.size(), 0.0);
  }
  fields_ = {{"difference_x", length_unit, "u_x of the second minus that of the first", {}},
             {"difference_y", length_unit, "u_y of the second minus that of the first", {}},
             {"difference_magnitude", length_unit, "|u of the second minus u of the first|", {}},
             {"difference_strain_dev", "1", "deviatoric log strain of the second minus that of the first", {}}};
  series_ = {
      {"displacement_rms", length_unit, "RMS over the particles of |u_second - u_first|", {}},
      {"displacement_uncertainty", length_unit, "u_val: root mean trace of the variance of u_second - u_first", {}},
      {"displacement_mean_first", length_unit, "mean |u| of the first, over the particles compared", {}},
      {"displacement_mean_second", length_unit, "mean |u| of the second, over the particles compared", {}},
      {"strain_dev_rms", "1", "RMS over the particles of the difference of deviatoric strain", {}},
      {"strain_dev_uncertainty", "1", "noise floor: as the records state it, else RMS deviatoric strain where |u| is below 2 standard uncertainties", {}},
      {"particles_compared", "1", "particles of the first that have a partner", {}},
      {"displacement_bias_x", length_unit, "mean of u_x of the second minus that of the first", {}},
      {"displacement_bias_y", length_unit, "mean of u_y of the second minus that of the first", {}},
      {"displacement_p95", length_unit, "95th percentile of |u_second - u_first|", {}},
      {"displacement_max", length_unit, "greatest |u_second - u_first|", {}}};
  for (const auto& [name, words] : {std::pair{"strain_dev", "deviatoric log strain"},
                                    {"strain_vol", "ln J"},
                                    {"strain_dev_path", "deviatoric strain along the path"}})
    for (const auto& [what, text] :
         {std::pair{"bias", "mean difference of "}, {"rms", "RMS difference of "},
          {"p95", "95th percentile of the size of the difference of "}, {"max", "greatest difference of "}}) {
      const std::string full = std::string(name) + "_" + what;
      if (full != "strain_dev_rms") series_.push_back({full, "1", std::string(text) + words, {}});
    }
}

// The first time, the last, and evenly between them.
bool Differences::keeps_fields() const {
  if (rows_kept_ >= times_ || times_ < 2) return true;
  const std::size_t k = time_index_, n = times_ - 1, m = rows_kept_ - 1;
  return k == 0 || k * m / n != (k - 1) * m / n;
}

double Differences::path_step(std::vector<Mat2>& before, std::size_t row, const Mat2& F, std::vector<double>& path) {
  if (begun_[row]) path[row] += deviatoric(increment_central(before[row], F));
  before[row] = F;
  return path[row];
}

bool Differences::add(const SideState& first, const SideState& second, const std::vector<Partner>& partners,
                      const std::array<RigidFit, 2>& frame, const std::vector<Vec2>& numerical) {
  auto compared = [&](std::size_t p) { return first.followed[p] && has_partner(partners[p]); };
  if (std::none_of(paired_.begin(), paired_.end(), compared)) return false;
  last_ = Tally{};
  last_.frame = frame;
  snapshot_ = Snapshot{};
  const std::array<bool, 2> known{!first.cov.empty(), !second.cov.empty()};
  const bool keep = keeps_fields();
  const std::array<Mat2, 2> back{frame[0].motion.rotation().transpose(), frame[1].motion.rotation().transpose()};
  std::array<StillZone, 2> still;
  std::array<ScalarStatistics, 2> path_floor;
  std::vector<Vec2> u_first(paired_.size(), no_vector), difference(paired_.size(), no_vector),
      variances(paired_.size(), no_vector);
  if (keep) field_time_.push_back(first.time);

  const auto sample = [&](std::size_t side, std::size_t row, const Vec2& u, const Mat2& F,
                          const std::array<double, 3>* cov) {
    Sample s;
    const RigidMotion& m = frame[side].motion;
    s.u = m.angle == 0 ? Vec2(u - m.shift) : Vec2(m.undo(X_[row] + u) - X_[row]);
    const Mat2 turned = m.angle == 0 ? F : Mat2(back[side] * F);
    const Strain e = log_strain(turned);
    s.dev = deviatoric(e);
    s.vol = volumetric(e);
    s.path = path_step(F_before_[side], row, turned, path_[side]);
    s.cov = cov ? Vec2((*cov)[0], (*cov)[1]) : no_vector;
    return s;
  };
  for (std::size_t row = 0; row < paired_.size(); ++row) {
    const std::size_t p = paired_[row];
    if (!compared(p)) {
      begun_[row] = 0;
      if (keep)
        for (DifferenceField& field : fields_) field.values.push_back(float(not_known));
      continue;
    }
    const PartnerState partner = partner_state(partners[p], second);
    const Sample a = sample(0, row, first.u[p], first.F[p], known[0] ? &first.cov[p] : nullptr);
    const Sample b = sample(1, row, partner.u, partner.F, known[1] ? &partner.cov : nullptr);
    begun_[row] = 1;
    Variance variance =
        budget_.at(a.cov, b.cov, a.u, frame[0].variance_at(X_[row]) + frame[1].variance_at(X_[row]),
                   numerical.empty() ? Vec2(Vec2::Zero()) : numerical[p]);
    // A side that measures, but not the error of this particle.
    if ((known[0] && a.cov.hasNaN()) || (known[1] && b.cov.hasNaN())) variance.measurement = no_vector;
    add_particle(row, a, b, variance);
    still[0].add(a.u, a.trace(), a.dev, a.vol);
    still[1].add(b.u, b.trace(), b.dev, b.vol);
    for (std::size_t s = 0; s < 2; ++s) {
      const Sample& side = s == 0 ? a : b;
      if (side.trace() > 0 && side.u.squaredNorm() < 4 * side.trace() && std::isfinite(side.path))
        path_floor[s].add(side.path);
    }
    const Vec2 d = b.u - a.u;
    u_first[row] = a.u;
    difference[row] = d;
    variances[row] = variance.total();
    if (!keep) continue;
    fields_[0].values.push_back(float(d.x()));
    fields_[1].values.push_back(float(d.y()));
    fields_[2].values.push_back(float(d.norm()));
    fields_[3].values.push_back(float(b.dev - a.dev));
  }
  const auto path_dev = [&](std::size_t s) {
    return path_floor[s].count() >= StillZone::least ? path_floor[s].rms() : not_known;
  };
  last_.floor_dev = combined(known, notes_, &StrainNote::floor_dev, {still[0].dev(), still[1].dev()});
  last_.floor_vol = combined(known, notes_, &StrainNote::floor_vol, {still[0].vol(), still[1].vol()});
  last_.floor_path = combined(known, notes_, &StrainNote::floor_path, {path_dev(0), path_dev(1)});
  total_.floor_dev = larger_known(total_.floor_dev, last_.floor_dev);
  total_.floor_vol = larger_known(total_.floor_vol, last_.floor_vol);
  total_.floor_path = larger_known(total_.floor_path, last_.floor_path);
  for (std::size_t s = 0; s < 2; ++s) cov_known_[s] = cov_known_[s] && known[s];
  rates_.add(first.time, u_first, difference, variances);
  add_series();
  ++time_index_;
  return true;
}

void Differences::add_particle(std::size_t row, const Sample& a, const Sample& b, const Variance& variance) {
  const Vec2 d = b.u - a.u, total = variance.total();
  for (Tally* tally : {&last_, &total_}) {
    const bool begins = tally->displacement.count() == 0;
    tally->displacement.add(d, total.x(), total.y());
    tally->sum_cov_trace[0] += a.trace();
    tally->sum_cov_trace[1] += b.trace();
    tally->sum_measurement += variance.measurement.sum();
    tally->sum_numerical += variance.numerical.sum();
    tally->sum_input += variance.input.sum();
    tally->sum_first += a.u.norm();
    tally->sum_second += b.u.norm();
    raise_peak(a.u.norm(), std::sqrt(a.trace()), begins, tally->peak_first, tally->peak_first_sigma);
    raise_peak(b.u.norm(), std::sqrt(b.trace()), begins, tally->peak_second, tally->peak_second_sigma);
    if (!std::isfinite(a.dev) || !std::isfinite(b.dev)) continue;  // F not positive: no strain
    tally->strain_dev.add(b.dev - a.dev);
    tally->strain_vol.add(b.vol - a.vol);
    if (std::isfinite(a.path) && std::isfinite(b.path)) tally->strain_path.add(b.path - a.path);
  }
  over_displacement_.add(row, d);
  if (std::isfinite(b.dev - a.dev)) over_strain_.add(row, Vec2(b.dev - a.dev, 0));
  snapshot_.particle.push_back(paired_[row]);
  snapshot_.X.push_back(X_[row]);
  snapshot_.u_first.push_back(a.u);
  snapshot_.u_second.push_back(b.u);
  snapshot_.dev_first.push_back(a.dev);
  snapshot_.dev_second.push_back(b.dev);
  snapshot_.variance.push_back(total);
}

void Differences::add_series() {
  const DisplacementStatistics& d = last_.displacement;
  const double count = double(d.count());
  std::vector<double> row{d.rms(), d.rms_uncertainty(), last_.sum_first / count, last_.sum_second / count,
                          rms_or_none(last_.strain_dev), last_.floor_dev, count, d.bias().x(), d.bias().y(), d.p95(),
                          d.max()};
  for (const ScalarStatistics* s : {&last_.strain_dev, &last_.strain_vol, &last_.strain_path}) {
    const bool any = s->count() > 0;
    row.push_back(any ? s->bias() : not_known);
    if (s != &last_.strain_dev) row.push_back(rms_or_none(*s));
    row.push_back(s->p95());
    row.push_back(any ? s->max() : not_known);
  }
  for (std::size_t s = 0; s < row.size(); ++s) series_[s].values.push_back(row[s]);
}

void Differences::take(Comparison& out) {
  out.fields = std::move(fields_);
  out.field_time = std::move(field_time_);
  out.series = std::move(series_);
  for (Series& s : rates_.velocity_series(length_unit_, time_unit_)) {
    s.values.resize(out.time.size(), not_known);  // a comparison of one time has no room for two ends
    out.series.push_back(std::move(s));
  }
  const std::string speed = length_unit_ + "/" + time_unit_;
  const auto add = [&](const std::string& name, const std::string& unit, const std::string& definition, auto&& value) {
    DifferenceField field{"over_time_" + name, unit, definition + ", over the times of each particle", {}};
    for (std::size_t row = 0; row < paired_.size(); ++row) field.values.push_back(float(value(row)));
    out.over_time.push_back(std::move(field));
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
  sizes("velocity", speed, "v_second - v_first", rates_.over_time());
  add("strain_dev_bias", "1", "mean of the deviatoric strain, second minus first",
      [&](std::size_t r) { return over_strain_.bias(r).x(); });
  sizes("strain_dev", "1", "the deviatoric strain's difference", over_strain_);
}

}  // namespace pivnp::compare

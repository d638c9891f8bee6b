// What the differences of strain are uncertain by, one common time after another.
#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/measures/differences.hpp"

namespace pivnp::compare {

namespace {

// Both data sets' floors together, of those that know their error: as the record states it, else as the declared zone
// shows it. One that is not known leaves the whole unknown. `without`: those that count nothing.
double combined(const PerDataSet<bool>& known, const StrainNotes& notes, double StrainNote::*stated,
                const PerDataSet<double>& found, const PerDataSet<bool>& without = {false, false}) {
  double sum = 0;
  bool any = false;
  for (std::size_t s = 0; s < 2; ++s) {
    if (without[s]) {
      any = true;
      continue;
    }
    const bool has = notes[s] && std::isfinite((*notes[s]).*stated);
    if (!has && !known[s]) continue;
    const double floor = has ? (*notes[s]).*stated : found[s];
    sum += floor * floor;
    any = true;
  }
  return any ? std::sqrt(sum) : not_known;
}

// Of a floor that grows with the times: unknown at one of them is unknown.
double larger(double a, double b) { return std::isnan(a) || std::isnan(b) ? not_known : std::max(a, b); }

}  // namespace

std::vector<StrainError> Differences::strain_errors(const DataSetState& first, const DataSetState& second,
                                                    const std::vector<Partner>& partners, const std::vector<PartnerState>& at) const {
  PerDataSet<std::vector<Mat2>> F;
  PerDataSet<std::vector<std::array<double, 3>>> row_cov;
  const Mat2 none = Mat2::Constant(not_known);
  for (std::size_t row = 0; row < paired_.size(); ++row) {
    const std::size_t p = paired_[row];
    const bool compared = first.followed[p] && has_partner(partners[p]);
    F[0].push_back(compared ? first.F[p] : none);
    F[1].push_back(compared ? at[row].F : none);
    if (!first.cov_F.empty()) row_cov[0].push_back(first.cov_F[p]);
    if (!second.cov_F.empty()) row_cov[1].push_back(at[row].cov_F);
  }
  return strain_errors_.of(F, row_cov);
}

void Differences::add_floors(const PerDataSet<bool>& known, const PerDataSet<StillZone>& still) {
  struct Floor {
    double Tally::*floor, Tally::*rest;
    double StrainNote::*stated;
    double (StillZone::*found)() const;
    bool by_covariance;
  };
  // Errors of increments, which a path adds up without their signs, are in no covariance of F.
  for (const Floor& f : {Floor{&Tally::floor_dev, &Tally::rest_dev, &StrainNote::floor_dev, &StillZone::dev, true},
                         Floor{&Tally::floor_vol, &Tally::rest_vol, &StrainNote::floor_vol, &StillZone::vol, true},
                         Floor{&Tally::floor_path, &Tally::rest_path, &StrainNote::floor_path, &StillZone::path, false}}) {
    const PerDataSet<double> found{(still[0].*f.found)(), (still[1].*f.found)()};
    const PerDataSet<bool> own{f.by_covariance && cov_F_known_[0], f.by_covariance && cov_F_known_[1]};
    last_.*f.floor = combined(known, notes_, f.stated, found);
    last_.*f.rest = combined(known, notes_, f.stated, found, own);
    for (double Tally::*of : {f.floor, f.rest}) total_.*of = time_.empty() ? last_.*of : larger(total_.*of, last_.*of);
  }
  for (std::size_t s = 0; s < 2; ++s)
    floor_in_zone_[s] = known[s] && std::isfinite(still[s].dev()) && !(notes_[s] && std::isfinite(notes_[s]->floor_dev));
}

std::optional<Vec2> Differences::mean_strain_uncertainty(bool last) const {
  const Tally& tally = last ? last_ : total_;
  const Vec2 u = (last ? strain_mean_last_ : strain_mean_total_).uncertainty(X_, correlation_);
  if (!u.allFinite() || tally.strain_dev.count() == 0) return std::nullopt;
  return Vec2((u.cwiseAbs2() + (tally.sum_gauge / double(tally.strain_dev.count())).cwiseAbs2()).cwiseSqrt());
}

std::optional<FieldMean::Weighted> Differences::weighted_strain(int which) const {
  if (!cov_F_known_[0] && !cov_F_known_[1]) return std::nullopt;
  const ComparedParticles& last = last_particles_;
  const double rest = which == 0 ? last_.rest_dev : last_.rest_vol;
  std::vector<Vec2> X, difference, random, common;
  for (std::size_t k = 0; k < last.X.size(); ++k) {
    const double d = last.strain_second[k][which] - last.strain_first[k][which];
    if (!std::isfinite(d)) continue;
    const StrainError& e = last.strain_error[k];
    X.push_back(last.X[k]);
    difference.emplace_back(d, 0);
    random.emplace_back(e.random[which], 0);
    common.emplace_back(e.common()[which] + rest * rest, 0);
  }
  return FieldMean::weighted(X, difference, random, common, correlation_);
}

}  // namespace pivnp::compare

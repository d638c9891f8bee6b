#include "compare/differences.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

// One side of one particle at one time, in the frame of the comparison.
struct Sample {
  Vec2 u;
  double dev, vol;
  double cov_uu, cov_vv;  // NaN if not known
};

Sample sample(const Vec2& u, const Mat2& F, const std::array<double, 3>* cov) {
  const Strain e = log_strain(F);
  return {u, deviatoric(e), volumetric(e), cov ? (*cov)[0] : not_known, cov ? (*cov)[1] : not_known};
}

void raise_peak(double magnitude, double sigma, bool begins, double& peak, double& peak_sigma) {
  if (magnitude <= peak && !begins) return;
  peak = magnitude;
  peak_sigma = sigma;
}

void add_to(Tally& tally, const Sample& a, const Sample& b) {
  const bool begins = tally.displacement.count() == 0;
  const double uu = std::isnan(a.cov_uu) ? b.cov_uu : std::isnan(b.cov_uu) ? a.cov_uu : a.cov_uu + b.cov_uu;
  const double vv = std::isnan(a.cov_vv) ? b.cov_vv : std::isnan(b.cov_vv) ? a.cov_vv : a.cov_vv + b.cov_vv;
  tally.displacement.add(b.u - a.u, uu, vv);
  tally.sum_cov_trace[0] += a.cov_uu + a.cov_vv;
  tally.sum_cov_trace[1] += b.cov_uu + b.cov_vv;
  tally.sum_first += a.u.norm();
  tally.sum_second += b.u.norm();
  raise_peak(a.u.norm(), std::sqrt(a.cov_uu + a.cov_vv), begins, tally.peak_first, tally.peak_first_sigma);
  raise_peak(b.u.norm(), std::sqrt(b.cov_uu + b.cov_vv), begins, tally.peak_second, tally.peak_second_sigma);
  if (!std::isfinite(a.dev) || !std::isfinite(b.dev)) return;  // F not positive: no strain
  tally.strain_dev.add(b.dev - a.dev);
  tally.strain_vol.add(b.vol - a.vol);
}

// Both sides' floors together, of those sides that know their error.
double combined(const std::array<bool, 2>& known, double first, double second) {
  if (!known[0] && !known[1]) return not_known;
  return std::sqrt((known[0] ? first * first : 0) + (known[1] ? second * second : 0));
}

double larger_known(double a, double b) { return std::isnan(a) ? b : std::isnan(b) ? a : std::max(a, b); }

}  // namespace

Differences::Differences(std::vector<std::size_t> paired, const std::string& unit) : paired_(std::move(paired)) {
  fields_ = {{"difference_x", unit, "u_x of the second minus that of the first", {}},
             {"difference_y", unit, "u_y of the second minus that of the first", {}},
             {"difference_magnitude", unit, "|u of the second minus u of the first|", {}},
             {"difference_strain_dev", "1", "deviatoric log strain of the second minus that of the first", {}}};
  series_ = {{"displacement_rms", unit, "RMS over the particles of |u_second - u_first|", {}},
             {"displacement_uncertainty", unit, "root mean trace of the covariance of u, sides that know it added", {}},
             {"displacement_mean_first", unit, "mean |u| of the first, over the particles compared", {}},
             {"displacement_mean_second", unit, "mean |u| of the second, over the particles compared", {}},
             {"strain_dev_rms", "1", "RMS over the particles of the difference of deviatoric strain", {}},
             {"strain_dev_uncertainty", "1", "RMS deviatoric strain where |u| is below 2 standard uncertainties", {}},
             {"particles_compared", "1", "particles of the first that have a partner", {}}};
}

bool Differences::add(const SideState& first, const SideState& second, const std::vector<Partner>& partners,
                      const std::array<Vec2, 2>& shift) {
  auto compared = [&](std::size_t p) { return first.followed[p] && has_partner(partners[p]); };
  if (std::none_of(paired_.begin(), paired_.end(), compared)) return false;
  last_ = Tally{};
  last_.shift = shift;
  const std::array<bool, 2> known{!first.cov.empty(), !second.cov.empty()};
  std::array<StillZone, 2> still;
  for (std::size_t p : paired_) {
    if (!compared(p)) {
      for (DifferenceField& field : fields_) field.values.push_back(float(not_known));
      continue;
    }
    const PartnerState partner = partner_state(partners[p], second);
    const Sample a = sample(first.u[p] - shift[0], first.F[p], known[0] ? &first.cov[p] : nullptr);
    const Sample b = sample(partner.u - shift[1], partner.F, known[1] ? &partner.cov : nullptr);
    add_to(last_, a, b);
    add_to(total_, a, b);
    still[0].add(a.u, a.cov_uu + a.cov_vv, a.dev, a.vol);
    still[1].add(b.u, b.cov_uu + b.cov_vv, b.dev, b.vol);
    const Vec2 d = b.u - a.u;
    fields_[0].values.push_back(float(d.x()));
    fields_[1].values.push_back(float(d.y()));
    fields_[2].values.push_back(float(d.norm()));
    fields_[3].values.push_back(float(b.dev - a.dev));
  }
  last_.floor_dev = combined(known, still[0].dev(), still[1].dev());
  last_.floor_vol = combined(known, still[0].vol(), still[1].vol());
  total_.floor_dev = larger_known(total_.floor_dev, last_.floor_dev);
  total_.floor_vol = larger_known(total_.floor_vol, last_.floor_vol);
  for (std::size_t s = 0; s < 2; ++s) cov_known_[s] = cov_known_[s] && known[s];
  add_series();
  return true;
}

void Differences::add_series() {
  const double count = double(last_.displacement.count());
  const std::array<double, 7> row{last_.displacement.rms(), last_.displacement.rms_uncertainty(),
                                  last_.sum_first / count,  last_.sum_second / count,
                                  last_.strain_dev.rms(),   last_.floor_dev,
                                  count};
  for (std::size_t s = 0; s < row.size(); ++s) series_[s].values.push_back(row[s]);
}

}  // namespace pivnp::compare

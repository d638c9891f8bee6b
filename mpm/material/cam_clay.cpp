#include "mpm/material/cam_clay.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/material/strength.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

constexpr HistoryVariable preconsolidation{.name = "preconsolidation",
                                           .unit = "Pa",
                                           .definition = "preconsolidation pressure p_c of modified Cam-Clay",
                                           .recorded = Recorded::declared,
                                           .label = "preconsolidation pressure"};
// Of preconsolidation_pa: the law sees p larger by this tension, or from none no pressure would be reached on the swelling line.
constexpr double tension_share = 1e-3, least_share = 1e-12;
constexpr double most_poisson = 0.45;    // G in proportion to p turns volume into shear energy, and the more of it the nearer to 1/2
constexpr std::size_t memory = 2;  // its place in the history, after strain and work

// p, q and Lode's angle of a stress, tension positive.
struct Meridian {
  double p, q, sin3;  // sin3: 1 in triaxial compression
};

Meridian meridian_of(const Stress& s) {
  const double mean = (s.xx + s.yy + s.zz) / 3, xx = s.xx - mean, yy = s.yy - mean, zz = s.zz - mean;
  const double j2 = 0.5 * (xx * xx + yy * yy + zz * zz) + s.xy * s.xy, j3 = zz * (xx * yy - s.xy * s.xy);
  const double root = std::sqrt(j2);
  const double sin3 = root > 0 ? -1.5 * std::numbers::sqrt3 * (j3 / j2) / root : 1;
  return {-mean, std::numbers::sqrt3 * root, std::clamp(sin3, -1.0, 1.0)};
}

double modulus_ratio(double poisson) { return 1.5 * (1 - 2 * poisson) / (1 + poisson); }

// Stiffness at p = preconsolidation_pa.
Elastic elastic_at_start(const ModifiedCamClay::Constants& c) {
  const double bulk = (1 + c.void_ratio) * c.preconsolidation_pa / c.kappa;
  return {3 * bulk * (1 - 2 * c.poisson), c.poisson};
}

// The part s of the way to the critical state, in plastic volumetric strain, at which residual(s), positive at 0 and negative
// at 1, is zero: regula falsi (Illinois).
template <class Residual>
double part_of_way(double at_start, double scale, Residual&& residual) {
  constexpr int most_steps = 200;
  constexpr double tolerance = 1e-13;
  double a = 0, b = 1, fa = at_start, fb = -scale, s = 0;
  int side = 0;
  for (int k = 0; k < most_steps; ++k) {
    s = b - fb * (b - a) / (fb - fa);
    const double f = residual(s);
    if (std::abs(f) <= tolerance * scale || b - a <= tolerance) return s;
    if (f > 0) {
      if (side == 1) fb *= 0.5;
      a = s, fa = f, side = 1;
    } else {
      if (side == -1) fa *= 0.5;
      b = s, fb = f, side = -1;
    }
  }
  return s;
}

void check_cam_clay(const MaterialOptions& o) {
  require(o.friction_deg > 0, "friction_deg", o.friction_deg, "an angle above 0 (of the critical state)");
  require(o.poisson <= most_poisson, "poisson", o.poisson, "at most " + number(most_poisson) + " with modified_cam_clay");
  const double lambda = *o.own_value("lambda"), kappa = *o.own_value("kappa");
  require(kappa < lambda, "kappa", kappa, "less than lambda");
  if (o.porosity.has_value() == o.own_value("void_ratio").has_value())
    throw MaterialFault("void_ratio", o.porosity ? "given beside porosity, expected one of them" : "missing; expected more than 0, or porosity");
  if (o.porosity && !o.drained)
    throw MaterialFault("porosity", "given with model \"modified_cam_clay\", whose stiffness flowing water does not follow; "
                                    "expected drained = true, or void_ratio");
  if (o.band_thickness_m) refuse("band_thickness_m", *o.band_thickness_m, "none with modified_cam_clay");
}

std::unique_ptr<Material> make_cam_clay(const MaterialOptions& o, double) {
  const double e = o.porosity ? *o.porosity / (1 - *o.porosity) : *o.own_value("void_ratio");
  return std::make_unique<ModifiedCamClay>(ModifiedCamClay::Constants{*o.own_value("lambda"), *o.own_value("kappa"), o.poisson, o.friction_deg,
                                                                      e, o.own_value("ocr").value_or(1), *o.own_value("preconsolidation_pa")});
}

}  // namespace

MaterialModel modified_cam_clay_model() {
  const OptionInfo lambda{.text = "slope of the compression line, v against ln p", .min = 0, .above_min = true};
  const OptionInfo kappa{.text = "slope of the swelling line, v against ln p", .min = 0, .above_min = true};
  const OptionInfo void_ratio{.text = "void ratio at the start; default: that of porosity", .min = 0, .above_min = true};
  const OptionInfo ocr{.text = "preconsolidation over the pressure on the yield surface through the initial stress; default: 1", .min = 1};
  const OptionInfo preconsolidation_pa{.unit = "Pa", .text = "least preconsolidation pressure at the start", .min = 0, .above_min = true};
  return {.name = "modified_cam_clay",
          .text = "critical state of clay: stiffness, strength and volume by one preconsolidation pressure",
          .keys = {{"lambda", true, true, lambda}, {"kappa", true, true, kappa}, {"friction_deg", true}, {"poisson"},
                   {"void_ratio", false, true, void_ratio}, {"ocr", false, true, ocr},
                   {"preconsolidation_pa", true, true, preconsolidation_pa}},
          .history = {plastic_strain, plastic_work, preconsolidation},
          .elastic_keys = false,
          .check = check_cam_clay,
          .make = make_cam_clay,
          .reduce = reduce_cone};
}

ModifiedCamClay::ModifiedCamClay(const Constants& constants)
    : Material(elastic_at_start(constants)),
      c_(constants),
      specific_volume_(1 + constants.void_ratio),
      shear_per_bulk_(modulus_ratio(constants.poisson)),
      tension_(tension_share * constants.preconsolidation_pa),
      least_p_(least_share * constants.preconsolidation_pa) {
  const double sine = std::sin(radians(c_.friction_deg));
  slope_ = 6 * sine / (3 - sine);
  third_ = std::pow((3 - sine) / (3 + sine), 4);
}

double ModifiedCamClay::slope(double sin3) const {
  return slope_ * std::sqrt(std::sqrt(2 * third_ / (1 + third_ - (1 - third_) * sin3)));
}

void ModifiedCamClay::update_point(const StressBatch& b, std::size_t k) const {
  const double volume = b.de_xx[k] + b.de_yy[k] + b.de_zz[k], J = b.J[k], J_before = J * std::exp(-volume);
  Stress s = rotated(b, k);
  for (double* component : {&s.xx, &s.yy, &s.zz, &s.xy}) *component /= J_before;
  Meridian now = meridian_of(s);
  double mean = now.p;
  now.p += tension_;
  double& p_c = b.history[memory][k];
  if (p_c == 0) {
    const double p = std::max(now.p, least_p_), ratio = std::min(now.q / slope(now.sin3), most_at_start(p));
    p_c = std::max(c_.preconsolidation_pa, c_.ocr * (p + ratio * ratio / p));
  }
  if (now.p < least_p_) {  // no shear without pressure
    s = {0, 0, 0, 0};
    mean = 0;
    now = {least_p_, 0, 1};
  }
  // The elastic trial; v in the middle of the step, G by the mean of p.
  const double v = specific_volume_ * J_before * std::exp(0.5 * volume), per_kappa = v / c_.kappa;
  const double p_trial = std::max(now.p * std::exp(-per_kappa * volume), least_p_);
  const double shear = shear_per_bulk_ * per_kappa * 0.5 * (now.p + p_trial), third = volume / 3;
  const Stress dev{s.xx + mean + 2 * shear * (b.de_xx[k] - third), s.yy + mean + 2 * shear * (b.de_yy[k] - third),
                   s.zz + mean + 2 * shear * (b.de_zz[k] - third), s.xy + 2 * shear * b.de_xy[k]};
  const Meridian trial = meridian_of(dev);
  const double M = slope(trial.sin3), per_M2 = 1 / (M * M);
  double p = p_trial, keep = 1;
  if (trial.q * trial.q * per_M2 + p_trial * (p_trial - p_c) > 0) {
    const double per_hardening = v / (c_.lambda - c_.kappa), both = per_kappa + per_hardening;
    const double to_critical = std::log(2 * p_trial / p_c), x_critical = to_critical / both, p_c_before = p_c;
    double multiplier = 0;
    const auto residual = [&](double part) {
      const double x = part * x_critical, left = to_critical * (1 - part);
      p = p_trial * std::exp(-per_kappa * x);
      p_c = p_c_before * std::exp(per_hardening * x);
      // x over 2 p - p_c = p_c (exp(left) - 1).
      multiplier = part / both * (left != 0 ? to_critical / std::expm1(left) : 1 / (1 - part)) / p_c;
      keep = part < 1 ? 1 / (1 + 6 * shear * multiplier * per_M2) : 0.0;
      return keep * keep * trial.q * trial.q * per_M2 + p * (p - p_c);
    };
    const double at_start = residual(0), scale = p_trial * p_trial + p_c * p_c;
    residual(part_of_way(at_start, scale, residual));
    p = std::max(p, least_p_);
    b.history[plastic::strain][k] += 2 * multiplier * keep * trial.q * per_M2;
  }
  const Stress before{b.xx[k], b.yy[k], b.zz[k], b.xy[k]};
  mean = p - tension_;
  store(b, k, {J * (keep * dev.xx - mean), J * (keep * dev.yy - mean), J * (keep * dev.zz - mean), J * keep * dev.xy});
  // What was done and is not stored: with this, energy() closes the balance whatever path was taken.
  const Stress from = turned_by(b.spin[k], before);
  const double done = 0.5 * ((from.xx + b.xx[k]) * b.de_xx[k] + (from.yy + b.yy[k]) * b.de_yy[k] + (from.zz + b.zz[k]) * b.de_zz[k]) +
                      (from.xy + b.xy[k]) * b.de_xy[k];
  b.history[plastic::work][k] += done - (stored({b.xx[k], b.yy[k], b.zz[k], b.xy[k]}, J) - stored(before, J_before));
}

// q/M: of the critical state, or on the yield surface of preconsolidation_pa where that is more.
double ModifiedCamClay::most_at_start(double p) const {
  return std::max(p, std::sqrt(p * std::max(0.0, c_.preconsolidation_pa - p)));
}

// Elastic up to that.
void ModifiedCamClay::find_start(const StressBatch& b, std::size_t k) const {
  const Stress s = elastic_trial(elastic_, b, k);
  const Meridian at = meridian_of(s);
  if (at.p + tension_ <= 0) return store(b, k, {0, 0, 0, 0});
  const double keep = at.q > 0 ? std::min(1.0, slope(at.sin3) * most_at_start(at.p + tension_) / at.q) : 1;
  store(b, k, {keep * (s.xx + at.p) - at.p, keep * (s.yy + at.p) - at.p, keep * (s.zz + at.p) - at.p, keep * s.xy});
}

void ModifiedCamClay::update(const StressBatch& batch) const {
  for (std::size_t k = 0; k < batch.size; ++k) {
    if (batch.dt == 0 && batch.history[memory][k] == 0) find_start(batch, k);
    else update_point(batch, k);
  }
}

// J (kappa/v (p - a - a ln(p/a)) + q^2/(6 G)), v = v0 J, with p larger by the tension a.
double ModifiedCamClay::stored(const Stress& tau, double J) const {
  const Meridian at = meridian_of(tau);
  const double p = std::max(at.p / J + tension_, least_p_), q = at.q / J;
  return c_.kappa / specific_volume_ * (p - tension_ - tension_ * std::log(p / tension_) + q * q / (6 * shear_per_bulk_ * p));
}

double ModifiedCamClay::energy(const StressBatch& batch, std::size_t k) const {
  return stored({batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]}, batch.J[k]);
}

double ModifiedCamClay::stiffness(const StressBatch& batch) const {
  double greatest = c_.preconsolidation_pa;
  for (std::size_t k = 0; k < batch.size; ++k)
    greatest = std::max(greatest, -(batch.xx[k] + batch.yy[k] + batch.zz[k]) / 3 * batch.J[k]);
  return elastic_.p_wave_modulus() * greatest / c_.preconsolidation_pa;
}

}  // namespace pivnp::mpm

#include "mpm/material/mohr_coulomb.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/core/math.hpp"

namespace pivnp::mpm {

namespace {

using Principal3 = std::array<double, 3>;

double dot(const Principal3& a, const Principal3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Solves the n x n system (n <= 3) by elimination with pivoting; false if it is singular.
bool solve(int n, double a[3][3], double* b) {
  for (int c = 0; c < n; ++c) {
    int pivot = c;
    for (int r = c + 1; r < n; ++r)
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    if (!(std::abs(a[pivot][c]) > 1e-12 * std::abs(a[0][0]))) return false;
    std::swap(b[c], b[pivot]);
    for (int q = 0; q < n; ++q) std::swap(a[c][q], a[pivot][q]);
    for (int r = c + 1; r < n; ++r) {
      const double factor = a[r][c] / a[c][c];
      for (int q = c; q < n; ++q) a[r][q] -= factor * a[c][q];
      b[r] -= factor * b[c];
    }
  }
  for (int c = n - 1; c >= 0; --c) {
    for (int q = c + 1; q < n; ++q) b[c] -= a[c][q] * b[q];
    b[c] /= a[c][c];
  }
  return true;
}

std::unique_ptr<Material> make_mohr_coulomb(const MaterialOptions& o, double cell_m) {
  const Elastic elastic(o.young_pa, o.poisson);
  const StrengthLaw strength(o, cell_m);
  if (!strength.constant()) return std::make_unique<VariableMohrCoulomb>(elastic, strength, o.tension_pa);
  return std::make_unique<MohrCoulomb>(elastic, o.friction_deg, o.dilatancy_deg, o.cohesion_pa, o.tension_pa);
}

}  // namespace

MaterialModel mohr_coulomb_model() {
  return {.name = "mohr_coulomb",
          .text = "friction and cohesion, the six planes returned to in closed form",
          .keys = soil_keys(),
          .history = cone_history(),
          .check = check_soil,
          .make = make_mohr_coulomb,
          .reduce = reduce_cone};
}

// Mohr-Coulomb without friction and without a limit on tension.
MaterialModel tresca_model() {
  return {.name = "tresca",
          .text = "undrained clay: half the greatest stress difference is bounded",
          .keys = {{"shear_strength_pa", true}},
          .history = cone_history(),
          .make = [](const MaterialOptions& o, double) -> std::unique_ptr<Material> {
            return std::make_unique<MohrCoulomb>(Elastic(o.young_pa, o.poisson), 0, 0, o.shear_strength_pa,
                                                 std::numeric_limits<double>::max());
          },
          .reduce = [](MaterialOptions& o, double factor) { o.shear_strength_pa /= factor; }};
}

MohrCoulomb::MohrCoulomb(const Elastic& elastic, double friction_deg, double dilatancy_deg, double cohesion_pa,
                         double tension_pa)
    : Material(elastic),
      sin_friction_(std::sin(radians(friction_deg))),
      cos_friction_(std::cos(radians(friction_deg))),
      sin_dilatancy_(std::sin(radians(dilatancy_deg))),
      cohesion_(cohesion_pa),
      tension_(tension_pa),
      cone_(constants()) {}

double MohrCoulomb::yield(double xx, double yy, double zz, double xy) const {
  const double mean = 0.5 * (xx + yy), radius = std::hypot(0.5 * (xx - yy), xy);
  const double high = std::max(mean + radius, zz), low = std::min(mean - radius, zz);
  const double shear = (1 + sin_friction_) * high - (1 - sin_friction_) * low - 2 * cohesion_ * cos_friction_;
  const bool cut_off = tension_ * sin_friction_ < cohesion_ * cos_friction_;
  return cut_off ? std::max(shear, high - tension_) : shear;
}

MohrCoulomb::Plane MohrCoulomb::shear_plane(int i, int j, double cohesion_term) const {
  Plane plane{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, cohesion_term};
  plane.normal[i] = 1 + sin_friction_;
  plane.normal[j] = -(1 - sin_friction_);
  plane.flow[i] = 1 + sin_dilatancy_;
  plane.flow[j] = -(1 - sin_dilatancy_);
  for (int q = 0; q < 3; ++q)
    plane.d_flow[q] = elastic_.lambda * 2 * sin_dilatancy_ + 2 * elastic_.shear * plane.flow[q];
  return plane;
}

MohrCoulomb::Return MohrCoulomb::return_to_cone(const Principal& trial, double cohesion_term, double apex) const {
  const double round_off = 1e-12 * (std::abs(trial[0]) + std::abs(trial[2]) + cohesion_term);
  const Plane main = shear_plane(0, 2, cohesion_term);
  const double excess = dot(main.normal, trial) - main.limit;
  const double hardness = dot(main.normal, main.d_flow);
  const double amount = excess / hardness;
  Principal s;
  for (int q = 0; q < 3; ++q) s[q] = trial[q] - amount * main.d_flow[q];
  if (s[0] >= s[1] - round_off && s[1] >= s[2] - round_off && s[0] <= apex + round_off) return {s, apex};

  // Two planes: the middle stress has caught up with the smallest (f_13, f_12) or with the largest (f_13, f_23).
  for (const bool low_edge : {s[1] < s[2], !(s[1] < s[2])}) {
    const Plane second = low_edge ? shear_plane(0, 1, cohesion_term) : shear_plane(1, 2, cohesion_term);
    double a[3][3] = {{hardness, dot(main.normal, second.d_flow), 0},
                      {dot(second.normal, main.d_flow), dot(second.normal, second.d_flow), 0},
                      {0, 0, 0}};
    double amounts[3] = {excess, dot(second.normal, trial) - second.limit, 0};
    if (!solve(2, a, amounts) || amounts[0] < 0 || amounts[1] < 0) continue;
    Principal e;
    for (int q = 0; q < 3; ++q) e[q] = trial[q] - amounts[0] * main.d_flow[q] - amounts[1] * second.d_flow[q];
    if (e[0] <= apex + round_off && e[0] >= std::max(e[1], e[2]) - round_off &&
        e[2] <= std::min(e[0], e[1]) + round_off)
      return {e, apex};
  }
  return {{apex, apex, apex}, apex};
}

// With normal stresses in order, what is active besides the cut-off t_1 follows from the stress that remains: the
// planes t_2, t_3, f_13, f_12 or f_23 beside it meet in the points (T, T, T), (T, q, q) and (T, T, q), q the smallest
// stress that f_13 lets stand beside T. Each candidate is what its planes ask for, and is right where plastic strains,
// by which it departs from the trial stress, are what these planes can give: amounts that are not negative (Clausen et
// al. 2006 have the same regions by planes between them).
MohrCoulomb::Return MohrCoulomb::return_with_cut_off(const Principal& trial, double cohesion_term,
                                                     double tension) const {
  const double scale = std::abs(trial[0]) + std::abs(trial[2]) + cohesion_term + tension, nu = elastic_.poisson;
  const double least = ((1 + sin_friction_) * tension - cohesion_term) / (1 - sin_friction_);
  const double shear_flow = (1 + sin_dilatancy_) / (1 - sin_dilatancy_);
  const Principal over{trial[0] - tension, trial[1] - tension, trial[2] - tension};
  // Young's modulus times the plastic strain.
  const auto strain = [&](const Principal& s) -> Principal {
    const Principal drop{trial[0] - s[0], trial[1] - s[1], trial[2] - s[2]};
    const double by_trace = nu * (drop[0] + drop[1] + drop[2]);
    return {(1 + nu) * drop[0] - by_trace, (1 + nu) * drop[1] - by_trace, (1 + nu) * drop[2] - by_trace};
  };
  for (const double round_off : {1e-12 * scale, 1e-9 * scale}) {
    const auto within = [&](double s) { return s <= tension + round_off && s >= least - round_off; };
    const auto positive = [&](double amount) { return amount >= -round_off; };
    const double across = nu / (1 - nu) * over[0];
    if (const Principal s{tension, trial[1] - across, trial[2] - across};
        positive(over[0]) && s[1] <= tension + round_off && within(s[2]))
      return {s, tension};
    if (const Principal s{tension, tension, trial[2] - nu * (over[0] + over[1])};
        within(s[2]) && positive(strain(s)[1]))
      return {s, tension};
    if (const Principal s{tension, tension, tension}; positive(strain(s)[2])) return {s, tension};
    if (const Principal s{tension, trial[1] - nu * (over[0] + trial[2] - least), least}; within(s[1])) {
      const Principal e = strain(s);
      if (positive(-e[2]) && positive(e[0] + shear_flow * e[2])) return {s, tension};
    }
    if (const Principal s{tension, least, least}; true) {
      const Principal e = strain(s);
      if (positive(-e[1]) && positive(-e[2]) && positive(e[0] + shear_flow * (e[1] + e[2]))) return {s, tension};
    }
    if (const Principal s{tension, tension, least}; true) {
      const Principal e = strain(s);
      if (positive(e[0]) && positive(e[1]) && positive(-e[2]) && positive(e[0] + e[1] + shear_flow * e[2]))
        return {s, tension};
    }
  }
  // No set of planes can (possible without normality only): the vertex.
  return {{tension, tension, tension}, tension};
}

MohrCoulomb::Return MohrCoulomb::return_to_surface(const Principal& trial, double J, double tension) const {
  const double cohesion_term = 2 * cohesion_ * cos_friction_ * J;
  const double apex = sin_friction_ > 0 ? cohesion_ * J * cos_friction_ / sin_friction_
                                        : std::numeric_limits<double>::infinity();
  const double shear = (1 + sin_friction_) * trial[0] - (1 - sin_friction_) * trial[2] - cohesion_term;
  if (tension * J >= apex) return return_to_cone(trial, cohesion_term, apex);
  if (shear > 0) {
    const Return cone = return_to_cone(trial, cohesion_term, apex);
    if (std::max(cone.stress[0], cone.stress[1]) <= tension * J) return cone;
  }
  return return_with_cut_off(trial, cohesion_term, tension * J);
}

void MohrCoulomb::return_point(const StressBatch& batch, std::size_t k, Stress trial) const {
  const double mean = 0.5 * (trial.xx + trial.yy), half = 0.5 * (trial.xx - trial.yy);
  const double radius = std::sqrt(half * half + trial.xy * trial.xy);
  const double tension = batch.flags[plastic::separated][k] ? 0.0 : tension_;
  const double high = std::max(mean + radius, trial.zz), low = std::min(mean - radius, trial.zz);
  const double shear = (1 + sin_friction_) * high - (1 - sin_friction_) * low -
                       2 * cohesion_ * cos_friction_ * batch.J[k];
  const bool cut_off = tension * sin_friction_ < cohesion_ * cos_friction_;
  if (shear <= 0 && !(cut_off && high > tension * batch.J[k])) return store(batch, k, trial);

  // Sorted principal stresses; `place` remembers which is which (0, 1 in the plane, 2 out of it).
  const Principal values{mean + radius, mean - radius, trial.zz};
  std::array<int, 3> place{0, 1, 2};
  if (values[2] > values[1]) std::swap(place[1], place[2]);
  if (values[2] > values[0]) std::swap(place[0], place[1]);
  const Principal sorted{values[place[0]], values[place[1]], values[place[2]]};
  const Return back = return_to_surface(sorted, batch.J[k], tension);

  Principal stress, plastic;
  for (int q = 0; q < 3; ++q) stress[place[q]] = back.stress[q];
  const Elastic& e = elastic_;
  const Principal drop{values[0] - stress[0], values[1] - stress[1], values[2] - stress[2]};
  const double trace = drop[0] + drop[1] + drop[2];
  for (int q = 0; q < 3; ++q) plastic[q] = ((1 + e.poisson) * drop[q] - e.poisson * trace) / e.young;
  const double volumetric = plastic[0] + plastic[1] + plastic[2];
  batch.history[plastic::work][k] += dot(stress, plastic);
  for (double& p : plastic) p -= volumetric / 3;
  batch.history[plastic::strain][k] += std::sqrt(2.0 / 3.0 * dot(plastic, plastic));
  // Both stresses in the plane at the limit (the one across it may lag): the point has come apart.
  const double limit = back.limit - 1e-9 * (std::abs(sorted[0]) + std::abs(sorted[2]));
  if (volumetric > 0 && stress[0] >= limit && stress[1] >= limit) {
    batch.history[plastic::opening][k] = volumetric;
    batch.flags[plastic::separated][k] = 1;
  }
  const double new_mean = 0.5 * (stress[0] + stress[1]), new_radius = 0.5 * (stress[0] - stress[1]);
  const double c2 = radius > 0 ? half / radius : 1, s2 = radius > 0 ? trial.xy / radius : 0;
  store(batch, k, {new_mean + new_radius * c2, new_mean - new_radius * c2, stress[2], new_radius * s2});
}

bool MohrCoulomb::stays_open(const Elastic& elastic, const StressBatch& batch, std::size_t k) {
  const double left = batch.history[plastic::opening][k] + (batch.de_xx[k] + batch.de_yy[k] + batch.de_zz[k]);
  if (!(batch.history[plastic::opening][k] > 0 && left > 0)) return false;
  // Free of stress. (A limit above zero that was reached on opening is let go here.)
  batch.history[plastic::work][k] += elastic.energy(batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]);
  batch.history[plastic::opening][k] = left;
  store(batch, k, {0, 0, 0, 0});
  return true;
}

void MohrCoulomb::update_point(const StressBatch& batch, std::size_t k) const {
  if (batch.history[plastic::opening][k] == 0) return return_point(batch, k, elastic_trial(elastic_, batch, k));
  if (stays_open(elastic_, batch, k)) return;
  const double volumetric = batch.de_xx[k] + batch.de_yy[k] + batch.de_zz[k];
  const double left = batch.history[plastic::opening][k] + volumetric;
  Stress trial{0, 0, 0, 0};
  batch.history[plastic::work][k] += elastic_.energy(batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]);
  batch.history[plastic::opening][k] = 0;
  // The part of the compression that is left over, and the distortion of that part of the step.
  const double share = volumetric < 0 ? left / volumetric : 0;
  add_elastic(elastic_, share * batch.de_xx[k], share * batch.de_yy[k], share * batch.de_zz[k], share * batch.de_xy[k],
              trial);
  return_point(batch, k, trial);
}

void MohrCoulomb::update(const StressBatch& batch) const {
  update_in_lanes(
      batch, [&](const StressBatch& part, std::uint32_t* rare) { return cone_lanes(elastic_, cone_, part, rare); },
      [&](const StressBatch& b, std::size_t k) { update_point(b, k); });
}

ConeConstants MohrCoulomb::constants() const {
  ConeConstants c{};
  c.sin_friction = sin_friction_;
  c.sin_dilatancy = sin_dilatancy_;
  c.cohesion_term = 2 * cohesion_ * cos_friction_;
  c.tension = tension_;
  return c;
}

void VariableMohrCoulomb::update(const StressBatch& batch) const {
  const auto lanes = [&](const StressBatch& part, std::uint32_t* rare) {
    const double* history = part.softened_by ? part.softened_by : part.history[plastic::strain];
    return changing_cone_lanes(elastic_, strength_.constants(), tension_, history, part, rare);
  };
  update_in_lanes(batch, lanes, [&](const StressBatch& b, std::size_t k) {
    if (MohrCoulomb::stays_open(elastic_, b, k)) return;
    const double pressure = -(b.xx[k] + b.yy[k] + b.zz[k]) / (3 * b.J[k]);
    const double history = b.softened_by ? b.softened_by[k] : b.history[plastic::strain][k];
    MohrCoulomb(elastic_, strength_.at(history, pressure), tension_).update_point(b, k);
  });
}

}  // namespace pivnp::mpm

#include "pivnp/core/particles/derived.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp {

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

bool alive(ParticleStatus s) { return s == ParticleStatus::active || s == ParticleStatus::flagged; }

// Derivative at t of the parabola through three points (Lagrange); any spacing, second order.
double parabola_slope(const std::array<double, 3>& t, const std::array<double, 3>& f, double at) {
  const double a = (2 * at - t[1] - t[2]) / ((t[0] - t[1]) * (t[0] - t[2]));
  const double b = (2 * at - t[0] - t[2]) / ((t[1] - t[0]) * (t[1] - t[2]));
  const double c = (2 * at - t[0] - t[1]) / ((t[2] - t[0]) * (t[2] - t[1]));
  return a * f[0] + b * f[1] + c * f[2];
}

// Of a strain or of its rate; `which` is the end of the field's name.
double component(const Strain& e, std::string_view which) {
  if (which == "xx") return e.xx;
  if (which == "yy") return e.yy;
  if (which == "xy") return e.xy;
  if (which == "vol") return volumetric(e);
  if (which == "dev") return deviatoric(e);
  const Principal q = principal(e);
  return which == "1" ? q.first : which == "2" ? q.second : q.angle;
}

}  // namespace

std::vector<DerivedField> derived_fields() {
  std::vector<DerivedField> fields = {
      {"displacement_x", "L", "u_x since the first frame", "displacement x"},
      {"displacement_y", "L", "u_y since the first frame", "displacement y"},
      {"displacement_magnitude", "L", "|u|", "displacement"},
      {"velocity_x", "L/T", "du_x/dt, second-order differences over the frames, or the source's own"},
      {"velocity_y", "L/T", "du_y/dt, likewise"},
      {"velocity_magnitude", "L/T", "|v|", "velocity"},
      {"acceleration_x", "L/T^2", "dv_x/dt, second-order differences over the frames"},
      {"acceleration_y", "L/T^2", "dv_y/dt, likewise"},
      {"acceleration_magnitude", "L/T^2", "|a|", "acceleration"},
  };
  std::vector<DerivedField> strains = {
      {"strain_xx", "1", "xx of the logarithmic strain 1/2 ln(F F^T)"},
      {"strain_yy", "1", "yy of the logarithmic strain"},
      {"strain_xy", "1", "xy of the logarithmic strain (tensor component)"},
      {"strain_vol", "1", "volumetric strain ln J", "volumetric strain"},
      {"strain_dev", "1", "sqrt(2/3 e:e) of the deviator of the logarithmic strain, plane strain", "deviatoric strain"},
      {"strain_1", "1", "greater principal logarithmic strain", "major principal strain"},
      {"strain_2", "1", "smaller principal logarithmic strain", "minor principal strain"},
      {"strain_angle", "rad", "direction of strain_1 from the x axis", "direction of the major principal strain"},
      {"J", "1", "det F", "volume ratio J"},
      {"strain_dev_path", "1", "sum over frames of sqrt(2/3 de:de), de the deviator of the strain increment",
       "deviatoric strain along the path"},
      {"strain_rate_xx", "1/T", "xx of the rate of deformation, the symmetric part of (dF/dt) F^-1; dF/dt by second-order "
                                "differences over the frames"},
      {"strain_rate_yy", "1/T", "yy of the rate of deformation"},
      {"strain_rate_xy", "1/T", "xy of the rate of deformation (tensor component)"},
      {"strain_rate_vol", "1/T", "rate of volume change, xx + yy of the rate of deformation"},
      {"strain_rate_dev", "1/T", "sqrt(2/3 d:d) of the deviator of the rate of deformation, plane strain"},
      {"strain_rate_1", "1/T", "greater principal rate of deformation"},
      {"strain_rate_2", "1/T", "smaller principal rate of deformation"},
      {"strain_rate_angle", "rad", "direction of strain_rate_1 from the x axis"},
      {"strain_sum_xx", "1", "sum of small-strain increments (the thesis' measure; not objective)"},
      {"strain_sum_yy", "1", "sum of small-strain increments"},
      {"strain_sum_xy", "1", "sum of small-strain increments"},
      {"strain_sum_dev", "1", "sqrt(2/3 e:e) of the deviator of the summed strain", "summed deviatoric strain"},
  };
  for (DerivedField& field : strains) field.strain = true;
  fields.insert(fields.end(), strains.begin(), strains.end());
  fields.push_back({"mean_stress", "Pa", "(s_xx + s_yy + s_zz)/3, tension positive", "mean stress", "stress"});
  for (DerivedField& field : fields)
    if (field.label.empty()) {
      field.label = field.name;
      std::replace(field.label.begin(), field.label.end(), '_', ' ');
    }
  for (const MotionField& row : motion_fields()) {
    if (row.member) continue;
    const std::vector<std::string> components = row.component_names();
    for (std::size_t c = 0; c < components.size(); ++c) {
      const std::string& which = components[c];
      fields.push_back({which.empty() ? row.name : row.name + "_" + which, row.unit, row.definition,
                        which.empty() ? row.label : row.label + " " + which, row.name, c});
    }
  }
  return fields;
}

DerivedField derived_field(std::string_view name) {
  std::vector<DerivedField> all = derived_fields();
  const auto it = std::find_if(all.begin(), all.end(), [&](const DerivedField& f) { return f.name == name; });
  if (it != all.end()) return *it;
  std::vector<std::string> names;
  for (const DerivedField& f : all) names.push_back(f.name);
  throw InputError("unknown field '" + std::string(name) + "'" + did_you_mean(std::string(name), names));
}

struct DerivedReader::State {
  const MotionSource& motion;
  bool central;

  // A few frames around the last one asked for.
  std::vector<std::pair<std::size_t, MotionFrame>> cache;

  // Path sums up to and including frame `summed`.
  std::optional<std::size_t> summed;
  std::vector<Mat2> F_before;
  std::vector<double> path;
  std::vector<Strain> sum;

  State(const MotionSource& m, bool c) : motion(m), central(c) {}

  const MotionFrame& frame(std::size_t k) {
    for (const auto& [index, held] : cache)
      if (index == k) return held;
    if (cache.size() >= 8) cache.erase(cache.begin());
    cache.emplace_back(k, motion.frame(k));
    return cache.back().second;
  }

  // Up to three consecutive frames of the particle's life around k, nearest first choice: centred.
  double difference(std::size_t p, std::size_t k, const auto& value_at) {
    const std::vector<double>& t = motion.times();
    auto lives = [&](std::size_t q) { return q < t.size() && alive(frame(q).status[p]); };
    std::size_t from = k, to = k;
    while (to - from < 2) {
      if (from > 0 && k - from <= to - k && lives(from - 1)) --from;
      else if (lives(to + 1)) ++to;
      else if (from > 0 && lives(from - 1)) --from;
      else break;
    }
    if (to == from) return nan_value;
    if (to - from == 1) return (value_at(to) - value_at(from)) / (t[to] - t[from]);
    return parabola_slope({t[from], t[from + 1], t[to]}, {value_at(from), value_at(from + 1), value_at(to)}, t[k]);
  }

  double velocity(std::size_t p, std::size_t k, int axis) {
    if (!frame(k).v.empty()) return double(frame(k).v[p][std::size_t(axis)]);
    return difference(p, k, [&](std::size_t q) { return double(frame(q).u[p][std::size_t(axis)]); });
  }

  double acceleration(std::size_t p, std::size_t k, int axis) {
    return difference(p, k, [&](std::size_t q) { return velocity(p, q, axis); });
  }

  // The symmetric part of (dF/dt) F^-1.
  Strain rate(std::size_t p, std::size_t k) {
    std::array<double, 4> slope;
    for (std::size_t c = 0; c < 4; ++c)
      slope[c] = difference(p, k, [&](std::size_t q) { return double(frame(q).F[p][c]); });
    Mat2 change;
    change << slope[0], slope[1], slope[2], slope[3];
    const Mat2 L = change * matrix(frame(k).F[p]).inverse();
    return {L(0, 0), L(1, 1), (L(0, 1) + L(1, 0)) / 2};
  }

  void sum_to(std::size_t k) {
    const std::size_t count = motion.particles().size();
    if (!summed || *summed > k) {
      summed.reset();
      F_before.assign(count, Mat2::Identity());
      path.assign(count, 0.0);
      sum.assign(count, Strain{});
    }
    for (std::size_t q = summed ? *summed + 1 : 0; q <= k; ++q) {
      const MotionFrame now = motion.frame(q);
      for (std::size_t p = 0; p < count; ++p) {
        if (!alive(now.status[p])) continue;
        const Mat2 F = matrix(now.F[p]);
        const Strain de = central ? increment_central(F_before[p], F) : increment_forward(F_before[p], F);
        sum[p].xx += de.xx;
        sum[p].yy += de.yy;
        sum[p].xy += de.xy;
        path[p] += deviatoric(de);
        F_before[p] = F;
      }
      summed = q;
    }
  }
};

DerivedReader::DerivedReader(const MotionSource& motion, bool central)
    : state_(std::make_unique<State>(motion, central)) {}
DerivedReader::~DerivedReader() = default;

std::vector<double> DerivedReader::values(std::string_view name, std::size_t k) {
  const DerivedField field = derived_field(name);
  State& s = *state_;
  const std::size_t count = s.motion.particles().size();
  std::vector<double> out(count, nan_value);
  const MotionFrame now = s.frame(k);

  auto each = [&](const auto& value) {
    for (std::size_t p = 0; p < count; ++p)
      if (alive(now.status[p])) out[p] = value(p);
  };
  const int axis = name.ends_with("_y") ? 1 : 0;
  const bool magnitude = name.ends_with("_magnitude");

  if (!field.source.empty()) {
    const FieldValues* values = now.find(field.source);
    if (!values) return out;
    if (name == "mean_stress")
      each([&](std::size_t p) {
        return (double((*values)(p, 0)) + double((*values)(p, 1)) + double((*values)(p, 2))) / 3;
      });
    else
      each([&](std::size_t p) { return double((*values)(p, field.component)); });
  } else if (name.starts_with("displacement_"))
    each([&](std::size_t p) { return magnitude ? std::hypot(now.u[p][0], now.u[p][1]) : double(now.u[p][std::size_t(axis)]); });
  else if (name.starts_with("velocity_"))
    each([&](std::size_t p) { return magnitude ? std::hypot(s.velocity(p, k, 0), s.velocity(p, k, 1)) : s.velocity(p, k, axis); });
  else if (name.starts_with("acceleration_"))
    each([&](std::size_t p) { return magnitude ? std::hypot(s.acceleration(p, k, 0), s.acceleration(p, k, 1)) : s.acceleration(p, k, axis); });
  else if (name == "strain_dev_path" || name.starts_with("strain_sum_")) {
    s.sum_to(k);
    each([&](std::size_t p) {
      if (name == "strain_dev_path") return s.path[p];
      if (name == "strain_sum_xx") return s.sum[p].xx;
      if (name == "strain_sum_yy") return s.sum[p].yy;
      if (name == "strain_sum_xy") return s.sum[p].xy;
      return deviatoric(s.sum[p]);
    });
  } else if (name == "J")
    each([&](std::size_t p) { return matrix(now.F[p]).determinant(); });
  else if (name.starts_with("strain_rate_"))
    each([&](std::size_t p) { return component(s.rate(p, k), name.substr(12)); });
  else if (name.starts_with("strain_"))
    each([&](std::size_t p) { return component(log_strain(matrix(now.F[p])), name.substr(7)); });
  return out;
}

}  // namespace pivnp

#include "pivnp/core/particles/derived.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "pivnp/core/error.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp {

namespace {

// Derivative at t of the parabola through three points (Lagrange); any spacing, second order.
double parabola_slope(const std::array<double, 3>& t, const std::array<double, 3>& f, double at) {
  const double a = (2 * at - t[1] - t[2]) / ((t[0] - t[1]) * (t[0] - t[2]));
  const double b = (2 * at - t[0] - t[2]) / ((t[1] - t[0]) * (t[1] - t[2]));
  const double c = (2 * at - t[0] - t[1]) / ((t[2] - t[0]) * (t[2] - t[1]));
  return a * f[0] + b * f[1] + c * f[2];
}

double xx(const Strain& e) { return e.xx; }
double yy(const Strain& e) { return e.yy; }
double xy(const Strain& e) { return e.xy; }
double major(const Strain& e) { return principal(e).first; }
double minor(const Strain& e) { return principal(e).second; }
double direction(const Strain& e) { return principal(e).angle; }

}  // namespace

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

namespace {

using State = DerivedReader::State;

// Value of a living particle p at frame k, which `now` is.
using Value = std::function<double(State&, const MotionFrame& now, std::size_t p, std::size_t k)>;

struct Row {
  DerivedField field;
  Value value;
  bool sums = false;  // of the path up to the frame
};

Value of_strain(double (*of)(const Strain&)) {
  return [of](State&, const MotionFrame& now, std::size_t p, std::size_t) { return of(log_strain(matrix(now.F[p]))); };
}
Value of_rate(double (*of)(const Strain&)) {
  return [of](State& s, const MotionFrame&, std::size_t p, std::size_t k) { return of(s.rate(p, k)); };
}
Value of_sum(double (*of)(const Strain&)) {
  return [of](State& s, const MotionFrame&, std::size_t p, std::size_t) { return of(s.sum[p]); };
}
Value displacement(int axis) {
  return [axis](State&, const MotionFrame& now, std::size_t p, std::size_t) { return double(now.u[p][std::size_t(axis)]); };
}
Value velocity(int axis) {
  return [axis](State& s, const MotionFrame&, std::size_t p, std::size_t k) { return s.velocity(p, k, axis); };
}
Value acceleration(int axis) {
  return [axis](State& s, const MotionFrame&, std::size_t p, std::size_t k) { return s.acceleration(p, k, axis); };
}
Value magnitude(const Value& x, const Value& y) {
  return [x, y](State& s, const MotionFrame& now, std::size_t p, std::size_t k) {
    return std::hypot(x(s, now, p, k), y(s, now, p, k));
  };
}

// Standard uncertainty of |u|: along u; where there is no direction yet, of one component.
double sigma_of_displacement(State&, const MotionFrame& now, std::size_t p, std::size_t) {
  const double uu = double(now.cov_u[p][0]), vv = double(now.cov_u[p][1]), uv = double(now.cov_u[p][2]);
  const Vec2 u(double(now.u[p][0]), double(now.u[p][1]));
  if (!(u.norm() > 0)) return std::sqrt((uu + vv) / 2);
  const Vec2 e = u.normalized();
  return std::sqrt(std::max(0.0, e.x() * e.x() * uu + e.y() * e.y() * vv + 2 * e.x() * e.y() * uv));
}

// Standard uncertainty of a strain from cov_F: first order, by differences of F.
Value sigma_of_strain(double (*of)(const Strain&)) {
  return [of](State&, const MotionFrame& now, std::size_t p, std::size_t) {
    const FieldValues& cov = now.field("cov_F");
    const Mat2 F = matrix(now.F[p]);
    const double h = 1e-6 * F.norm();
    double variance = 0;
    for (int row = 0; row < 2; ++row) {
      Vec2 slope;
      for (int column = 0; column < 2; ++column) {
        Mat2 more = F, less = F;
        more(row, column) += h, less(row, column) -= h;
        slope[column] = (of(log_strain(more)) - of(log_strain(less))) / (2 * h);
      }
      variance += slope.x() * slope.x() * double(cov(p, 0)) + slope.y() * slope.y() * double(cov(p, 1)) +
                  2 * slope.x() * slope.y() * double(cov(p, 2));
    }
    return std::sqrt(variance);
  };
}

Value sigma_of_invariant(double StrainVariance::*of) {
  return [of](State&, const MotionFrame& now, std::size_t p, std::size_t) {
    const FieldValues& cov = now.field("cov_F");
    return std::sqrt(strain_variance(matrix(now.F[p]), {double(cov(p, 0)), double(cov(p, 1)), double(cov(p, 2))}).*of);
  };
}

std::vector<Row> rows_of_motion() {
  const auto sigma = [](const std::string& what, const std::string& how, const Value& value) {
    return Row{{"sigma_displacement_" + what, "L", "standard uncertainty of displacement_" + what + ", from cov_u" + how,
                "standard uncertainty of the displacement" + (what == "magnitude" ? std::string() : " " + what), "cov_u"}, value};
  };
  return {
      {{"displacement_x", "L", "u_x since the first frame", "displacement x"}, displacement(0)},
      {{"displacement_y", "L", "u_y since the first frame", "displacement y"}, displacement(1)},
      {{"displacement_magnitude", "L", "|u|", "displacement"},
       [](State&, const MotionFrame& now, std::size_t p, std::size_t) { return double(std::hypot(now.u[p][0], now.u[p][1])); }},
      sigma("x", "", [](State&, const MotionFrame& now, std::size_t p, std::size_t) { return std::sqrt(double(now.cov_u[p][0])); }),
      sigma("y", "", [](State&, const MotionFrame& now, std::size_t p, std::size_t) { return std::sqrt(double(now.cov_u[p][1])); }),
      sigma("magnitude", " along u; without a displacement that of a component", sigma_of_displacement),
      {{"velocity_x", "L/T", "du_x/dt, second-order differences over the frames, or the source's own"}, velocity(0)},
      {{"velocity_y", "L/T", "du_y/dt, likewise"}, velocity(1)},
      {{"velocity_magnitude", "L/T", "|v|", "velocity"}, magnitude(velocity(0), velocity(1))},
      {{"acceleration_x", "L/T^2", "dv_x/dt, second-order differences over the frames"}, acceleration(0)},
      {{"acceleration_y", "L/T^2", "dv_y/dt, likewise"}, acceleration(1)},
      {{"acceleration_magnitude", "L/T^2", "|a|", "acceleration"}, magnitude(acceleration(0), acceleration(1))},
  };
}

std::vector<Row> rows_of_strain() {
  std::vector<Row> rows = {
      {{"strain_xx", "1", "xx of the logarithmic strain 1/2 ln(F F^T)"}, of_strain(xx)},
      {{"strain_yy", "1", "yy of the logarithmic strain"}, of_strain(yy)},
      {{"strain_xy", "1", "xy of the logarithmic strain (tensor component)"}, of_strain(xy)},
      {{"strain_vol", "1", "volumetric strain ln J", "volumetric strain"}, of_strain(volumetric)},
      {{"strain_dev", "1", "sqrt(2/3 e:e) of the deviator of the logarithmic strain, plane strain", "deviatoric strain"},
       of_strain(deviatoric)},
      {{"strain_1", "1", "greater principal logarithmic strain", "major principal strain"}, of_strain(major)},
      {{"strain_2", "1", "smaller principal logarithmic strain", "minor principal strain"}, of_strain(minor)},
      {{"strain_angle", "rad", "direction of strain_1 from the x axis", "direction of the major principal strain"},
       of_strain(direction)},
      {{"J", "1", "det F", "volume ratio J"},
       [](State&, const MotionFrame& now, std::size_t p, std::size_t) { return matrix(now.F[p]).determinant(); }},
      {{"strain_dev_path", "1", "sum over frames of sqrt(2/3 de:de), de the deviator of the strain increment",
        "deviatoric strain along the path"},
       [](State& s, const MotionFrame&, std::size_t p, std::size_t) { return s.path[p]; }, true},
      {{"strain_rate_xx", "1/T", "xx of the rate of deformation, the symmetric part of (dF/dt) F^-1; dF/dt by second-order "
                                 "differences over the frames"}, of_rate(xx)},
      {{"strain_rate_yy", "1/T", "yy of the rate of deformation"}, of_rate(yy)},
      {{"strain_rate_xy", "1/T", "xy of the rate of deformation (tensor component)"}, of_rate(xy)},
      {{"strain_rate_vol", "1/T", "rate of volume change, xx + yy of the rate of deformation"}, of_rate(volumetric)},
      {{"strain_rate_dev", "1/T", "sqrt(2/3 d:d) of the deviator of the rate of deformation, plane strain"},
       of_rate(deviatoric)},
      {{"strain_rate_1", "1/T", "greater principal rate of deformation"}, of_rate(major)},
      {{"strain_rate_2", "1/T", "smaller principal rate of deformation"}, of_rate(minor)},
      {{"strain_rate_angle", "rad", "direction of strain_rate_1 from the x axis"}, of_rate(direction)},
      {{"strain_sum_xx", "1", "sum of small-strain increments (the thesis' measure; not objective)"}, of_sum(xx), true},
      {{"strain_sum_yy", "1", "sum of small-strain increments"}, of_sum(yy), true},
      {{"strain_sum_xy", "1", "sum of small-strain increments"}, of_sum(xy), true},
      {{"strain_sum_dev", "1", "sqrt(2/3 e:e) of the deviator of the summed strain", "summed deviatoric strain"},
       of_sum(deviatoric), true},
  };
  for (Row& row : rows) row.field.strain = true;
  const auto add_sigma = [&](const std::string& name, const char* how, const std::string& label, const Value& value) {
    rows.push_back({{"sigma_" + name, "1", "standard uncertainty of " + name + ", from cov_F" + how, label, "cov_F"}, value});
  };
  const std::pair<const char*, double (*)(const Strain&)> components[] = {{"strain_xx", xx}, {"strain_yy", yy}, {"strain_xy", xy}};
  for (const auto& [name, of] : components) add_sigma(name, " to first order", "", sigma_of_strain(of));
  add_sigma("strain_vol", " to first order", "standard uncertainty of the volumetric strain", sigma_of_invariant(&StrainVariance::vol));
  add_sigma("strain_dev", " to second order", "standard uncertainty of the deviatoric strain", sigma_of_invariant(&StrainVariance::dev));
  return rows;
}

// What a motion carries beyond u, F and v, component by component.
std::vector<Row> rows_of_recorded() {
  std::vector<Row> rows = {{{"mean_stress", "Pa", "(s_xx + s_yy + s_zz)/3, tension positive", "mean stress", "stress"},
                            [](State&, const MotionFrame& now, std::size_t p, std::size_t) {
                              const FieldValues& stress = now.field("stress");
                              return (double(stress(p, 0)) + double(stress(p, 1)) + double(stress(p, 2))) / 3;
                            }}};
  for (const MotionField& recorded : motion_fields()) {
    if (recorded.member) continue;
    const std::vector<std::string> components = recorded.component_names();
    for (std::size_t c = 0; c < components.size(); ++c) {
      const std::string &name = recorded.name, &which = components[c];
      rows.push_back({{which.empty() ? name : name + "_" + which, recorded.unit, recorded.definition,
                       which.empty() ? recorded.label : recorded.label + " " + which, name},
                      [name, c](State&, const MotionFrame& now, std::size_t p, std::size_t) {
                        return double(now.field(name)(p, c));
                      }});
    }
  }
  return rows;
}

// All of them. (Made anew each time: fields may have been added to motion_fields().)
std::vector<Row> all_rows() {
  std::vector<Row> rows;
  for (const auto& part : {rows_of_motion(), rows_of_strain(), rows_of_recorded()}) {
    for (const Row& row : part) {
      std::string& label = rows.emplace_back(row).field.label;
      if (!label.empty()) continue;
      label = row.field.name;
      std::replace(label.begin(), label.end(), '_', ' ');
    }
  }
  return rows;
}

Row row_of(std::string_view name) {
  std::vector<Row> rows = all_rows();
  const auto it = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.field.name == name; });
  if (it != rows.end()) return *it;
  std::vector<std::string> names;
  for (const Row& row : rows) names.push_back(row.field.name);
  throw InputError("unknown field '" + std::string(name) + "'" + did_you_mean(std::string(name), names));
}

}  // namespace

std::vector<DerivedField> derived_fields() {
  std::vector<DerivedField> fields;
  for (const Row& row : all_rows()) fields.push_back(row.field);
  return fields;
}

DerivedField derived_field(std::string_view name) { return row_of(name).field; }

std::string sigma_field(std::string_view name) {
  const std::string wanted = "sigma_" + std::string(name);
  for (const Row& row : all_rows())
    if (row.field.name == wanted) return wanted;
  return "";
}

DerivedReader::DerivedReader(const MotionSource& motion, bool central)
    : state_(std::make_unique<State>(motion, central)) {}
DerivedReader::~DerivedReader() = default;

std::vector<double> DerivedReader::values(std::string_view name, std::size_t k) {
  const Row row = row_of(name);
  State& s = *state_;
  const std::size_t count = s.motion.particles().size();
  std::vector<double> out(count, nan_value);
  const MotionFrame now = s.frame(k);
  if (!row.field.source.empty() && particles_with(now, *motion_fields().find(row.field.source)) == 0) return out;
  if (row.sums) s.sum_to(k);
  for (std::size_t p = 0; p < count; ++p)
    if (alive(now.status[p])) out[p] = row.value(s, now, p, k);
  return out;
}

}  // namespace pivnp

#include "apps/report/content/differences.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/selection.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::report {

namespace {

// Of the displacement, component by component.
struct Components {
  const ComparisonField *x = nullptr, *y = nullptr;
  explicit operator bool() const { return x != nullptr && y != nullptr; }
  Vec2 at(std::size_t k) const { return {double(x->values.at(k)), double(y->values.at(k))}; }
};

Components components_of(const Comparison& c) { return {c.field("difference_x"), c.field("difference_y")}; }

// The comparison's field on a computed one.
const ComparisonField* difference_of(const Comparison& c, const std::string& field) {
  if (field == "displacement_x") return c.field("difference_x");
  if (field == "displacement_y") return c.field("difference_y");
  return c.field("difference_" + field);
}

}  // namespace

DifferenceCurve difference_curve(const Content& content) {
  DifferenceCurve out;
  if (!content.comparison) return out;
  const Components components = components_of(*content.comparison);
  const ComparisonField* magnitude = content.comparison->field("difference_magnitude");
  if (!components && magnitude == nullptr) return out;
  const ComparisonField& any = components ? *components.x : *magnitude;
  const std::size_t n = any.id.size();
  if (n == 0) return out;

  std::unordered_map<std::int64_t, std::size_t> index;
  if (content.measured)
    for (std::size_t p = 0; p < content.measured->particles().size(); ++p)
      index[content.measured->particles().id[p]] = p;

  for (std::size_t k = 0; k < any.time.size(); ++k) {
    const std::optional<std::size_t> at = content.measured ? frame_at(*content.measured, any.time[k]) : std::nullopt;
    const MotionFrame frame = at ? content.measured->frame(*at) : MotionFrame{};
    double sum = 0, variance = 0;
    std::size_t known = 0;
    std::vector<double> found;
    for (std::size_t p = 0; p < n; ++p) {
      const std::size_t v = k * n + p;
      const Vec2 apart = components ? components.at(v) : Vec2(double(magnitude->values.at(v)), 0);
      const double d = std::hypot(apart.x(), apart.y());
      if (!std::isfinite(d)) continue;
      sum += d * d;
      found.push_back(d);
      const auto it = index.find(any.id[p]);
      if (it == index.end() || it->second >= frame.cov_u.size()) continue;
      const auto& cov = frame.cov_u[it->second];
      const double trace = double(cov[0]) + double(cov[1]);
      if (!std::isfinite(trace)) continue;
      variance += trace;
      ++known;
    }
    out.time.push_back(any.time[k]);
    out.compared.push_back(found.size());
    out.rms.push_back(found.empty() ? nan_value : std::sqrt(sum / double(found.size())));
    out.median.push_back(plot::quantile(found, 0.5));
    out.sigma.push_back(known == 0 ? nan_value : std::sqrt(variance / double(known)));
  }
  return out;
}

std::vector<double> field_difference(const Content& content, const std::string& field, double time,
                                     const FieldAtTime& first) {
  if (!content.comparison || !content.measured || first.position.empty()) return {};
  const Components components = components_of(*content.comparison);
  const bool magnitude = field == "displacement_magnitude" && components;
  const ComparisonField* direct = magnitude ? components.x : difference_of(*content.comparison, field);
  if (direct == nullptr || direct->time.empty()) return {};
  const std::vector<double>& times = direct->time;
  std::size_t row = 0;
  for (std::size_t k = 1; k < times.size(); ++k)
    if (std::abs(times[k] - time) < std::abs(times[row] - time)) row = k;
  const double step = times.size() > 1 ? (times.back() - times.front()) / double(times.size() - 1) : std::abs(time);
  if (std::abs(times[row] - time) > 0.51 * step + 1e-12) return {};

  const ParticleSet& particles = content.measured->particles();
  std::unordered_map<std::int64_t, std::size_t> column;
  for (std::size_t p = 0; p < direct->id.size(); ++p) column[direct->id[p]] = p;
  std::vector<double> out(particles.size(), nan_value);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const auto it = column.find(particles.id[p]);
    if (it == column.end()) continue;
    const std::size_t v = row * direct->id.size() + it->second;
    if (!magnitude) {
      out[p] = double(direct->values.at(v));
      continue;
    }
    const Vec2 u = first.position[p] - particles.x0[p];
    out[p] = (u + components.at(v)).norm() - u.norm();
  }
  return out;
}

}  // namespace pivnp::report

#include "apps/report/content/differences.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/selection.hpp"

namespace pivnp::report {

namespace {
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
}

DifferenceCurve difference_curve(const Content& content) {
  DifferenceCurve out;
  if (!content.comparison) return out;
  const compare::Comparison& c = *content.comparison;
  const std::vector<float>*x = nullptr, *y = nullptr, *magnitude = nullptr;
  for (const compare::DifferenceField& f : c.fields) {
    if (f.name == "difference_x") x = &f.values;
    if (f.name == "difference_y") y = &f.values;
    if (f.name == "difference_magnitude") magnitude = &f.values;
  }
  const std::size_t n = c.id.size();
  if (n == 0 || (magnitude == nullptr && (x == nullptr || y == nullptr))) return out;

  std::unordered_map<std::int64_t, std::size_t> index;
  if (content.measured)
    for (std::size_t p = 0; p < content.measured->particles().size(); ++p)
      index[content.measured->particles().id[p]] = p;

  for (std::size_t k = 0; k < c.field_times().size(); ++k) {
    const std::optional<std::size_t> at =
        content.measured ? frame_at(*content.measured, c.field_times()[k]) : std::nullopt;
    const MotionFrame frame = at ? content.measured->frame(*at) : MotionFrame{};
    double sum = 0, variance = 0;
    std::size_t known = 0;
    std::vector<double> found;
    for (std::size_t p = 0; p < n; ++p) {
      const std::size_t v = k * n + p;
      const double d =
          x != nullptr && y != nullptr ? std::hypot(double(x->at(v)), double(y->at(v))) : double(magnitude->at(v));
      if (!std::isfinite(d)) continue;
      sum += d * d;
      found.push_back(d);
      const auto it = index.find(c.id[p]);
      if (it == index.end() || it->second >= frame.cov_u.size()) continue;
      const auto& cov = frame.cov_u[it->second];
      const double trace = double(cov[0]) + double(cov[1]);
      if (!std::isfinite(trace)) continue;
      variance += trace;
      ++known;
    }
    out.time.push_back(c.field_times()[k]);
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
  const compare::Comparison& c = *content.comparison;
  const std::vector<float>*x = nullptr, *y = nullptr, *direct = nullptr;
  for (const compare::DifferenceField& f : c.fields) {
    if (f.name == "difference_x") x = &f.values;
    if (f.name == "difference_y") y = &f.values;
    if (f.name == "difference_" + field) direct = &f.values;
    if (f.name == "difference_x" && field == "displacement_x") direct = &f.values;
    if (f.name == "difference_y" && field == "displacement_y") direct = &f.values;
  }
  const bool magnitude = field == "displacement_magnitude" && x != nullptr && y != nullptr;
  if ((!magnitude && direct == nullptr) || c.field_times().empty()) return {};
  std::size_t row = 0;
  for (std::size_t k = 1; k < c.field_times().size(); ++k)
    if (std::abs(c.field_times()[k] - time) < std::abs(c.field_times()[row] - time)) row = k;
  const double step = c.field_times().size() > 1
                          ? (c.field_times().back() - c.field_times().front()) / double(c.field_times().size() - 1)
                          : std::abs(time);
  if (std::abs(c.field_times()[row] - time) > 0.51 * step + 1e-12) return {};

  const ParticleSet& particles = content.measured->particles();
  std::unordered_map<std::int64_t, std::size_t> column;
  for (std::size_t p = 0; p < c.id.size(); ++p) column[c.id[p]] = p;
  std::vector<double> out(particles.size(), nan_value);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const auto it = column.find(particles.id[p]);
    if (it == column.end()) continue;
    const std::size_t v = row * c.id.size() + it->second;
    if (!magnitude) {
      out[p] = double(direct->at(v));
      continue;
    }
    const Vec2 u = first.position[p] - particles.x0[p];
    out[p] = (u + Vec2(double(x->at(v)), double(y->at(v)))).norm() - u.norm();
  }
  return out;
}

}  // namespace pivnp::report

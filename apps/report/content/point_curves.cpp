#include "apps/report/content/point_curves.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/places.hpp"

namespace pivnp::report {

std::vector<PointCurve> point_curves(const MotionSource& motion, const std::vector<Vec2>& points) {
  std::vector<PointCurve> out(points.size());
  if (points.empty() || motion.times().empty()) return out;
  const std::shared_ptr<const MotionSource> places = at_points({std::shared_ptr<void>(), &motion}, points);
  DerivedReader reader(*places, true);
  const bool pressures = motion.frame(0).find("pressure") != nullptr;
  const std::string u_error = sigma_field("displacement_magnitude"), strain_error = sigma_field("strain_dev");
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    const auto add = [&](const std::string& field, std::vector<double> PointCurve::*to) {
      const std::vector<double> values = reader.values(field, k);
      for (std::size_t q = 0; q < points.size(); ++q) (out[q].*to).push_back(values[q]);
    };
    for (PointCurve& curve : out) curve.time.push_back(motion.times()[k]);
    add("displacement_magnitude", &PointCurve::displacement);
    add(u_error, &PointCurve::sigma);
    add("strain_dev", &PointCurve::strain);
    add(strain_error, &PointCurve::strain_sigma);
    if (pressures) add("pressure", &PointCurve::pressure);
  }
  for (PointCurve& curve : out)
    for (std::vector<double>* sigma : {&curve.sigma, &curve.strain_sigma})
      if (std::none_of(sigma->begin(), sigma->end(), [](double s) { return std::isfinite(s); })) sigma->clear();
  return out;
}

}  // namespace pivnp::report

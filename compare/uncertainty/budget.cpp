#include "compare/uncertainty/budget.hpp"

#include <cmath>

namespace pivnp::compare {

namespace {

double square(double x) { return x * x; }

}  // namespace

Vec2 sum_known(const Vec2& a, const Vec2& b) {
  if (std::isnan(a.x())) return b;
  if (std::isnan(b.x())) return a;
  return a + b;
}

Vec2 Variance::total() const {
  const Vec2 rest = numerical + input;
  if (!std::isnan(measurement.x())) return measurement + rest;
  return grids || rest.x() > 0 || rest.y() > 0 ? rest : measurement;
}

Budget::Budget(const CompareOptions& options)
    : systematic_(square(options.measurement_uncertainty_m.value_or(0))),
      gauge_(options.gauge_uncertainty),
      numerical_(square(options.numerical_uncertainty_m)),
      input_(square(options.input_uncertainty_m)) {}

Variance Budget::at(const Vec2& cov_first, const Vec2& cov_second, const Vec2& u_first, const Vec2& frame,
                    const Vec2* numerical) const {
  Variance v;
  const Vec2 random = sum_known(cov_first, cov_second);
  const Vec2 given = Vec2::Constant(systematic_) + (gauge_ * u_first).cwiseAbs2() + frame;
  v.measurement = !std::isnan(random.x()) ? Vec2(random + given) : given.sum() > 0 ? given : random;
  v.grids = numerical != nullptr;
  if (v.grids) v.grid = numerical->cwiseAbs2();
  v.numerical = v.grid + Vec2::Constant(numerical_);
  v.input = Vec2::Constant(input_);
  return v;
}

}  // namespace pivnp::compare

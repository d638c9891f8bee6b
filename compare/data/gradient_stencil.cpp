#include "compare/data/gradient_stencil.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::compare {

std::vector<Vec2> gradient_stencil(const std::vector<Vec2>& to) {
  using Vec5 = Eigen::Matrix<double, 5, 1>;
  if (to.size() < 5) return {};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec2& d : to) nearest = std::min(nearest, d.norm());
  const auto terms = [&](const Vec2& d) {
    const double x = d.x() / nearest, y = d.y() / nearest;
    return Vec5(x, y, x * x / 2, x * y, y * y / 2);
  };
  const auto weight = [&](const Vec2& d) { return std::pow(nearest * nearest / d.squaredNorm(), 2); };
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  for (const Vec2& d : to) {
    const Vec5 a = terms(d);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(a, weight(d));
  }
  const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(normal.selfadjointView<Eigen::Lower>());
  constexpr double held = 1e-4;  // of the best held term: a row or two of points leave round-off
  const Vec5 pivot = solver.vectorD();
  if (!(pivot.minCoeff() > held * pivot.maxCoeff())) return {};
  const Eigen::Matrix<double, 5, 2> columns = solver.solve(Eigen::Matrix<double, 5, 5>::Identity()).leftCols<2>();
  std::vector<Vec2> out;
  for (const Vec2& d : to) out.push_back(weight(d) / nearest * (columns.transpose() * terms(d)));
  return out;
}

}  // namespace pivnp::compare

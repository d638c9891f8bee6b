#include "pivnp/piv/validation/replacement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::piv {

namespace {

struct Donor {
  double a, b;  // offset in lattice steps
  std::size_t index;
};

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct Rebuilt {
  std::array<float, 2> displacement;
  std::array<float, 3> cov;
};

Rebuilt rebuild(const std::vector<Donor>& donors, const std::vector<std::array<float, 2>>& displacement,
                const std::vector<std::array<float, 3>>& cov) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> sums = Eigen::Matrix<double, 3, 2>::Zero();
  for (const Donor& d : donors) {
    const double weight = 1 / (d.a * d.a + d.b * d.b);
    const Eigen::Vector3d p(1, d.a, d.b);
    normal += weight * p * p.transpose();
    sums.col(0) += weight * displacement[d.index][0] * p;
    sums.col(1) += weight * displacement[d.index][1] * p;
  }
  // Affine only where the neighbours surround the place in both directions: else it would extrapolate their noise.
  Eigen::Matrix<double, 3, 2> plane = Eigen::Matrix<double, 3, 2>::Zero();
  const Eigen::LDLT<Eigen::Matrix3d> factor(normal);
  if (donors.size() >= 4 && factor.vectorD().minCoeff() > 0.2 * normal(0, 0)) {
    plane = factor.solve(sums);
  } else {
    for (int c = 0; c < 2; ++c) {
      std::vector<double> values;
      for (const Donor& d : donors) values.push_back(displacement[d.index][std::size_t(c)]);
      plane(0, c) = median_of(values);
    }
  }
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();
  const double share = 1.0 / static_cast<double>(donors.size());
  for (const Donor& d : donors) {
    const Eigen::Vector2d off(displacement[d.index][0] - Eigen::Vector3d(1, d.a, d.b).dot(plane.col(0)),
                              displacement[d.index][1] - Eigen::Vector3d(1, d.a, d.b).dot(plane.col(1)));
    const auto& c = cov[d.index];
    spread += share * Eigen::Vector3d(c[0] + off.x() * off.x(), c[1] + off.y() * off.y(), c[2] + off.x() * off.y());
  }
  return {{static_cast<float>(plane(0, 0)), static_cast<float>(plane(0, 1))},
          {static_cast<float>(spread[0]), static_cast<float>(spread[1]), static_cast<float>(spread[2])}};
}

}  // namespace

void replace_rejected(int nx, int ny, int rings, std::vector<std::array<float, 2>>& displacement,
                      std::vector<VectorStatus>& status, std::vector<std::array<float, 3>>& cov) {
  std::vector<Donor> donors;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::pair<std::size_t, Rebuilt>> rebuilt;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const std::size_t k = std::size_t(j) * std::size_t(nx) + std::size_t(i);
        if (status[k] != VectorStatus::rejected) continue;
        donors.clear();
        for (int b = std::max(-1, -j); b <= std::min(1, ny - 1 - j); ++b)
          for (int a = std::max(-1, -i); a <= std::min(1, nx - 1 - i); ++a) {
            const std::size_t n = std::size_t(j + b) * std::size_t(nx) + std::size_t(i + a);
            if (usable(status[n])) donors.push_back({double(a), double(b), n});
          }
        if (donors.size() >= 3) rebuilt.emplace_back(k, rebuild(donors, displacement, cov));
      }
    for (const auto& [k, value] : rebuilt) {
      displacement[k] = value.displacement;
      cov[k] = value.cov;
      status[k] = VectorStatus::replaced;
    }
    if (rebuilt.empty()) return;
  }
}

}  // namespace pivnp::piv

#include "pivnp/piv/validate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::piv {

namespace {

constexpr int reach = 2;
constexpr int most = (2 * reach + 1) * (2 * reach + 1);

// Numbers whose median is wanted; no memory of its own.
struct Sample {
  std::array<float, 2 * most> value;
  int count = 0;
  void add(float v) { value[std::size_t(count++)] = v; }
  float lower_quartile() {
    if (count == 0) return 0;
    const auto quarter = value.begin() + count / 4;
    std::nth_element(value.begin(), quarter, value.begin() + count);
    return *quarter;
  }
  float median() {
    if (count == 0) return 0;
    const auto middle = value.begin() + count / 2;
    std::nth_element(value.begin(), middle, value.begin() + count);
    if (count % 2 == 1) return *middle;
    return 0.5f * (*middle + *std::max_element(value.begin(), middle));
  }
};

struct Neighbours {
  std::array<std::array<float, 2>, most> displacement{};  // 5 x 5 about the point
  std::array<std::uint8_t, most> good{};
  int count = 0;

  Neighbours(const VectorGrid& vectors, int i, int j) {
    for (int b = std::max(-reach, -j); b <= std::min(reach, vectors.ny - 1 - j); ++b)
      for (int a = std::max(-reach, -i); a <= std::min(reach, vectors.nx - 1 - i); ++a) {
        const std::size_t k = std::size_t(j + b) * std::size_t(vectors.nx) + std::size_t(i + a);
        if (!vectors.good[k] || (a == 0 && b == 0)) continue;
        displacement[at(a, b)] = vectors.displacement[k];
        good[at(a, b)] = 1;
        ++count;
      }
  }
  static std::size_t at(int a, int b) { return std::size_t((b + reach) * (2 * reach + 1) + a + reach); }

  // Median difference of adjacent neighbours along i (da = 1) or j (db = 1); 0 where too few say anything.
  float gradient(std::size_t component, int da, int db) const {
    Sample differences;
    for (int b = -reach; b + db <= reach; ++b)
      for (int a = -reach; a + da <= reach; ++a)
        if (good[at(a, b)] && good[at(a + da, b + db)])
          differences.add(displacement[at(a + da, b + db)][component] - displacement[at(a, b)][component]);
    return differences.count >= 4 ? differences.median() : 0.0f;
  }

  // Lower quartile of the second differences along i or along j: what a cluster of outliers does not reach.
  float curvature(std::size_t component, int da, int db) const {
    Sample differences;
    for (int b = -reach; b + 2 * db <= reach; ++b)
      for (int a = -reach; a + 2 * da <= reach; ++a)
        if (good[at(a, b)] && good[at(a + da, b + db)] && good[at(a + 2 * da, b + 2 * db)])
          differences.add(std::abs(displacement[at(a, b)][component] - 2 * displacement[at(a + da, b + db)][component] +
                                   displacement[at(a + 2 * da, b + 2 * db)][component]));
    return differences.count >= 4 ? differences.lower_quartile() : 0.0f;
  }

  // The neighbours freed of the local gradient.
  Sample levelled(std::size_t component) const {
    const float along_i = gradient(component, 1, 0), along_j = gradient(component, 0, 1);
    Sample level;
    for (int b = -reach; b <= reach; ++b)
      for (int a = -reach; a <= reach; ++a)
        if (good[at(a, b)])
          level.add(displacement[at(a, b)][component] - along_i * static_cast<float>(a) -
                    along_j * static_cast<float>(b));
    return level;
  }

  // How far they scatter about their median, and how far curvature alone lets the middle deviate from it.
  double scatter(Sample& level, float median, std::size_t component) const {
    for (int k = 0; k < level.count; ++k) level.value[std::size_t(k)] = std::abs(level.value[std::size_t(k)] - median);
    return level.median() + std::max(curvature(component, 1, 0), curvature(component, 0, 1));
  }
};

bool passes(const std::array<float, 2>& d, const Neighbours& neighbours, double threshold, double floor_px) {
  Sample level_u = neighbours.levelled(0), level_v = neighbours.levelled(1);
  const float median_u = level_u.median(), median_v = level_v.median();
  const double off_u = std::abs(d[0] - median_u), off_v = std::abs(d[1] - median_v);
  if (std::hypot(off_u, off_v) <= threshold * floor_px) return true;  // whatever the scatter
  return std::hypot(off_u / (neighbours.scatter(level_u, median_u, 0) + floor_px),
                    off_v / (neighbours.scatter(level_v, median_v, 1) + floor_px)) <= threshold;
}

// All 24 neighbours lie within half of what the test grants everywhere about one plane: it cannot fail.
bool plainly_smooth(const VectorGrid& vectors, int i, int j, double granted) {
  if (i < reach || j < reach || i + reach >= vectors.nx || j + reach >= vectors.ny) return false;
  const std::size_t nx = std::size_t(vectors.nx), middle = std::size_t(j) * nx + std::size_t(i);
  const auto limit = static_cast<float>(0.5 * granted);
  for (std::size_t c = 0; c < 2; ++c) {
    const auto at = [&](std::size_t k) { return vectors.displacement[k][c]; };
    const float here = at(middle), along_i = 0.5f * (at(middle + 1) - at(middle - 1)),
                along_j = 0.5f * (at(middle + nx) - at(middle - nx));
    float largest = 0;
    for (int b = -reach; b <= reach; ++b) {
      const std::size_t row = std::size_t(j + b) * nx + std::size_t(i - reach);
      for (int a = 0; a <= 2 * reach; ++a) {
        const std::size_t k = row + std::size_t(a);
        const float off = at(k) - here - along_i * static_cast<float>(a - reach) - along_j * static_cast<float>(b);
        largest = std::max(largest, vectors.good[k] ? std::abs(off) : std::numeric_limits<float>::infinity());
      }
    }
    if (!(largest <= limit)) return false;
  }
  return true;
}

}  // namespace

void median_test(VectorGrid& vectors, double threshold, double floor_px, int threads) {
  const std::vector<std::uint8_t> candidates = vectors.good;
  std::vector<std::uint8_t> passed = candidates;
  const double floor = std::max(floor_px, 1e-6);
  for (int round = 0; round < 2; ++round) {
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int j = 0; j < vectors.ny; ++j)
      for (int i = 0; i < vectors.nx; ++i) {
        const std::size_t k = std::size_t(j) * std::size_t(vectors.nx) + std::size_t(i);
        if (!candidates[k] || plainly_smooth(vectors, i, j, threshold * floor)) continue;
        const Neighbours neighbours(vectors, i, j);
        passed[k] = neighbours.count < 3 || passes(vectors.displacement[k], neighbours, threshold, floor);
      }
    vectors.good = passed;
    if (passed == candidates) return;
  }
}

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

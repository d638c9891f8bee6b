#include "pivnp/image/homography.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "pivnp/core/error.hpp"

namespace pivnp::image {

namespace {

using Vec8 = Eigen::Matrix<double, 8, 1>;
using Mat8 = Eigen::Matrix<double, 8, 8>;

// Thickness over length below which targets count as lying on a line.
constexpr double flat = 1e-3;

[[noreturn]] void fail(const std::string& message) { throw InputError("camera: " + message); }

void check_targets(const std::vector<Vec2>& points, const std::string& list) {
  for (std::size_t a = 0; a < points.size(); ++a) {
    if (!points[a].allFinite()) fail(list + ": target " + std::to_string(a + 1) + " is not a finite number");
    for (std::size_t b = 0; b < a; ++b)
      if (points[a] == points[b])
        fail(list + ": targets " + std::to_string(b + 1) + " and " + std::to_string(a + 1) + " are the same point");
  }
}

// Zero mean, unit covariance: x_n = scale (x - mean).
struct Whitening {
  Vec2 mean;
  Mat2 scale, unscale;

  Whitening(const std::vector<Vec2>& points, const std::string& list) {
    mean.setZero();
    for (const Vec2& p : points) mean += p;
    mean /= double(points.size());
    Mat2 covariance = Mat2::Zero();
    for (const Vec2& p : points) covariance += (p - mean) * (p - mean).transpose();
    covariance /= double(points.size());
    const Eigen::SelfAdjointEigenSolver<Mat2> eigen(covariance);
    const Vec2 deviation = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
    if (!(deviation[0] > flat * deviation[1])) fail(list + ": the targets lie on one line");
    unscale = eigen.eigenvectors() * deviation.asDiagonal() * eigen.eigenvectors().transpose();
    scale = unscale.inverse();
  }
  Vec2 apply(const Vec2& p) const { return scale * (p - mean); }
  Mat3 matrix() const {
    Mat3 m = Mat3::Identity();
    m.topLeftCorner<2, 2>() = scale;
    m.topRightCorner<2, 1>() = -scale * mean;
    return m;
  }
};

std::vector<Vec2> whitened(const std::vector<Vec2>& points, const Whitening& by) {
  std::vector<Vec2> out;
  for (const Vec2& p : points) out.push_back(by.apply(p));
  return out;
}

bool on_a_line(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (c - b).squaredNorm()});
  return std::abs(u.x() * v.y() - u.y() * v.x()) < flat * longest;
}

// Four targets fix the camera only if no three of them lie on a line; here they can be named.
void check_four(const std::vector<Vec2>& p, const std::string& list) {
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    std::size_t k[3], n = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (i != left_out) k[n++] = i;
    if (on_a_line(p[k[0]], p[k[1]], p[k[2]]))
      fail(list + ": targets " + std::to_string(k[0] + 1) + ", " + std::to_string(k[1] + 1) + " and " +
           std::to_string(k[2] + 1) + " lie on a line; of four targets no three may");
  }
}

// Direct linear transform between whitened points; [2][2] = 1.
Mat3 linear_fit(const std::vector<Vec2>& pixel, const std::vector<Vec2>& world) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(Eigen::Index(std::max<std::size_t>(9, 2 * pixel.size())), 9);
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    const Eigen::RowVector3d p = pixel[k].homogeneous().transpose();
    const Eigen::Index row = Eigen::Index(2 * k);
    a.row(row) << p, 0, 0, 0, -world[k].x() * p;
    a.row(row + 1) << 0, 0, 0, p, -world[k].y() * p;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeFullV);
  if (!(svd.singularValues()[7] > flat * svd.singularValues()[0]))
    fail("points_px and points_m do not fix a homography: too many targets lie on one line");
  const Eigen::Matrix<double, 9, 1> h = svd.matrixV().col(8);
  Mat3 m;
  m << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  // The third coordinate must not vanish in the middle of the targets, nor change its sign from one to the other.
  if (std::abs(m(2, 2)) < 1e-9 * m.norm()) fail("points_px and points_m: the horizon passes through the targets");
  return m / m(2, 2);
}

void check_horizon(const Mat3& m, const std::vector<Vec2>& pixel) {
  for (std::size_t k = 0; k < pixel.size(); ++k)
    if (!((m.row(2) * pixel[k].homogeneous())(0) > 1e-9))
      fail("target " + std::to_string(k + 1) +
           " lies beyond the horizon of the others; are points_px and points_m in the same order?");
}

// Distances in the world, in the world's units: `unit` takes whitened differences back.
double cost(const Mat3& m, const std::vector<Vec2>& pixel, const std::vector<Vec2>& world, const Mat2& unit) {
  double sum = 0;
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    const Eigen::Vector3d w = m * pixel[k].homogeneous();
    sum += (unit * (w.head<2>() / w[2] - world[k])).squaredNorm();
  }
  return sum;
}

// One damped Gauss-Newton step over the eight entries beside [2][2].
Mat3 step(const Mat3& m, const std::vector<Vec2>& pixel, const std::vector<Vec2>& world, const Mat2& unit,
          double damping) {
  Mat8 normal = Mat8::Zero();
  Vec8 right = Vec8::Zero();
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    const Eigen::Vector3d p = pixel[k].homogeneous(), w = m * p;
    const Vec2 x = w.head<2>() / w[2];
    Eigen::Matrix<double, 2, 8> j = Eigen::Matrix<double, 2, 8>::Zero();
    j.block<1, 3>(0, 0) = p.transpose() / w[2];
    j.block<1, 3>(1, 3) = p.transpose() / w[2];
    j.block<2, 2>(0, 6) = -x * pixel[k].transpose() / w[2];
    j = unit * j;
    normal += j.transpose() * j;
    right += j.transpose() * (unit * (world[k] - x));
  }
  normal.diagonal() *= 1 + damping;
  const Vec8 d = normal.ldlt().solve(right);
  Mat3 out = m;
  out.row(0) += d.segment<3>(0).transpose();
  out.row(1) += d.segment<3>(3).transpose();
  out.row(2).head<2>() += d.segment<2>(6).transpose();
  return out;
}

Mat3 refined(Mat3 m, const std::vector<Vec2>& pixel, const std::vector<Vec2>& world, const Mat2& unit) {
  double now = cost(m, pixel, world, unit), damping = 1e-6;
  for (int iteration = 0; iteration < 100 && damping < 1e6; ++iteration) {
    const Mat3 next = step(m, pixel, world, unit, damping);
    const double then = cost(next, pixel, world, unit);
    if (then < now) {
      const bool settled = now - then <= 1e-14 * now;
      m = next, now = then, damping /= 10;
      if (settled) break;
    } else {
      damping *= 10;
    }
  }
  return m;
}

}  // namespace

Homography fit_homography(const std::vector<Vec2>& pixel, const std::vector<Vec2>& world) {
  if (pixel.size() != world.size())
    fail("points_px has " + std::to_string(pixel.size()) + " targets, points_m has " + std::to_string(world.size()) +
         "; expected as many");
  if (pixel.size() < 4) fail("a homography takes four or more targets, found " + std::to_string(pixel.size()));
  check_targets(pixel, "points_px");
  check_targets(world, "points_m");
  const Whitening of_pixel(pixel, "points_px"), of_world(world, "points_m");
  const std::vector<Vec2> p = whitened(pixel, of_pixel), w = whitened(world, of_world);
  if (p.size() == 4) {
    check_four(p, "points_px");
    check_four(w, "points_m");
  }

  Mat3 m = linear_fit(p, w);
  check_horizon(m, p);
  m = refined(m, p, w, of_world.unscale);
  check_horizon(m, p);
  Homography out;
  out.residual = std::sqrt(cost(m, p, w, of_world.unscale) / double(p.size()));

  Mat3 back = Mat3::Identity();
  back.topLeftCorner<2, 2>() = of_world.unscale;
  back.topRightCorner<2, 1>() = of_world.mean;
  m = back * m * of_pixel.matrix();
  const double corner = std::abs(m(2, 2));
  out.world_from_pixel = corner > 1e-12 * m.row(2).norm() ? Mat3(m / corner) : m;
  return out;
}

}  // namespace pivnp::image

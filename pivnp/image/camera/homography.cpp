#include "pivnp/image/camera/homography.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "pivnp/core/error.hpp"

namespace pivnp::image {

namespace {

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
  cv::Mat a = cv::Mat::zeros(std::max(9, int(2 * pixel.size())), 9, CV_64F);
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    const double p[] = {pixel[k].x(), pixel[k].y(), 1};
    double *in_x = a.ptr<double>(int(2 * k)), *in_y = a.ptr<double>(int(2 * k + 1));
    for (int c = 0; c < 3; ++c) {
      in_x[c] = in_y[3 + c] = p[c];
      in_x[6 + c] = -world[k].x() * p[c];
      in_y[6 + c] = -world[k].y() * p[c];
    }
  }
  const cv::SVD svd(a);
  if (!(svd.w.at<double>(7) > flat * svd.w.at<double>(0)))
    fail("points_px and points_m do not fix a homography: too many targets lie on one line");
  const double* h = svd.vt.ptr<double>(8);
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
  using Jacobian = cv::Matx<double, 2, 8>;
  const cv::Matx22d to_world(unit(0, 0), unit(0, 1), unit(1, 0), unit(1, 1));
  cv::Matx<double, 8, 8> normal;
  cv::Matx<double, 8, 1> right, d;
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    const Vec2& p = pixel[k];
    const Eigen::Vector3d w = m * p.homogeneous();
    const Vec2 x = w.head<2>() / w[2];
    const Jacobian j = to_world * Jacobian(p.x(), p.y(), 1, 0, 0, 0, -x.x() * p.x(), -x.x() * p.y(),  //
                                           0, 0, 0, p.x(), p.y(), 1, -x.y() * p.x(), -x.y() * p.y()) * (1 / w[2]);
    const Vec2 off = unit * (world[k] - x);
    normal += j.t() * j;
    right += j.t() * cv::Matx21d(off.x(), off.y());
  }
  for (int k = 0; k < 8; ++k) normal(k, k) *= 1 + damping;
  cv::solve(normal, right, d, cv::DECOMP_CHOLESKY);
  Mat3 out = m;
  for (int k = 0; k < 8; ++k) out(k / 3, k % 3) += d(k);
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
  if (p.size() > 4) out.residual = std::sqrt(cost(m, p, w, of_world.unscale) / double(p.size()));  // four have no degree of freedom

  Mat3 back = Mat3::Identity();
  back.topLeftCorner<2, 2>() = of_world.unscale;
  back.topRightCorner<2, 1>() = of_world.mean;
  m = back * m * of_pixel.matrix();
  const double corner = std::abs(m(2, 2));
  out.world_from_pixel = corner > 1e-12 * m.row(2).norm() ? Mat3(m / corner) : m;
  return out;
}

}  // namespace pivnp::image

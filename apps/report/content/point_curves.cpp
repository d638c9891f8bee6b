#include "apps/report/content/point_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Dense>

#include "apps/report/content/selection.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"

namespace pivnp::report {

namespace {

// Particles and weights whose sum reproduces affine fields at a point.
struct Stencil {
  std::vector<std::size_t> particle;
  std::vector<double> weight;
};

Stencil stencil(const ParticleSet& particles, const Vec2& point, double start) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t p = 0; p < particles.size(); ++p)
    if (!(p < particles.born.size() && particles.born[p] > start))
      near.emplace_back((particles.x0[p] - point).norm(), p);
  Stencil s;
  if (near.empty()) return s;
  const std::size_t k = std::min<std::size_t>(6, near.size());
  std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(k), near.end());
  const double h = particle_spacing(particles, near[0].second);
  if (h > 0 && near[0].first > 2 * h) return s;
  s = {{near[0].second}, {1.0}};
  if (near[0].first <= 1e-6 * h || k < 3) return s;
  // Least squares u = c + G (x - point): the weights of c.
  Eigen::MatrixXd A(Eigen::Index(k), 3);
  for (std::size_t j = 0; j < k; ++j) {
    const Vec2 d = (particles.x0[near[j].second] - point) / near[k - 1].first;
    A.row(Eigen::Index(j)) << 1, d.x(), d.y();
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  if (qr.rank() < 3) return s;
  const Eigen::MatrixXd inverse = qr.solve(Eigen::MatrixXd::Identity(Eigen::Index(k), Eigen::Index(k)));
  s.particle.clear();
  s.weight.clear();
  for (std::size_t j = 0; j < k; ++j) {
    s.particle.push_back(near[j].second);
    s.weight.push_back(inverse(0, Eigen::Index(j)));
  }
  return s;
}

// Standard uncertainty of |u|: along u; where there is no direction yet, of one component.
double sigma_of_magnitude(const Vec2& u, const std::array<float, 3>& cov) {
  const double uu = double(cov[0]), vv = double(cov[1]), uv = double(cov[2]), n = u.norm();
  if (!(n > 0)) return std::sqrt((uu + vv) / 2);
  const Vec2 e = u / n;
  return std::sqrt(std::max(0.0, e.x() * e.x() * uu + e.y() * e.y() * vv + 2 * e.x() * e.y() * uv));
}

}  // namespace

std::vector<PointCurve> point_curves(const MotionSource& motion, const std::vector<Vec2>& points) {
  std::vector<PointCurve> out(points.size());
  std::vector<Stencil> stencils;
  const double start = motion.times().empty() ? 0 : motion.times().front();
  for (const Vec2& x : points) stencils.push_back(stencil(motion.particles(), x, start));
  for (std::size_t k = 0; k < motion.times().size() && !points.empty(); ++k) {
    const MotionFrame frame = motion.frame(k);
    const FieldValues *pressures = frame.find("pressure"), *cov_F = frame.find("cov_F");
    for (std::size_t q = 0; q < points.size(); ++q) {
      const Stencil& s = stencils[q];
      Vec2 u = s.particle.empty() ? Vec2(nan_value, nan_value) : Vec2(0, 0);
      double pressure = u.x(), least_pressure = 0;
      Mat2 F = Mat2::Constant(u.x());
      for (std::size_t j = 0; j < s.particle.size(); ++j) {
        const std::size_t p = s.particle[j];
        u += alive(frame.status[p]) ? Vec2(s.weight[j] * Vec2(double(frame.u[p][0]), double(frame.u[p][1])))
                                    : Vec2(nan_value, nan_value);
        F += alive(frame.status[p]) ? Mat2(s.weight[j] * matrix(frame.F[p])) : Mat2(Mat2::Constant(nan_value));
        if (!pressures) continue;
        const double of_particle = double((*pressures)(p, 0));
        pressure += alive(frame.status[p]) ? s.weight[j] * of_particle : nan_value;
        least_pressure = std::min(least_pressure, of_particle);
      }
      // (Beside the water's surface a plane through wet and dry particles is below zero.)
      if (least_pressure == 0 && pressure < 0) pressure = 0;
      if (pressures) out[q].pressure.push_back(pressure);
      out[q].time.push_back(motion.times()[k]);
      out[q].displacement.push_back(u.norm());
      if (!s.particle.empty() && s.particle[0] < frame.cov_u.size())
        out[q].sigma.push_back(sigma_of_magnitude(u, frame.cov_u[s.particle[0]]));
      out[q].strain.push_back(deviatoric(log_strain(F)));
      if (cov_F == nullptr || s.particle.empty()) continue;
      const std::size_t p = s.particle[0];
      out[q].strain_sigma.push_back(
          std::sqrt(strain_variance(F, {double((*cov_F)(p, 0)), double((*cov_F)(p, 1)), double((*cov_F)(p, 2))}).dev));
    }
  }
  for (PointCurve& curve : out)
    for (std::vector<double>* sigma : {&curve.sigma, &curve.strain_sigma})
      if (sigma->size() != curve.time.size()) sigma->clear();
  return out;
}

}  // namespace pivnp::report

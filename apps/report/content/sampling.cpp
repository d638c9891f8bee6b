// Motions read at material points and at chosen times (declared in analysis.hpp).
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <Eigen/Dense>

#include "apps/report/content/analysis.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::report {

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

bool alive(ParticleStatus s) { return s == ParticleStatus::active || s == ParticleStatus::flagged; }

double spacing(const ParticleSet& particles, std::size_t p) {
  return p < particles.area.size() && particles.area[p] > 0 ? std::sqrt(particles.area[p]) : 0;
}

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
  const double h = spacing(particles, near[0].second);
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

// A stretched square is drawn at most six spacings long: F of a torn particle says nothing about its extent.
Vec2 limited(Vec2 edge, double h) {
  const double n = edge.norm();
  if (!edge.allFinite()) return Vec2::Zero();
  return n > 6 * h ? Vec2(edge * (6 * h / n)) : edge;
}

}  // namespace

std::vector<History> histories(const MotionSource& motion, const std::vector<Vec2>& points) {
  std::vector<History> out(points.size());
  std::vector<Stencil> stencils;
  const double start = motion.times().empty() ? 0 : motion.times().front();
  for (const Vec2& x : points) stencils.push_back(stencil(motion.particles(), x, start));
  for (std::size_t k = 0; k < motion.times().size() && !points.empty(); ++k) {
    const MotionFrame frame = motion.frame(k);
    for (std::size_t q = 0; q < points.size(); ++q) {
      const Stencil& s = stencils[q];
      Vec2 u = s.particle.empty() ? Vec2(nan_value, nan_value) : Vec2(0, 0);
      for (std::size_t j = 0; j < s.particle.size(); ++j) {
        const std::size_t p = s.particle[j];
        u += alive(frame.status[p]) ? Vec2(s.weight[j] * Vec2(double(frame.u[p][0]), double(frame.u[p][1])))
                                    : Vec2(nan_value, nan_value);
      }
      out[q].time.push_back(motion.times()[k]);
      out[q].displacement.push_back(u.norm());
      if (!s.particle.empty() && s.particle[0] < frame.cov_u.size())
        out[q].sigma.push_back(sigma_of_magnitude(u, frame.cov_u[s.particle[0]]));
    }
  }
  for (History& h : out)
    if (h.sigma.size() != h.time.size()) h.sigma.clear();
  return out;
}

std::vector<Snapshot> snapshots(const MotionSource& motion, const std::string& field, bool central,
                                const std::vector<double>& times) {
  DerivedReader reader(motion, central);
  const ParticleSet& particles = motion.particles();
  // Where the source tells no area, squares are as large as the mean share of the seeded box.
  double fallback = 0;
  if (particles.area.size() != particles.size() && particles.size() > 0) {
    const Box box = box_around({&particles.x0}, 0);
    fallback = std::sqrt(box.width() * box.height() / double(particles.size()));
  }
  std::vector<Snapshot> out;
  for (const double time : times) {
    Snapshot s;
    s.time = time;
    const std::optional<std::size_t> k = frame_at(motion, time);
    if (!k) {
      out.push_back(std::move(s));
      continue;
    }
    const MotionFrame frame = motion.frame(*k);
    s.value = reader.values(field, *k);
    s.status = frame.status;
    for (std::size_t p = 0; p < particles.size(); ++p) {
      const double h = fallback > 0 ? fallback : spacing(particles, p);
      const Mat2 F = matrix(frame.F[p]);
      s.position.push_back(particles.x0[p] + Vec2(double(frame.u[p][0]), double(frame.u[p][1])));
      // A little larger than the particle, so that the scatter of a measurement leaves no gaps between neighbours.
      const bool finite = F.allFinite();
      s.half_x.push_back(0.57 * (finite ? limited(h * F.col(0), h) : Vec2(h, 0)));
      s.half_y.push_back(0.57 * (finite ? limited(h * F.col(1), h) : Vec2(0, h)));
    }
    out.push_back(std::move(s));
  }
  return out;
}

std::vector<double> field_difference(const Content& content, const std::string& field, double time,
                                     const Snapshot& first) {
  if (!content.comparison || !content.measured || first.position.empty()) return {};
  const ComparisonField *x = content.comparison->field("difference_x"), *y = content.comparison->field("difference_y"),
                        *direct = content.comparison->field("difference_" + field);
  if (field == "displacement_x") direct = x;
  if (field == "displacement_y") direct = y;
  const bool magnitude = field == "displacement_magnitude" && x != nullptr && y != nullptr;
  if (!magnitude && direct == nullptr) return {};
  const ComparisonField& any = magnitude ? *x : *direct;
  const std::vector<double>& times = any.time;
  if (times.empty()) return {};
  std::size_t row = 0;
  for (std::size_t k = 1; k < times.size(); ++k)
    if (std::abs(times[k] - time) < std::abs(times[row] - time)) row = k;
  const double step =
      times.size() > 1 ? (times.back() - times.front()) / double(times.size() - 1) : std::abs(time);
  if (std::abs(times[row] - time) > 0.51 * step + 1e-12) return {};

  const ParticleSet& particles = content.measured->particles();
  std::unordered_map<std::int64_t, std::size_t> column;
  for (std::size_t p = 0; p < any.id.size(); ++p) column[any.id[p]] = p;
  std::vector<double> out(particles.size(), nan_value);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const auto it = column.find(particles.id[p]);
    if (it == column.end()) continue;
    const std::size_t v = row * any.id.size() + it->second;
    if (!magnitude) {
      out[p] = double(direct->values.at(v));
      continue;
    }
    const Vec2 u = first.position[p] - particles.x0[p];
    out[p] = (u + Vec2(double(x->values.at(v)), double(y->values.at(v)))).norm() - u.norm();
  }
  return out;
}

}  // namespace pivnp::report

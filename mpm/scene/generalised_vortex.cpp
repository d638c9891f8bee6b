#include "mpm/scene/generalised_vortex.hpp"

#include <cmath>
#include <limits>

namespace pivnp::mpm {

namespace {

constexpr double inner = 0.75, outer = 1.25, density = 1050;

struct Profile {
  double h, h1, h2;  // h(r) and its derivatives
  explicit Profile(double r) {
    const double per = 1 / (inner - outer), s = (r - 1) * per;
    h = 1 - 8 * s * s + 16 * s * s * s * s;
    h1 = (-16 * s + 64 * s * s * s) * per;
    h2 = (-16 + 192 * s * s) * per * per;
  }
};

void add_particle(ParticleSet& set, const Vec2& x, double area) {
  set.id.push_back(std::int64_t(set.size()));
  set.label.push_back(0);
  set.x0.push_back(x);
  set.area.push_back(area);
  set.born.push_back(0);
  set.end.push_back(std::numeric_limits<double>::quiet_NaN());
  set.end_reason.push_back(EndReason::none);
}

}  // namespace

Scene GeneralisedVortex::scene(double cell, double points) const {
  const double mu = shear_modulus(), amplitude = amplitude_;
  MaterialOptions m;
  m.model = "neo_hookean";
  m.young_pa = young_;
  m.poisson = 0.3;
  m.density_kg_m3 = density;
  const int across = int(std::lround(3.2 / cell));
  Scene s;
  s.grid = Grid{{-1.6, -1.6}, {cell, cell}, across + 1, across + 1};
  s.materials = {m};
  s.particles.label_names = {"ring"};
  const int rings = int(std::lround((outer - inner) * points / cell));
  const double dr = (outer - inner) / rings;
  for (int q = 0; q < rings; ++q) {
    const double r = inner + (q + 0.5) * dr;
    const int n = int(std::lround(2 * M_PI * r / dr));
    for (int k = 0; k < n; ++k) {
      const double t = 2 * M_PI * (k + 0.37 * (q % 3)) / n;
      add_particle(s.particles, r * Vec2(std::cos(t), std::sin(t)), 2 * M_PI * r * dr / n);
    }
  }
  const std::vector<Vec2>& X = s.particles.x0;
  double torque = 0, inertia = 0;
  for (std::size_t k = 0; k < X.size(); ++k) {
    const double r = X[k].norm(), area = s.particles.area[k];
    const Profile p(r);
    s.v0.push_back(amplitude * M_PI * p.h * Vec2(-X[k].y(), X[k].x()));
    const double rate = amplitude * M_PI, x = X[k].x(), y = X[k].y(), h1 = p.h1 / r;
    s.grad_v0.push_back({-rate * y * h1 * x, -rate * (p.h + y * h1 * y), rate * (p.h + x * h1 * x), rate * x * h1 * y});
    torque += area * r * (3 * p.h1 + r * p.h2);
    inertia += area * r * r;
  }
  const double net = torque / inertia;
  s.body_force = [X, mu, net, amplitude](std::size_t k, double t) -> Vec2 {
    const double r = X[k].norm(), g = amplitude * std::sin(M_PI * t), g1 = amplitude * M_PI * std::cos(M_PI * t), g2 = -M_PI * M_PI * g;
    const Profile p(r);
    const double br = mu / density * r * g * g * p.h1 * p.h1 - r * g1 * g1 * p.h * p.h;
    const double bt = r * g2 * p.h - mu / density * g * (3 * p.h1 + r * p.h2 - net * r);
    const double angle = std::atan2(X[k].y(), X[k].x()) + g * p.h;
    return {br * std::cos(angle) - bt * std::sin(angle), br * std::sin(angle) + bt * std::cos(angle)};
  };
  return s;
}

Vec2 GeneralisedVortex::position(const Vec2& X) const {
  const double r = X.norm(), angle = std::atan2(X.y(), X.x()) + amplitude_ * Profile(r).h;
  return r * Vec2(std::cos(angle), std::sin(angle));
}

std::array<double, 3> GeneralisedVortex::stress(const Vec2& X) const {
  const double r = X.norm(), mu = shear_modulus();
  const Profile p(r);
  const double angle = std::atan2(X.y(), X.x()) + amplitude_ * p.h, c = std::cos(angle), n = std::sin(angle);
  const double rt = mu * r * amplitude_ * p.h1, tt = rt * rt / mu;
  return {n * n * tt - 2 * n * c * rt, c * c * tt + 2 * n * c * rt, -n * c * tt + (c * c - n * n) * rt};
}

}  // namespace pivnp::mpm

#include "apps/report/content/fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/selection.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::report {

namespace {

// A stretched square is drawn at most six spacings long: F of a torn particle says nothing about its extent.
Vec2 limited(Vec2 edge, double h) {
  const double n = edge.norm();
  if (!edge.allFinite()) return Vec2::Zero();
  return n > 6 * h ? Vec2(edge * (6 * h / n)) : edge;
}

}  // namespace

std::vector<FieldAtTime> fields_at(const MotionSource& motion, const std::string& field, bool central,
                                      const std::vector<double>& times) {
  DerivedReader reader(motion, central);
  const ParticleSet& particles = motion.particles();
  // Where the source tells no area, squares are as large as the mean share of the seeded box.
  double fallback = 0;
  if (particles.area.size() != particles.size() && particles.size() > 0) {
    const plot::Box box = box_around({&particles.x0}, 0);
    fallback = std::sqrt(box.width() * box.height() / double(particles.size()));
  }
  std::vector<FieldAtTime> out;
  for (const double time : times) {
    FieldAtTime s;
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
      const double h = fallback > 0 ? fallback : particle_spacing(particles, p);
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

plot::Box box_around(const std::vector<const std::vector<Vec2>*>& positions, double share) {
  std::array<std::vector<double>, 2> coordinate;
  for (const auto* list : positions)
    for (const Vec2& x : *list)
      if (x.allFinite())
        for (int a = 0; a < 2; ++a) coordinate[std::size_t(a)].push_back(x[a]);
  plot::Box box{Vec2::Zero(), Vec2::Ones()};
  if (coordinate[0].empty()) return box;
  for (int a = 0; a < 2; ++a) {
    const std::vector<double>& c = coordinate[std::size_t(a)];
    box.lower[a] = plot::quantile(c, share);
    box.upper[a] = plot::quantile(c, 1 - share);
    // Only places far off are left out.
    const double near = 0.25 * (box.upper[a] - box.lower[a]), least = plot::quantile(c, 0), most = plot::quantile(c, 1);
    if (least >= box.lower[a] - near) box.lower[a] = least;
    if (most <= box.upper[a] + near) box.upper[a] = most;
  }
  double size = std::max(box.width(), box.height());
  if (size <= 0) size = std::max(1e-6, box.lower.cwiseAbs().maxCoeff() * 1e-3);
  for (int a = 0; a < 2; ++a) {  // a line of particles is given some thickness
    const double lacking = std::max(0.0, 0.05 * size - (box.upper[a] - box.lower[a]));
    box.lower[a] -= 0.03 * size + lacking / 2;
    box.upper[a] += 0.03 * size + lacking / 2;
  }
  return box;
}

}  // namespace pivnp::report

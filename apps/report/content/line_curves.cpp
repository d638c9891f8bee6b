#include "apps/report/content/line_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/report/content/fields.hpp"
#include "apps/report/content/selection.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

namespace {

// The particle of the first frame that is nearest to a point; the number of particles if none is within two spacings.
std::size_t nearest(const ParticleSet& set, const Vec2& point, double start) {
  std::size_t best = set.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (p < set.born.size() && set.born[p] > start) continue;
    const double d = (set.x0[p] - point).norm();
    if (d < least) least = d, best = p;
  }
  const double h = best < set.size() ? particle_spacing(set, best) : 0;
  return h > 0 && least > 2 * h ? set.size() : best;
}

}  // namespace

ExtensometerCurve extensometer(const MotionSource& motion, const Vec2& from, const Vec2& to) {
  ExtensometerCurve curve;
  const ParticleSet& set = motion.particles();
  const double start = motion.times().empty() ? 0 : motion.times().front();
  const std::array<std::size_t, 2> end = {nearest(set, from, start), nearest(set, to, start)};
  const bool found = end[0] < set.size() && end[1] < set.size() && end[0] != end[1];
  const Vec2 first = found ? Vec2(set.x0[end[1]] - set.x0[end[0]]) : Vec2::Zero();
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    const MotionFrame frame = motion.frame(k);
    double strain = nan_value, variance = 0;
    if (found && alive(frame.status[end[0]]) && alive(frame.status[end[1]])) {
      Vec2 now = first;
      for (const int s : {0, 1}) {
        const auto& u = frame.u[end[std::size_t(s)]];
        now += (s == 0 ? -1 : 1) * Vec2(double(u[0]), double(u[1]));
      }
      strain = now.norm() / first.norm() - 1;
      const Vec2 e = now.normalized();
      for (const std::size_t p : end) {
        if (p >= frame.cov_u.size()) continue;
        const auto& c = frame.cov_u[p];
        variance += e.x() * e.x() * double(c[0]) + e.y() * e.y() * double(c[1]) + 2 * e.x() * e.y() * double(c[2]);
      }
    }
    curve.time.push_back(motion.times()[k]);
    curve.strain.push_back(strain);
    if (!frame.cov_u.empty()) curve.sigma.push_back(std::sqrt(std::max(0.0, variance)) / first.norm());
  }
  if (curve.sigma.size() != curve.time.size()) curve.sigma.clear();
  return curve;
}

SectionCurve section(const MotionSource& motion, const std::string& field, bool central, double time, const Vec2& from, const Vec2& to) {
  constexpr int places = 121;
  SectionCurve curve;
  const FieldAtTime at = fields_at(motion, field, central, {time}).front();
  const std::string stated = "sigma_" + field;
  const std::vector<DerivedField> known = derived_fields();
  const bool listed = std::any_of(known.begin(), known.end(), [&](const DerivedField& f) { return f.name == stated; });
  const FieldAtTime error = listed && !motion.times().empty() && motion.frame(0).find("cov_F") != nullptr
                                ? fields_at(motion, stated, central, {time}).front()
                                : FieldAtTime{};
  const ParticleSet& set = motion.particles();
  for (int k = 0; k < places; ++k) {
    const double share = double(k) / (places - 1);
    const Vec2 place = from + share * (to - from);
    double best = nan_value, sigma = nan_value, least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < at.position.size(); ++p) {
      const double d = (at.position[p] - place).norm(), h = particle_spacing(set, p);
      if (!alive(at.status[p]) || !(d < least) || (h > 0 && d > h)) continue;
      least = d;
      best = at.value[p];
      if (p < error.value.size()) sigma = error.value[p];
    }
    curve.distance.push_back(share * (to - from).norm());
    curve.value.push_back(best);
    if (!error.value.empty()) curve.sigma.push_back(sigma);
  }
  return curve;
}

}  // namespace pivnp::report

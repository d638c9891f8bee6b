#include "pivnp/core/particles/gauge.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp {

namespace {

class Gauged final : public MotionSource {
 public:
  Gauged(std::shared_ptr<const MotionSource> motion, double gauge) : motion_(std::move(motion)), radius_(gauge / 2) {
    const ParticleSet& set = motion_->particles();
    for (std::size_t p = 0; p < set.size(); ++p)
      if (set.x0[p].allFinite()) cells_[cell(set.x0[p])].push_back(std::uint32_t(p));
  }
  const std::string& name() const override { return motion_->name(); }
  const std::string& length_unit() const override { return motion_->length_unit(); }
  const std::string& time_unit() const override { return motion_->time_unit(); }
  const ParticleSet& particles() const override { return motion_->particles(); }
  const std::vector<double>& times() const override { return motion_->times(); }

  MotionFrame frame(std::size_t index) const override {
    MotionFrame frame = motion_->frame(index);
    std::erase_if(frame.fields, [](const FieldValues& f) { return f.field->name == "cov_F"; });  // that of another F
    for (std::size_t p = 0; p < frame.F.size(); ++p) {
      const Mat2 F = fitted(frame, p);
      frame.F[p] = {float(F(0, 0)), float(F(0, 1)), float(F(1, 0)), float(F(1, 1))};
    }
    return frame;
  }

 private:
  std::pair<std::int64_t, std::int64_t> cell(const Vec2& x) const {
    return {std::int64_t(std::floor(x.x() / radius_)), std::int64_t(std::floor(x.y() / radius_))};
  }

  Mat2 fitted(const MotionFrame& frame, std::size_t p) const {
    const ParticleSet& set = motion_->particles();
    const Mat2 unknown = Mat2::Constant(nan_value);
    if (!alive(frame.status[p]) || !set.x0[p].allFinite()) return unknown;
    const double born = p < set.born.size() ? set.born[p] : 0;
    double n = 0;
    Vec2 x_sum = Vec2::Zero(), u_sum = Vec2::Zero();
    Mat2 xx = Mat2::Zero(), ux = Mat2::Zero();
    const auto [i, j] = cell(set.x0[p]);
    for (std::int64_t b = j - 1; b <= j + 1; ++b)
      for (std::int64_t a = i - 1; a <= i + 1; ++a) {
        const auto at = cells_.find({a, b});
        if (at == cells_.end()) continue;
        for (const std::uint32_t q : at->second) {
          const Vec2 x = set.x0[q] - set.x0[p];
          if (x.norm() > radius_ || !alive(frame.status[q]) || (q < set.born.size() && set.born[q] != born)) continue;
          const Vec2 u(double(frame.u[q][0]) - double(frame.u[p][0]), double(frame.u[q][1]) - double(frame.u[p][1]));
          if (!u.allFinite()) continue;
          n += 1;
          x_sum += x;
          u_sum += u;
          xx += x * x.transpose();
          ux += u * x.transpose();
        }
      }
    if (n < 3) return unknown;
    const Mat2 A = xx - x_sum * x_sum.transpose() / n, B = ux - u_sum * x_sum.transpose() / n;
    if (!(A.determinant() > 1e-6 * A.trace() * A.trace())) return unknown;
    return Mat2::Identity() + B * A.inverse();
  }

  std::shared_ptr<const MotionSource> motion_;
  double radius_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> cells_;
};

}  // namespace

std::shared_ptr<const MotionSource> with_gauge(std::shared_ptr<const MotionSource> motion, double gauge) {
  return std::make_shared<Gauged>(std::move(motion), gauge);
}

}  // namespace pivnp

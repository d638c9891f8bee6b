#include "compare/alignment/as_compared.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/alignment/bring_together.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/rigid.hpp"
#include "compare/data/transformed.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

Vec2 vector_of(const std::array<float, 2>& v) { return {double(v[0]), double(v[1])}; }
std::array<float, 2> floats(const Vec2& v) { return {float(v.x()), float(v.y())}; }
std::array<float, 4> floats(const Mat2& m) { return {float(m(0, 0)), float(m(0, 1)), float(m(1, 0)), float(m(1, 1))}; }

struct Zone {
  Points polygon;
  bool turns = false;
};

class MotionAsCompared final : public MotionSource {
 public:
  MotionAsCompared(std::shared_ptr<const MotionSource> motion, std::vector<double> times, double tolerance)
      : motion_(std::move(motion)), times_(std::move(times)), tolerance_(tolerance), particles_(motion_->particles()) {}

  // From the state at `start` on.
  void count_anew(double start) {
    const MotionFrame begin = between(start);
    for (std::size_t p = 0; p < particles_.size(); ++p) {
      const bool known = alive(begin.status[p]);
      u_start_.push_back(known ? vector_of(begin.u[p]) : Vec2::Zero());
      F_start_.push_back(known ? Mat2(matrix(begin.F[p]).inverse()) : Mat2(Mat2::Identity()));
      particles_.x0[p] += u_start_.back();
    }
  }

  void take_off(const Zone& zone) {
    turns_ = zone.turns;
    const Polygon polygon(positions_of(zone.polygon), "compare: zone");
    for (std::size_t p = 0; p < particles_.size(); ++p)
      if (polygon.contains(particles_.x0[p])) members_.push_back(p);
  }

  const std::string& name() const override { return motion_->name(); }
  const std::string& length_unit() const override { return motion_->length_unit(); }
  const std::string& time_unit() const override { return motion_->time_unit(); }
  const ParticleSet& particles() const override { return particles_; }
  const std::vector<double>& times() const override { return times_; }

  MotionFrame frame(std::size_t index) const override {
    MotionFrame f = between(times_.at(index));
    f.v.clear();
    for (std::size_t p = 0; p < u_start_.size(); ++p) {
      f.u[p] = floats(Vec2(vector_of(f.u[p]) - u_start_[p]));
      f.F[p] = floats(Mat2(matrix(f.F[p]) * F_start_[p]));
    }
    for (FieldValues& field : f.fields)
      if (field.field->name == "cov_F")
        for (std::size_t p = 0; p < F_start_.size(); ++p) {
          const double xx = double(field(p, 0)), yy = double(field(p, 1)), xy = double(field(p, 2));
          Mat2 R;
          R << xx, xy, xy, yy;
          R = F_start_[p].transpose() * R * F_start_[p];
          field(p, 0) = float(R(0, 0)), field(p, 1) = float(R(1, 1)), field(p, 2) = float(R(0, 1));
        }
    if (members_.empty()) return f;
    std::vector<Vec2> X, x;
    for (const std::size_t p : members_)
      if (alive(f.status[p])) {
        X.push_back(particles_.x0[p]);
        x.push_back(X.back() + vector_of(f.u[p]));
      }
    if (X.size() < (turns_ ? 3u : 1u)) return f;
    const RigidMotion zone = fit_rigid(X, x, turns_).motion;
    const Mat2 back = zone.rotation().transpose();
    for (std::size_t p = 0; p < particles_.size(); ++p) {
      const Vec2& at = particles_.x0[p];
      f.u[p] = floats(Vec2(zone.undo(at + vector_of(f.u[p])) - at));
      if (turns_) f.F[p] = floats(Mat2(back * matrix(f.F[p])));
    }
    return f;
  }

 private:
  // The state at a time between two frames: that of a particle which one of them has lost is that frame's.
  MotionFrame between(double time) const {
    const std::vector<double>& t = motion_->times();
    const auto after = std::upper_bound(t.begin(), t.end(), time + tolerance_);
    const std::size_t lower = std::size_t(std::max<std::ptrdiff_t>(0, after - t.begin() - 1));
    MotionFrame a = motion_->frame(lower);
    a.time = time;
    if (time - t[lower] <= tolerance_ || lower + 1 >= t.size()) return a;
    const MotionFrame b = motion_->frame(lower + 1);
    const double w = (time - t[lower]) / (t[lower + 1] - t[lower]);
    for (std::size_t p = 0; p < a.u.size(); ++p) {
      if (!alive(a.status[p])) continue;
      if (!alive(b.status[p])) {
        a.u[p] = b.u[p], a.F[p] = b.F[p], a.status[p] = b.status[p];
        continue;
      }
      a.u[p] = floats(Vec2((1 - w) * vector_of(a.u[p]) + w * vector_of(b.u[p])));
      a.F[p] = floats(Mat2((1 - w) * matrix(a.F[p]) + w * matrix(b.F[p])));
      if (p < a.cov_u.size() && p < b.cov_u.size())
        for (std::size_t c = 0; c < 3; ++c) a.cov_u[p][c] = float((1 - w) * double(a.cov_u[p][c]) + w * double(b.cov_u[p][c]));
    }
    if (w >= 0.5) a.fields = b.fields;
    return a;
  }

  std::shared_ptr<const MotionSource> motion_;
  std::vector<double> times_;
  double tolerance_;
  ParticleSet particles_;
  std::vector<Vec2> u_start_;  // empty: counted from its own beginning
  std::vector<Mat2> F_start_;  // inverse
  std::vector<std::size_t> members_;  // of the zone
  bool turns_ = false;
};

// Keeps what it reads through a transform.
struct Moved {
  std::shared_ptr<const MotionSource> motion;
  TransformedMotion moved;
};

}  // namespace

ComparedMotions as_compared(const std::shared_ptr<const MotionSource>& first,
                            const std::shared_ptr<const MotionSource>& given_second, const CompareOptions& options) {
  const Transform transform = bring_together(*first, *given_second, options).second;
  std::shared_ptr<const MotionSource> second = given_second;
  if (!transform.identity()) {
    const auto moved = std::make_shared<Moved>(Moved{given_second, TransformedMotion(*given_second, transform)});
    second = std::shared_ptr<const MotionSource>(moved, &moved->moved);
  }
  const CommonTimes common = common_times(*first, *second);
  const bool turns = !options.fixed_zone_m.empty();
  const Zone zone{turns ? options.fixed_zone_m : options.reference_m, turns};

  std::vector<double> first_times, second_times = common.times;
  for (const double t : first->times())
    if (t >= common.start - common.tolerance) first_times.push_back(t);
  for (const double t : second->times())
    if (t > first_times.back() + common.tolerance) second_times.push_back(t);
  const auto seen = [&](const std::shared_ptr<const MotionSource>& motion, std::vector<double> times) {
    const bool anew = DataSet(*motion, common).counted_anew();
    const auto same = [&](double a, double b) { return std::abs(a - b) <= common.tolerance; };
    if (!anew && zone.polygon.empty() && std::equal(times.begin(), times.end(), motion->times().begin(), motion->times().end(), same))
      return motion;
    auto out = std::make_shared<MotionAsCompared>(motion, std::move(times), common.tolerance);
    if (anew) out->count_anew(common.start);
    if (!zone.polygon.empty()) out->take_off(zone);
    return std::shared_ptr<const MotionSource>(std::move(out));
  };
  return {seen(first, std::move(first_times)), seen(second, std::move(second_times))};
}

}  // namespace pivnp::compare

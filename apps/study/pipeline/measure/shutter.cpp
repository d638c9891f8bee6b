#include "apps/study/pipeline/measure/shutter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

bool has_vector(const VectorField& field, std::size_t n) {
  return field.status[n] == VectorStatus::valid || field.status[n] == VectorStatus::replaced;
}

}  // namespace

RowClock::RowClock(double row_time_s, const Setting& setting, const std::vector<Frame>& frames) : row_time_s_(row_time_s), setting_(setting) {
  for (const Frame& f : frames) time_.push_back(f.time);
}

RowClock::Timed RowClock::timed(VectorField raw) const {
  Timed out;
  const std::size_t count = raw.status.size();
  const double start = time_.at(std::size_t(raw.pair[0])), end = time_.at(std::size_t(raw.pair[1])), middle_row = (setting_.height - 1) / 2.0;
  const image::Camera &first = setting_.camera_at(raw.pair[0]), &second = setting_.camera_at(raw.pair[1]);
  out.duration.assign(count, end - start);
  out.middle.assign(count, (start + end) / 2);
  for (std::size_t n = 0; n < count; ++n) {
    if (!has_vector(raw, n)) continue;
    const Vec2 x = setting_.grid.position(int(n) % setting_.grid.nx, int(n) / setting_.grid.nx);
    const Vec2 u(double(raw.displacement[n][0]), double(raw.displacement[n][1])), from = raw.anchor == Anchor::central ? Vec2(x - u / 2) : x;
    const double a = first.to_pixel(from).y(), b = second.to_pixel(from + u).y();
    if (!std::isfinite(a + b)) continue;
    out.duration[n] += row_time_s_ * (b - a);
    out.middle[n] += row_time_s_ * ((raw.anchor == Anchor::central ? (a + b) / 2 : a) - middle_row);
  }
  out.field = std::move(raw);
  return out;
}

VectorField RowClock::corrected(const Timed* before, const Timed& now, const Timed* after) const {
  VectorField out = now.field;
  const double start = time_.at(std::size_t(out.pair[0])), end = time_.at(std::size_t(out.pair[1])), asked = (start + end) / 2;
  for (std::size_t n = 0; n < out.status.size(); ++n) {
    if (!has_vector(now.field, n)) continue;
    std::vector<const Timed*> known{&now};
    for (const Timed* t : {before, after})
      if (t && has_vector(t->field, n)) known.push_back(t);
    Vec2 velocity = Vec2::Zero();
    std::array<double, 3> cov{};
    for (const Timed* t : known) {
      double weight = 1;
      for (const Timed* other : known)
        if (other != t) weight *= (asked - other->middle[n]) / (t->middle[n] - other->middle[n]);
      const double w = weight / t->duration[n];
      velocity += w * Vec2(double(t->field.displacement[n][0]), double(t->field.displacement[n][1]));
      for (std::size_t k = 0; k < 3; ++k) cov[k] += w * w * double(t->field.cov[n][k]);
    }
    const double dt = end - start;
    out.displacement[n] = {float(dt * velocity.x()), float(dt * velocity.y())};
    for (std::size_t k = 0; k < 3; ++k) out.cov[n][k] = float(dt * dt * cov[k]);
  }
  return out;
}

std::vector<VectorField> RowClock::add(VectorField raw) {
  held_.push_back(timed(std::move(raw)));
  std::vector<VectorField> out;
  if (held_.size() == 2) out.push_back(corrected(nullptr, held_[0], &held_[1]));
  if (held_.size() == 3) {
    out.push_back(corrected(&held_[0], held_[1], &held_[2]));
    held_.pop_front();
  }
  return out;
}

std::vector<VectorField> RowClock::finish() {
  std::vector<VectorField> out;
  if (!held_.empty()) out.push_back(corrected(held_.size() > 1 ? &held_[held_.size() - 2] : nullptr, held_.back(), nullptr));
  held_.clear();
  return out;
}

VectorField RowClock::alone(const VectorField& raw) const {
  Timed now = timed(raw);
  const double dt = time_.at(std::size_t(raw.pair[1])) - time_.at(std::size_t(raw.pair[0]));
  VectorField out = raw;
  for (std::size_t n = 0; n < out.status.size(); ++n) {
    if (!has_vector(raw, n)) continue;
    const double share = dt / now.duration[n];
    for (float& d : out.displacement[n]) d = float(share * double(d));
    for (float& v : out.cov[n]) v = float(share * share * double(v));
  }
  return out;
}

std::vector<Remark> shutter_remarks(const Case& c, const Setting& setting, const std::vector<Frame>& frames, std::size_t pairs,
                                         const std::function<VectorField(std::size_t)>& pair) {
  const double exposure = c.camera.exposure_s, readout = std::abs(c.camera.row_time_s) * (setting.height - 1);
  if (exposure == 0 && readout == 0) return {};
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  double most = 0;  // px/s, at the 95th percentile of the fastest pair
  std::size_t at = 0;
  for (std::size_t k = 0; k < pairs; ++k) {
    const VectorField field = pair(k);
    std::vector<double> speed;
    for (std::size_t n = 0; n < field.status.size(); ++n)
      if (field.status[n] == VectorStatus::valid)
        speed.push_back(std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1])) / pixel /
                        (frames[std::size_t(field.pair[1])].time - frames[std::size_t(field.pair[0])].time));
    if (speed.empty()) continue;
    const auto high = speed.begin() + std::ptrdiff_t(speed.size() * 95 / 100);
    std::nth_element(speed.begin(), high, speed.end());
    if (*high > most) most = *high, at = std::size_t(field.pair[0]);
  }
  std::vector<Remark> out;
  constexpr double loud_blur_px = 0.5;
  if (const double blur = exposure * most; blur > loud_blur_px)
    out.push_back({"Pictures are blurred by motion: while one is exposed (camera.exposure_s), the fastest material moves by " + number(blur, 2) +
                  " px (95th percentile, from frame " + std::to_string(at) + " on). Above half a pixel fine texture is lost along the way of the motion, "
                  "and vectors scatter more; an exposure of " + number(loud_blur_px / most, 2) + " s would do.", RemarkWeight::doubt});
  if (readout > 0)
    out.push_back({"Rows are read one after the other, in " + number(readout, 3) + " s an image, in which the fastest material moves by " +
                  number(readout * most, 2) + " px; all vectors were brought to the time of the middle row (camera.row_time_s)."});
  return out;
}

}  // namespace pivnp::app

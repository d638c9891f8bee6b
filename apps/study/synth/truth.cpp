#include "apps/study/synth/truth.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pivnp::app {

CameraMotion drawn_camera(const Case& c) {
  const SynthCameraOptions& o = c.synth_camera;
  const SynthOptions& synth = *c.synth;
  CameraMotion motion;
  motion.centre = {(synth.width_px - 1) / 2.0, (synth.height_px - 1) / 2.0};
  for (int k = 0; k < synth.frames; ++k) {
    CameraPlace place;
    const bool bumped = o.bump_at > 0 && k >= o.bump_at;
    const auto random = [&](std::uint64_t which) {
      return 2 * uniform(std::uint64_t(c.texture.seed) + 32452843, 2 * std::uint64_t(k) + which) - 1;
    };
    place.shift = k * Vec2(o.drift_px_per_frame[0], o.drift_px_per_frame[1]);
    if (k > 0) place.shift += o.shake_px * Vec2(random(0), random(1));
    if (bumped) place.shift += Vec2(o.bump_px[0], o.bump_px[1]);
    place.turn = bumped ? radians(o.bump_deg) : 0;
    place.scale = std::pow(1 + o.zoom_per_frame, k);
    motion.at.push_back(place);
  }
  return motion;
}

AffineMotion affine_motion(const SynthOptions& synth, const Setting& setting) {
  AffineMotion motion;
  if (synth.motion == SynthMotion::none) return motion;
  Mat2 G = Mat2::Zero();
  if (!synth.gradient_per_frame.empty())
    G << synth.gradient_per_frame[0], synth.gradient_per_frame[1], synth.gradient_per_frame[2],
        synth.gradient_per_frame[3];
  const double a = synth.rotation_deg_per_frame * std::numbers::pi / 180;
  Mat2 R;
  R << std::cos(a), -std::sin(a), std::sin(a), std::cos(a);
  motion.A = R * (Mat2::Identity() + G);
  motion.centre = setting.camera.to_world({synth.centre_px[0], synth.centre_px[1]});
  const Mat2 scale = setting.camera.jacobian({synth.centre_px[0], synth.centre_px[1]});
  motion.shift = scale * Vec2(synth.shift_px_per_frame[0], -synth.shift_px_per_frame[1]);  // rows run downward
  return motion;
}

Vec2 StagedSlope::at(const Vec2& X, double time) const {
  const auto stage = [time](int k) { return std::clamp(3 * time - k, 0.0, 1.0); };
  const double Y = X.y() - base;
  // Integral over the height of the share of material behind the front, (1 + tanh((f - y)/front))/2.
  const auto log_cosh = [](double v) { return std::abs(v) + std::log1p(std::exp(-2 * std::abs(v))) - std::log(2.0); };
  const double f = stage(1) * (height + 6 * front) - 3 * front;
  const double wet = 0.5 * (Y + front * (log_cosh(f / front) - log_cosh((f - Y) / front)));
  const Vec2 x(X.x(), base + Y * (1 - settlement * stage(0)) - collapse * (stage(1) > 0 ? wet : 0.0));
  const Vec2 r = x - centre;
  const double angle = turn * stage(2) * stage(2) * 0.5 * (1 - std::tanh((r.norm() - radius) / band));
  const double c = std::cos(angle), s = std::sin(angle);
  return centre + Vec2(c * r.x() - s * r.y(), s * r.x() + c * r.y());
}

Mat2 StagedSlope::F(const Vec2& X, double time) const {
  const double h = 1e-4 * band;
  Mat2 F;
  F.col(0) = (at(X + Vec2(h, 0), time) - at(X - Vec2(h, 0), time)) / (2 * h);
  F.col(1) = (at(X + Vec2(0, h), time) - at(X - Vec2(0, h), time)) / (2 * h);
  return F;
}

StagedSlope staged_slope(const SynthOptions& synth, const Setting& setting) {
  StagedSlope slope;
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const Region& region : setting.regions) {
    lower = std::min(lower, region.polygon.lower().y());
    upper = std::max(upper, region.polygon.upper().y());
  }
  const Vec2 px(synth.slip_centre_px[0], synth.slip_centre_px[1]);
  const double pixel = std::sqrt(std::abs(setting.camera.jacobian(px).determinant()));
  slope.base = lower;
  slope.height = upper - lower;
  slope.front = 0.08 * slope.height;
  slope.settlement = synth.settlement;
  slope.collapse = synth.collapse;
  slope.centre = setting.camera.to_world(px);
  slope.radius = synth.slip_radius_px * pixel;
  slope.band = synth.slip_band_px * pixel;
  slope.turn = synth.slip_deg * std::numbers::pi / 180;
  return slope;
}

double uniform(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed * 0xd1342543de82ef95ULL + (index + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return double(z >> 11) * 0x1p-53;
}

std::vector<Vec2> scatter(const std::vector<Region>& regions, double per_area, std::uint64_t seed) {
  std::vector<Vec2> points;
  std::uint64_t index = 0;
  for (const Region& region : regions) {
    const Vec2 lower = region.polygon.lower(), extent = region.polygon.upper() - lower;
    const auto count = std::uint64_t(std::llround(extent.prod() * per_area));
    for (std::uint64_t k = 0; k < count; ++k, ++index) {
      const Vec2 x = lower + extent.cwiseProduct(Vec2(uniform(seed, 2 * index), uniform(seed, 2 * index + 1)));
      if (region.polygon.contains(x)) points.push_back(x);
    }
  }
  return points;
}

}  // namespace pivnp::app

#include "apps/study/truth.hpp"

#include <cmath>
#include <numbers>

#include "mpm/solver.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

// Pieces of time over which tracers are carried: short against any motion a frame can show, long against the solver's
// own step.
constexpr int pieces_per_frame = 100;

Mat2 velocity_gradient(const mpm::Solver::VelocityAt& v, const Vec2& x, double d) {
  Mat2 L;
  L.col(0) = (v(x + Vec2(d, 0)) - v(x - Vec2(d, 0))) / (2 * d);
  L.col(1) = (v(x + Vec2(0, d)) - v(x - Vec2(0, d))) / (2 * d);
  return L;
}

void carry(Tracers& tracers, const mpm::Solver::VelocityAt& v, double dt, double difference) {
  for (std::size_t p = 0; p < tracers.x.size(); ++p) {
    const Vec2 x = tracers.x[p];
    tracers.x[p] = x + dt * v(x);
    if (!tracers.F.empty())
      tracers.F[p] = (Mat2::Identity() + dt * velocity_gradient(v, x, difference)) * tracers.F[p];
  }
}

}  // namespace

AffineMotion affine_motion(const SynthOptions& synth, const Setting& setting) {
  AffineMotion motion;
  if (synth.motion == "none") return motion;
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

void carry_by_simulation(const Case& c, const Setting& setting, const std::vector<double>& times, Tracers texture,
                         Tracers seeds, int threads, Progress& progress, const AtFrame& at_frame) {
  mpm::Scene scene = make_scene(c, setting, *c.synth_mpm, c.synth_materials, "synth.material.");
  const double difference = 0.05 * scene.grid.spacing.x();
  mpm::Solver solver(*c.synth_mpm, std::move(scene), threads);
  if (c.synth_mpm->settle) solver.settle(progress);

  double pending = 0;                    // time since the tracers were carried last
  double piece = 0;
  bool last_step_of_frame = false;
  solver.on_step([&](double dt, const mpm::Solver::VelocityAt& velocity) {
    pending += dt;
    if (pending < piece && !last_step_of_frame) return;
    carry(texture, velocity, pending, difference);
    carry(seeds, velocity, pending, difference);
    pending = 0;
  });

  at_frame(0, texture, seeds);
  for (std::size_t k = 1; k < times.size(); ++k) {
    piece = (times[k] - times[k - 1]) / pieces_per_frame;
    // All but the last piece of the frame, then the rest so that no time is pending when it is drawn.
    last_step_of_frame = false;
    solver.advance_to(times[k] - piece / 2, progress);
    last_step_of_frame = true;
    solver.advance_to(times[k], progress);
    at_frame(int(k), texture, seeds);
    progress.update("synthetic frames", std::int64_t(k), std::int64_t(times.size()) - 1);
  }
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

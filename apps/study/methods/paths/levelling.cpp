#include "apps/study/methods/paths/levelling.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apps/study/methods/frames/texture.hpp"
#include "apps/study/methods/paths/levelled_error.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "compare/data/triangulation.hpp"
#include "compare/metrics/words.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

// The material at one time, and where it came from.
class CarriedPoints {
 public:
  CarriedPoints(const MotionSource& motion, double time) {
    const std::vector<double>& t = motion.times();
    const auto after = std::upper_bound(t.begin(), t.end(), time * (1 + 1e-12) + 1e-12);
    const std::size_t lower = std::size_t(std::max<std::ptrdiff_t>(0, after - t.begin() - 1));
    const std::size_t upper = std::min(lower + 1, t.size() - 1);
    const double w = upper > lower ? std::clamp((time - t[lower]) / (t[upper] - t[lower]), 0.0, 1.0) : 0;
    const MotionFrame a = motion.frame(lower), b = w > 0 ? motion.frame(upper) : a;
    const ParticleSet& set = motion.particles();
    std::vector<Vec2> x;
    std::vector<double> spacing;
    for (std::size_t p = 0; p < set.size(); ++p) {
      if (!alive(a.status[p]) || !alive(b.status[p])) continue;
      const Vec2 u =
          (1 - w) * Vec2(double(a.u[p][0]), double(a.u[p][1])) + w * Vec2(double(b.u[p][0]), double(b.u[p][1]));
      const Mat2 F = (1 - w) * matrix(a.F[p]) + w * matrix(b.F[p]);
      const double stretch = std::exp(principal(log_strain(F)).first);
      x.push_back(set.x0[p] + u);
      X_.push_back(set.x0[p]);
      back_.push_back(F.determinant() > 0 ? Mat2(F.inverse()) : Mat2(Mat2::Identity()));
      spacing.push_back(std::sqrt(double(set.area[p])) *
                        (std::isfinite(stretch) ? std::clamp(stretch, 1.0, 4.0) : 1.0));
    }
    mesh_ = std::make_unique<compare::MaterialMesh>(std::move(x), std::move(spacing));
  }

  std::optional<Vec2> origin(const Vec2& x) const {
    const auto place = mesh_->find(x);
    if (!place) return std::nullopt;
    Vec2 X = Vec2::Zero();
    Mat2 back = Mat2::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      if (place->vertex[k] < 0) continue;
      X += place->weight[k] * X_[std::size_t(place->vertex[k])];
      back += place->weight[k] * back_[std::size_t(place->vertex[k])];
    }
    return X + back * place->beyond;
  }

 private:
  std::vector<Vec2> X_;
  std::vector<Mat2> back_;
  std::unique_ptr<compare::MaterialMesh> mesh_;
};

class CarriedFrames final : public image::FrameSource {
 public:
  CarriedFrames(const Image& first, const std::vector<Frame>& frames, bool has_rate, const image::Camera& camera,
                const MotionSource& motion, double noise, std::uint64_t seed)
      : has_rate_(has_rate), camera_(camera), motion_(motion), seed_(seed), texture_(first, noise) {
    for (const Frame& f : frames)
      if (f.time <= motion.times().back() * (1 + 1e-12)) frames_.push_back(f);
    const CarriedPoints start(motion, motion.times().front());
    std::vector<float> background, all;
    for (int r = 0; r < height(); ++r)
      for (int c = 0; c < width(); ++c) {
        material_.push_back(start.origin(camera.to_world({double(c), double(r)})).has_value());
        (material_.back() ? all : background).push_back(texture_.still(c, r));
      }
    std::vector<float>& of = background.empty() ? all : background;
    std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(of.size() / 2), of.end());
    background_ = of[of.size() / 2];
  }

  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return has_rate_; }
  int width() const override { return texture_.width(); }
  int height() const override { return texture_.height(); }

  Image read(int index) override {
    const CarriedPoints now(motion_, frames_.at(std::size_t(index)).time);
    const auto grey = [&](int c, int r) {
      if (index == 0) return double(texture_.still(c, r));
      if (const auto X = now.origin(camera_.to_world({double(c), double(r)}))) {
        const Vec2 from = camera_.to_pixel(*X);
        if (from.x() > -0.5 && from.y() > -0.5 && from.x() < width() - 0.5 && from.y() < height() - 0.5) return texture_.at(from);
      }
      return double(material_[std::size_t(r) * std::size_t(width()) + std::size_t(c)] ? background_ : texture_.still(c, r));
    };
    return texture_.draw(grey, seed_, std::uint64_t(index));
  }

 private:
  std::vector<Frame> frames_;
  bool has_rate_;
  image::Camera camera_;
  const MotionSource& motion_;
  std::uint64_t seed_;
  CarriedTexture texture_;
  std::vector<std::uint8_t> material_;  // at the first frame
  float background_ = 0;
};

}  // namespace

std::unique_ptr<image::FrameSource> carried_frames(const Image& first, const std::vector<Frame>& frames, bool has_rate,
                                                   const image::Camera& camera, const MotionSource& motion,
                                                   double noise, std::uint64_t seed) {
  return std::make_unique<CarriedFrames>(first, frames, has_rate, camera, motion, noise, seed);
}

void add_levelled(const Case& c, const Setting& setting, const RunSettings& settings, image::FrameSource& source,
                  const std::vector<Frame>& frames, const io::RecordWriter& writer, const MotionSource& measured,
                  const MotionSource& simulated, const StrainNote& note, const compare::CompareOptions& options,
                  Comparison& comparison, Progress& progress) {
  std::vector<Vec2> nodes;
  for (int j = 0; j < setting.grid.ny; ++j)
    for (int i = 0; i < setting.grid.nx; ++i) nodes.push_back(setting.camera.to_pixel(setting.grid.position(i, j)));
  std::vector<VectorField> pairs;
  const std::size_t count = frames.size() - 1, stride = count / 5 + 1;  // a few say enough of the camera's noise
  for (std::size_t k = 0; k < count; k += stride) pairs.push_back(writer.pair(k));
  const Image first = source.read(0);
  const double noise = noise_variance(first.view(), nodes, c.piv.value_or(piv::PivOptions{}).window_px, pairs);
  const auto carried = carried_frames(first, frames, source.has_rate(), setting.camera, simulated, noise, 1);

  io::RecordHead head = record_head(c, setting, settings);
  head.time_unit = measured.time_unit();
  head.camera_residual = setting.camera.residual();
  RunSettings own = settings;
  own.out = settings.out / "levelled";
  std::error_code failed;
  std::filesystem::create_directories(own.out, failed);
  if (failed) throw RunError(own.out.string() + ": " + failed.message());
  io::RecordWriter levelled(own.out, head, settings.resume, settings.threads);
  Setting at_rest = setting;  // the frames that are drawn
  set_camera_motion({}, at_rest);
  Case drawn = c;
  drawn.camera.row_time_s = 0;
  measure(drawn, at_rest, *carried, levelled, settings.threads, progress);
  levelled.set_frames(carried->frames());
  track(drawn, at_rest, carried->frames(), carried.get(), {}, levelled, settings.threads, progress);
  levelled.set_strain_note("np", note);
  levelled.pack();
  {
    const Comparison departures = compare::compare(*levelled.motion("np"), simulated, {}, {}, progress, {}, {note, {}});
    const LevelledMotion motion(levelled.motion("np"), departures);
    const Comparison like = compare::compare(measured, motion, options, {}, progress, {}, {note, note});
    for (Metric m : like.metrics) {
      const auto known = compare::known_metric(m.name);
      if (!known || !known->facts->levelled) continue;
      m.name.insert(0, compare::levelled_prefix);
      if (m.verdict == Verdict::differs) m.verdict = Verdict::larger;  // measured, but of a simulation with its mesh
      m.definition += "; second: the simulation as it would have been measured (first frame carried by its motion, "
                      "same PIV and particles)";
      comparison.metrics.push_back(std::move(m));
    }
  }
  levelled.finish();
  comparison.remarks.push_back(
      "Levelled: the simulation was also measured from the first frame carried by its motion, with "
      "fresh noise of " +
      number(std::sqrt(noise), 3) +
      " grey values (standard deviation). Where that measurement departs from the simulation by more than three of its "
      "stated "
      "standard deviations, the departure is part of its uncertainty.");
}

}  // namespace pivnp::app

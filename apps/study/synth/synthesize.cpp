#include "apps/study/synth/synthesize.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "apps/study/pipeline/scene/placed.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "apps/study/pipeline/scene/sizes.hpp"
#include "apps/study/synth/drawn_frames.hpp"
#include "apps/study/synth/material_map.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/files/write.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

std::vector<Vec2> to_pixels(const std::vector<Vec2>& world, const image::Camera& camera) {
  std::vector<Vec2> px(world.size());
  for (std::size_t p = 0; p < world.size(); ++p) {
    px[p] = camera.to_pixel(world[p]);
    if (!px[p].allFinite()) px[p].setConstant(-1e6);  // not in the image
  }
  return px;
}

// The grains of a texture whose material has a deformation gradient. A grain is round when it comes to be.
class Grains {
 public:
  /// `deform`: false: grains stay round, whatever the material does.
  Grains(bool deform, const Mat2& world_from_pixel) : deform_(deform), J_(world_from_pixel), back_(world_from_pixel.inverse()) {}

  void make(std::size_t count) { birth_.assign(count, Mat2::Identity()); }
  void renew(std::size_t grain, const Mat2& F) { birth_[grain] = F.determinant() > 0 ? Mat2(F.inverse()) : Mat2(Mat2::Identity()); }
  bool deform() const { return deform_; }
  /// In pixels (column, row).
  Mat2 shape(std::size_t grain, const Mat2& F) const { return back_ * F * birth_[grain] * J_; }

 private:
  bool deform_;
  Mat2 J_, back_;
  std::vector<Mat2> birth_;
};

MotionFrame truth_frame(double time, const ParticleSet& set, const std::vector<Vec2>& x, const std::vector<Mat2>& F) {
  MotionFrame frame;
  frame.time = time;
  for (std::size_t p = 0; p < x.size(); ++p) {
    const Vec2 u = x[p] - set.x0[p];
    frame.u.push_back({float(u.x()), float(u.y())});
    frame.F.push_back({float(F[p](0, 0)), float(F[p](0, 1)), float(F[p](1, 0)), float(F[p](1, 1))});
  }
  frame.status.assign(x.size(), ParticleStatus::active);
  return frame;
}

// The frames of one case and their truth, as far as they are drawn.
class Drawing {
 public:
  Drawing(const Case& c, const RunSettings& settings)
      : c_(c),
        synth_(*c.synth),
        setting_(make_setting(c, synth_.width_px, synth_.height_px)),
        drawn_(c, settings.out / "frames"),
        particles_(seed_particles(c, setting_)),
        writer_(settings.out / "truth", record_head(c, setting_, settings), false, settings.threads),
        renderer_(c.texture, synth_.width_px, synth_.height_px) {
    const double rate = c.frames && c.frames->rate_hz ? *c.frames->rate_hz : 1.0;
    for (int k = 0; k < synth_.frames; ++k) times_.push_back(k / rate);
    pixel_ = std::sqrt(std::abs(middle_jacobian().determinant()));
    if (c.synth_camera.moves()) set_camera_motion(drawn_camera(c), setting_);
    if (!c.synth_camera.still_px.empty()) {
      std::vector<Vec2> corners;
      for (const Pair& p : c.synth_camera.still_px) corners.push_back(setting_.camera.to_world({p[0], p[1]}));
      still_.emplace(corners, "synth.camera.still_px");
      still_texture_ = scatter({{"still", *still_}}, blobs_per_area(), seed() + 15485863);
    }
    drawn_.begin();
    writer_.begin_motion("truth", particles_);
  }

  void by_simulation(int threads, Progress& progress);
  void by_record(Progress& progress);
  void by_stages(Progress& progress);
  void by_increments(Progress& progress);

  void finish() {
    writer_.end_stage("motion/truth", &particles_);
    writer_.set_frames(frames_);
    writer_.finish();
    drawn_.finish();
  }

 private:
  Mat2 middle_jacobian() const { return setting_.camera.jacobian({synth_.width_px / 2.0, synth_.height_px / 2.0}); }
  std::uint64_t seed() const { return std::uint64_t(c_.texture.seed); }
  std::uint64_t seed_of(int frame) const { return seed() + 977 * std::uint64_t(frame); }
  double blobs_per_area() const { return c_.texture.density_per_px / (pixel_ * pixel_); }

  using State = std::function<MotionFrame(std::size_t k)>;
  void by_points(const ParticleSet& points, const State& state, Progress& progress);

  // Frame `k` and its truth. `shapes`: of the grains, px; empty: round. `seeds`: where the particles are, `F` their
  // deformation gradients.
  void put(int k, const std::vector<Vec2>& texture, const std::vector<Mat2>& shapes, const std::vector<Vec2>& seeds,
           const std::vector<Mat2>& F) {
    const std::string name = DrawnFrames::name(k);
    drawn_.draws(k);
    image::write_image(renderer_.draw(filmed(k, texture), k, synth_.frames, with_still(shapes)).view(), drawn_.folder() / name);
    frames_.push_back({name, times_[std::size_t(k)], frame_ok});
    writer_.add_frame("truth", truth_frame(times_[std::size_t(k)], particles_, seeds, F));
    if (writer_.segment_full("motion/truth")) writer_.close_segment("motion/truth", {});
  }

  // Where blobs are in the image of frame `k`, taken by a camera that may have moved.
  std::vector<Vec2> filmed(int k, std::vector<Vec2> texture) const {
    if (still_) {
      for (Vec2& x : texture)
        if (still_->contains(x)) x.setConstant(nan_value);
      texture.insert(texture.end(), still_texture_.begin(), still_texture_.end());
    }
    return to_pixels(texture, setting_.camera_at(k));
  }

  // Shapes of the grains that filmed() gives: those of the still zone are round.
  std::vector<Mat2> with_still(std::vector<Mat2> shapes) const {
    if (!shapes.empty()) shapes.resize(shapes.size() + still_texture_.size(), Mat2::Identity());
    return shapes;
  }

  // Between frames: asked to stop, and how far it has come.
  void check(Progress& progress) const {
    if (progress.stop_requested()) throw Interrupted();
  }
  void report(int k, Progress& progress) const { progress.update("synthetic frames", k, synth_.frames - 1); }

  const Case& c_;
  const SynthOptions& synth_;
  Setting setting_;
  std::optional<Polygon> still_;       // texture at rest, in the world
  std::vector<Vec2> still_texture_;
  const DrawnFrames drawn_;
  const ParticleSet particles_;
  io::RecordWriter writer_;
  const image::BlobRenderer renderer_;
  std::vector<double> times_;
  double pixel_ = 1;  // length of one in the image's middle
  std::vector<Frame> frames_;
};

void Drawing::by_points(const ParticleSet& points, const State& state, Progress& progress) {
  MaterialMap map(points);
  std::vector<Vec2> material = scatter(setting_.regions, blobs_per_area(), seed());
  using Stencil = std::optional<MaterialMap::Stencil>;  // nothing: no material point is near, so it stands still
  std::vector<Stencil> carried(material.size()), of_seed;
  for (std::size_t n = 0; n < material.size(); ++n) carried[n] = map.stencil(material[n]);
  for (const Vec2& X : particles_.x0) of_seed.push_back(map.stencil(X));
  Grains grains(synth_.grains_deform, middle_jacobian());
  grains.make(material.size());
  writer_.begin_motion("material", points);
  std::vector<Vec2> seeds = particles_.x0;
  std::vector<Mat2> F(particles_.size(), Mat2::Identity());
  const double aside = 2 * c_.grid.spacing_px.value_or(16) * pixel_;
  for (int k = 0; k < synth_.frames; ++k) {
    check(progress);
    MotionFrame now = state(std::size_t(k));
    map.set(now);
    // Lost blobs reappear where another one is, a little aside: inside the material, wherever that has gone.
    const std::vector<Vec2> before = material;
    const std::vector<std::size_t> lost = renderer_.lost(material.size(), k);
    for (std::size_t n = 0; n < lost.size(); ++n) {
      const auto host = std::size_t(uniform(seed_of(k), 3 * n) * double(before.size()));
      const Vec2 X = before[host] + aside * Vec2(uniform(seed_of(k), 3 * n + 1) - 0.5, uniform(seed_of(k), 3 * n + 2) - 0.5);
      Stencil found = map.stencil(X);
      material[lost[n]] = found ? X : before[host];
      carried[lost[n]] = found ? found : map.stencil(before[host]);
      if (carried[lost[n]]) grains.renew(lost[n], map.F(*carried[lost[n]]));
    }
    std::vector<Vec2> texture(material.size());
    std::vector<Mat2> shapes;
    for (std::size_t n = 0; n < material.size(); ++n) texture[n] = carried[n] ? map.at(*carried[n]) : material[n];
    if (grains.deform())
      for (std::size_t n = 0; n < material.size(); ++n)
        shapes.push_back(grains.shape(n, carried[n] ? map.F(*carried[n]) : Mat2(Mat2::Identity())));
    for (std::size_t p = 0; p < seeds.size(); ++p) {
      if (!of_seed[p]) continue;
      const Vec2 x = map.at(*of_seed[p]);
      if (!x.allFinite()) continue;  // its points have ended: where they were last
      seeds[p] = x;
      F[p] = map.F(*of_seed[p]);
    }
    put(k, texture, shapes, seeds, F);
    now.time = times_[std::size_t(k)];
    now.cov_u.clear();
    now.v.clear();
    now.fields.clear();
    writer_.add_frame("material", now);
    if (writer_.segment_full("motion/material")) writer_.close_segment("motion/material", {});
    report(k, progress);
  }
}

void Drawing::by_simulation(int threads, Progress& progress) {
  mpm::Solver solver(*c_.synth_mpm, make_scene(c_, setting_, *c_.synth_mpm, c_.synth_materials, "synth.material."), threads);
  if (c_.synth_mpm->initial_equilibrium) solver.find_initial_equilibrium(progress);
  by_points(solver.particles(),
            [&](std::size_t k) {
              solver.advance_to(times_[k], progress);
              return solver.frame();
            },
            progress);
  writer_.end_stage("motion/material", &solver.particles());
}

void Drawing::by_record(Progress& progress) {
  // A file's name may hold a colon, and a motion's name follows one: the folder of the case comes before either.
  const OpenedMotion opened = open_motion((c_.folder / synth_.record).string(), {});
  const MotionSource& motion = *opened.motion;
  if (motion.length_unit() != setting_.camera.length_unit())
    throw InputError("synth.record: the motion's unit of length is '" + motion.length_unit() + "', the camera's '" +
                     setting_.camera.length_unit() + "'; expected the same");
  const std::vector<double>& recorded = motion.times();
  const double near = 1e-3 * (times_[1] - times_[0]);
  std::vector<std::size_t> index;
  for (const double time : times_) {
    const auto at = std::lower_bound(recorded.begin(), recorded.end(), time - near);
    if (at == recorded.end() || *at > time + near)
      throw InputError("synth.record: the motion has no state at " + number(time) + " " + motion.time_unit() +
                       ", the time of a frame (synth.frames, frames.rate_hz); expected one at every frame");
    index.push_back(std::size_t(at - recorded.begin()));
  }
  by_points(motion.particles(), [&](std::size_t k) { return motion.frame(index[k]); }, progress);
  writer_.end_stage("motion/material", &motion.particles());
}

void Drawing::by_stages(Progress& progress) {
  const StagedSlope slope = staged_slope(synth_, setting_);
  std::vector<Vec2> material = scatter(setting_.regions, blobs_per_area(), seed());
  Grains grains(synth_.grains_deform, middle_jacobian());
  grains.make(material.size());
  for (int k = 0; k < synth_.frames; ++k) {
    check(progress);
    const double time = double(k) / (synth_.frames - 1);
    // A lost blob is another one from then on, of other material: where another is, a little aside.
    const std::vector<Vec2> before = material;
    const std::vector<std::size_t> lost = renderer_.lost(material.size(), k);
    for (std::size_t n = 0; n < lost.size(); ++n) {
      const auto host = std::size_t(uniform(seed_of(k), 3 * n) * double(before.size()));
      material[lost[n]] = before[host] + 32 * pixel_ * Vec2(uniform(seed_of(k), 3 * n + 1) - 0.5, uniform(seed_of(k), 3 * n + 2) - 0.5);
      grains.renew(lost[n], slope.F(material[lost[n]], time));
    }
    std::vector<Vec2> texture, seeds;
    std::vector<Mat2> F, shapes;
    for (const Vec2& X : material) texture.push_back(slope.at(X, time));
    if (grains.deform())
      for (std::size_t n = 0; n < material.size(); ++n) shapes.push_back(grains.shape(n, slope.F(material[n], time)));
    for (const Vec2& X : particles_.x0) seeds.push_back(slope.at(X, time)), F.push_back(slope.F(X, time));
    put(k, texture, shapes, seeds, F);
    report(k, progress);
  }
}

void Drawing::by_increments(Progress& progress) {
  const AffineMotion motion = affine_motion(synth_, setting_);
  // Everything the image ever shows: its own extent, and what the motion brings in from outside.
  const Vec2 a = setting_.camera.to_world({0, synth_.height_px - 1.0}),
             b = setting_.camera.to_world({synth_.width_px - 1.0, 0});
  Vec2 lower = a.cwiseMin(b), upper = a.cwiseMax(b);
  const Mat2 back = motion.A.inverse();
  for (int corner = 0; corner < 4; ++corner) {
    Vec2 x(corner & 1 ? b.x() : a.x(), corner & 2 ? b.y() : a.y());
    for (int k = 1; k < synth_.frames; ++k) {
      x = motion.centre + back * (x - motion.shift - motion.centre);
      lower = lower.cwiseMin(x);
      upper = upper.cwiseMax(x);
    }
  }
  const Vec2 edge = Vec2::Constant(4 * c_.texture.blob_diameter_px * pixel_);
  lower -= edge;
  upper += edge;
  require_at_most((upper - lower).prod() * blobs_per_area(), most_blobs, "blobs over the ground that is seen",
                  "synth.frames", std::to_string(synth_.frames));
  const std::vector<Region> everywhere = {
      {"all", Polygon({lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}}, "texture")}};
  std::vector<Vec2> texture = scatter(everywhere, blobs_per_area(), seed());
  Grains grains(synth_.grains_deform, middle_jacobian());
  grains.make(texture.size());
  const auto anywhere = [&](std::uint64_t from, std::size_t n) {
    return Vec2(lower + (upper - lower).cwiseProduct(Vec2(uniform(from, 2 * n), uniform(from, 2 * n + 1))));
  };
  for (int k = 0; k < synth_.frames; ++k) {
    check(progress);
    if (k > 0)
      for (Vec2& x : texture) x = motion.next(x);
    const Mat2 F = motion.F(k);
    const auto replace = [&](std::size_t n, std::uint64_t from) {
      texture[n] = anywhere(from, n);
      grains.renew(n, F);
    };
    if (const int since = k - synth_.lose_texture_at; synth_.lose_texture_at > 0 && since >= 0 && since < 10)
      for (std::size_t n = std::size_t(since); n < texture.size(); n += 10) replace(n, seed() + 104729);
    for (const std::size_t n : renderer_.lost(texture.size(), k)) replace(n, seed_of(k));
    std::vector<Vec2> seeds;
    std::vector<Mat2> shapes;
    if (grains.deform())
      for (std::size_t n = 0; n < texture.size(); ++n) shapes.push_back(grains.shape(n, F));
    for (const Vec2& x0 : particles_.x0) seeds.push_back(motion.at(x0, k));
    put(k, texture, shapes, seeds, std::vector<Mat2>(particles_.size(), F));
    report(k, progress);
  }
}

}  // namespace

void synthesize(const Case& c, const RunSettings& settings, Progress& progress, const io::DirectoryLock* held) {
  if (!c.synth) throw InputError(of_file(c) + ": there is no [synth] table, so there is nothing to draw");
  placed(c, settings, [&] {
    require_drawable(*c.synth, c.texture);
    std::optional<io::DirectoryLock> own;
    if (held == nullptr) own.emplace(settings.out);
    Drawing drawing(c, settings);
    if (c.synth->motion == SynthMotion::mpm)
      drawing.by_simulation(settings.threads, progress);
    else if (c.synth->motion == SynthMotion::record)
      drawing.by_record(progress);
    else if (c.synth->motion == SynthMotion::slope)
      drawing.by_stages(progress);
    else
      drawing.by_increments(progress);
    drawing.finish();
  });
}

}  // namespace pivnp::app

#include "apps/study/synth/synthesize.hpp"

#include <Eigen/LU>
#include <cmath>
#include <optional>

#include "apps/study/pipeline/placed.hpp"
#include "apps/study/pipeline/record_head.hpp"
#include "apps/study/pipeline/sizes.hpp"
#include "apps/study/synth/drawn_frames.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/synthetic.hpp"
#include "pivnp/image/write.hpp"
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

// Lost blobs reappear where another one is, a little aside: inside the material, wherever that has gone.
void replace_lost(std::vector<Vec2>& x, const std::vector<std::size_t>& lost, double aside, std::uint64_t seed) {
  const std::vector<Vec2> before = x;
  for (std::size_t n = 0; n < lost.size(); ++n) {
    const auto host = std::size_t(uniform(seed, 3 * n) * double(before.size()));
    x[lost[n]] = before[host] + aside * Vec2(uniform(seed, 3 * n + 1) - 0.5, uniform(seed, 3 * n + 2) - 0.5);
  }
}

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
    const Mat2 J = setting_.camera.jacobian({synth_.width_px / 2.0, synth_.height_px / 2.0});
    pixel_ = std::sqrt(std::abs(J.determinant()));
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
  void by_stages(Progress& progress);
  void by_increments(Progress& progress);

  void finish() {
    writer_.end_stage("motion/truth", &particles_);
    writer_.set_frames(frames_);
    writer_.finish();
    drawn_.finish();
  }

 private:
  std::uint64_t seed() const { return std::uint64_t(c_.texture.seed); }
  std::uint64_t seed_of(int frame) const { return seed() + 977 * std::uint64_t(frame); }
  double blobs_per_area() const { return c_.texture.density_per_px / (pixel_ * pixel_); }

  // Frame `k` and its truth. `seeds`: where the particles are, `F` their deformation gradients.
  void put(int k, const std::vector<Vec2>& texture, const std::vector<Vec2>& seeds, const std::vector<Mat2>& F) {
    const std::string name = DrawnFrames::name(k);
    image::write_image(renderer_.draw(filmed(k, texture), k, synth_.frames).view(), drawn_.folder() / name);
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

void Drawing::by_simulation(int threads, Progress& progress) {
  Tracers texture{scatter(setting_.regions, blobs_per_area(), seed()), {}};
  Tracers seeds{particles_.x0, std::vector<Mat2>(particles_.size(), Mat2::Identity())};
  const double aside = 2 * c_.grid.spacing_px.value_or(16) * pixel_;
  carry_by_simulation(c_, setting_, times_, std::move(texture), std::move(seeds), threads, progress,
                      [&](int k, Tracers& blobs, const Tracers& truth) {
                        replace_lost(blobs.x, renderer_.lost(blobs.x.size(), k), aside, seed_of(k));
                        put(k, blobs.x, truth.x, truth.F);
                      });
}

void Drawing::by_stages(Progress& progress) {
  const StagedSlope slope = staged_slope(synth_, setting_);
  std::vector<Vec2> material = scatter(setting_.regions, blobs_per_area(), seed());
  for (int k = 0; k < synth_.frames; ++k) {
    check(progress);
    const double time = double(k) / (synth_.frames - 1);
    // A lost blob is another one from then on, of other material.
    replace_lost(material, renderer_.lost(material.size(), k), 32 * pixel_, seed_of(k));
    std::vector<Vec2> texture, seeds;
    std::vector<Mat2> F;
    for (const Vec2& X : material) texture.push_back(slope.at(X, time));
    for (const Vec2& X : particles_.x0) seeds.push_back(slope.at(X, time)), F.push_back(slope.F(X, time));
    put(k, texture, seeds, F);
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
  const auto anywhere = [&](std::uint64_t from, std::size_t n) {
    return Vec2(lower + (upper - lower).cwiseProduct(Vec2(uniform(from, 2 * n), uniform(from, 2 * n + 1))));
  };
  for (int k = 0; k < synth_.frames; ++k) {
    check(progress);
    if (k > 0)
      for (Vec2& x : texture) x = motion.next(x);
    if (const int since = k - synth_.lose_texture_at; synth_.lose_texture_at > 0 && since >= 0 && since < 10)
      for (std::size_t n = std::size_t(since); n < texture.size(); n += 10) texture[n] = anywhere(seed() + 104729, n);
    for (const std::size_t n : renderer_.lost(texture.size(), k)) texture[n] = anywhere(seed_of(k), n);
    std::vector<Vec2> seeds;
    for (const Vec2& x0 : particles_.x0) seeds.push_back(motion.at(x0, k));
    put(k, texture, seeds, std::vector<Mat2>(particles_.size(), motion.F(k)));
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
    else if (c.synth->motion == SynthMotion::slope)
      drawing.by_stages(progress);
    else
      drawing.by_increments(progress);
    drawing.finish();
  });
}

}  // namespace pivnp::app

#include "apps/study/synth/synthesize.hpp"

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/synthetic.hpp"
#include "pivnp/image/write.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

std::vector<Vec2> to_pixels(const std::vector<Vec2>& world, const image::Camera& camera) {
  std::vector<Vec2> px(world.size());
  for (std::size_t p = 0; p < world.size(); ++p) px[p] = camera.to_pixel(world[p]);
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

}  // namespace

void synthesize(const Case& c, const RunSettings& settings, Progress& progress) {
  if (!c.synth) throw InputError((c.file.empty() ? c.name : c.file.string()) + ": no [synth] table: nothing to draw");
  const SynthOptions& synth = *c.synth;
  const Setting setting = make_setting(c, synth.width_px, synth.height_px);
  const double rate = c.frames && c.frames->rate_hz ? *c.frames->rate_hz : 1.0;
  std::vector<double> times;
  for (int k = 0; k < synth.frames; ++k) times.push_back(k / rate);

  const fs::path folder = settings.out / "frames";
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw RunError(folder.string() + ": " + failed.message());

  const ParticleSet particles = seed_particles(c, setting);
  io::RecordHead head;
  head.command = settings.command;
  head.case_text = write_case(c);
  head.length_unit = setting.camera.length_unit();
  head.grid = setting.grid;
  head.world_from_pixel = setting.camera.world_from_pixel();
  io::RecordWriter writer(settings.out / "truth", head, false, settings.threads);
  writer.begin_motion("truth", particles);

  const image::BlobRenderer renderer(c.texture, synth.width_px, synth.height_px);
  const auto seed = std::uint64_t(c.texture.seed);
  const double pixel = std::sqrt(std::abs(setting.camera.jacobian({synth.width_px / 2.0, synth.height_px / 2.0}).determinant()));
  std::vector<Frame> frames;
  auto put = [&](int k, const std::vector<Vec2>& texture, const std::vector<Vec2>& seeds, const std::vector<Mat2>& F) {
    char name[32];
    std::snprintf(name, sizeof name, "frame_%05d.png", k);
    image::write_image(renderer.draw(to_pixels(texture, setting.camera), k, synth.frames).view(), folder / name);
    frames.push_back({name, times[std::size_t(k)], frame_ok});
    writer.add_frame("truth", truth_frame(times[std::size_t(k)], particles, seeds, F));
    if (writer.segment_full("motion/truth")) writer.close_segment("motion/truth", {});
  };

  if (synth.motion == SynthMotion::mpm) {
    Tracers texture{scatter(setting.regions, c.texture.density_per_px / (pixel * pixel), seed), {}};
    Tracers seeds{particles.x0, std::vector<Mat2>(particles.size(), Mat2::Identity())};
    carry_by_simulation(c, setting, times, std::move(texture), std::move(seeds), settings.threads, progress,
                        [&](int k, Tracers& blobs, const Tracers& truth) {
                          replace_lost(blobs.x, renderer.lost(blobs.x.size(), k), 2 * c.grid.spacing_px.value_or(16) * pixel, seed + 977 * std::uint64_t(k));
                          put(k, blobs.x, truth.x, truth.F);
                        });
  } else if (synth.motion == SynthMotion::slope) {
    const StagedSlope slope = staged_slope(synth, setting);
    std::vector<Vec2> material = scatter(setting.regions, c.texture.density_per_px / (pixel * pixel), seed);
    for (int k = 0; k < synth.frames; ++k) {
      if (progress.stop_requested()) throw Interrupted();
      const double time = double(k) / (synth.frames - 1);
      // A lost blob is another one from then on, of other material.
      replace_lost(material, renderer.lost(material.size(), k), 32 * pixel, seed + 977 * std::uint64_t(k));
      std::vector<Vec2> texture, seeds;
      std::vector<Mat2> F;
      for (const Vec2& X : material) texture.push_back(slope.at(X, time));
      for (const Vec2& X : particles.x0) seeds.push_back(slope.at(X, time)), F.push_back(slope.F(X, time));
      put(k, texture, seeds, F);
      progress.update("synthetic frames", k, synth.frames - 1);
    }
  } else {
    const AffineMotion motion = affine_motion(synth, setting);
    // Everything the image ever shows: its own extent, and what the motion brings in from outside.
    const Vec2 a = setting.camera.to_world({0, synth.height_px - 1.0}), b = setting.camera.to_world({synth.width_px - 1.0, 0});
    Vec2 lower = a.cwiseMin(b), upper = a.cwiseMax(b);
    const Mat2 back = motion.A.inverse();
    for (int corner = 0; corner < 4; ++corner) {
      Vec2 x(corner & 1 ? b.x() : a.x(), corner & 2 ? b.y() : a.y());
      for (int k = 1; k < synth.frames; ++k) {
        x = motion.centre + back * (x - motion.shift - motion.centre);
        lower = lower.cwiseMin(x);
        upper = upper.cwiseMax(x);
      }
    }
    const Vec2 edge = Vec2::Constant(4 * c.texture.blob_diameter_px * pixel);
    lower -= edge;
    upper += edge;
    const std::vector<Region> everywhere = {{"all", Polygon({lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}}, "texture")}};
    std::vector<Vec2> texture = scatter(everywhere, c.texture.density_per_px / (pixel * pixel), seed);
    for (int k = 0; k < synth.frames; ++k) {
      if (progress.stop_requested()) throw Interrupted();
      if (k > 0)
        for (Vec2& x : texture) x = motion.next(x);
      if (const int since = k - synth.lose_texture_at; synth.lose_texture_at > 0 && since >= 0 && since < 10)
        for (std::size_t n = std::size_t(since); n < texture.size(); n += 10)
          texture[n] = lower + (upper - lower).cwiseProduct(Vec2(uniform(seed + 104729, 2 * n), uniform(seed + 104729, 2 * n + 1)));
      for (const std::size_t n : renderer.lost(texture.size(), k))
        texture[n] = lower + (upper - lower).cwiseProduct(Vec2(uniform(seed + 977 * std::uint64_t(k), 2 * n), uniform(seed + 977 * std::uint64_t(k), 2 * n + 1)));
      std::vector<Vec2> seeds;
      for (const Vec2& x0 : particles.x0) seeds.push_back(motion.at(x0, k));
      put(k, texture, seeds, std::vector<Mat2>(particles.size(), motion.F(k)));
      progress.update("synthetic frames", k, synth.frames - 1);
    }
  }
  writer.end_stage("motion/truth", &particles);
  writer.set_frames(frames);
  writer.finish();
}

}  // namespace pivnp::app

#include "apps/study/studies/verify.hpp"

#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "apps/plot/chart.hpp"
#include "apps/plot/files.hpp"
#include "apps/study/methods/frames/camera_motion.hpp"
#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "apps/study/synth/synthesize.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/records/record.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

namespace {

/// Where a particle truly is at the last frame, and its deformation gradient.
using Truth = std::function<void(const ParticleSet&, std::size_t particle, Vec2& x, Mat2& F)>;

struct Errors {
  double displacement_rms = 0;  // length
  double displacement_max = 0;
  double mean_strain = 0;       // greatest component of the error of the mean log strain
  double strain_max = 0;        // greatest component of any particle's error
  double lost_share = 0;
};

double greatest(const Strain& e) { return std::max({std::abs(e.xx), std::abs(e.yy), std::abs(e.xy)}); }

Errors errors_of(const np::Tracker& tracker, const Truth& truth) {
  Errors e;
  Strain mean;
  std::size_t alive = 0;
  double sum = 0;
  for (std::size_t p = 0; p < tracker.state().size(); ++p) {
    const np::Tracker::Particle& particle = tracker.state()[p];
    if (particle.status == ParticleStatus::ended) continue;
    ++alive;
    Vec2 x;
    Mat2 F;
    truth(tracker.particles(), p, x, F);
    const double miss = (particle.x - x).norm();
    sum += miss * miss;
    e.displacement_max = std::max(e.displacement_max, miss);
    const Strain found = log_strain(particle.F), real = log_strain(F);
    const Strain difference{found.xx - real.xx, found.yy - real.yy, found.xy - real.xy};
    e.strain_max = std::max(e.strain_max, greatest(difference));
    mean.xx += difference.xx;
    mean.yy += difference.yy;
    mean.xy += difference.xy;
  }
  const double n = std::max<double>(1, double(alive));
  e.displacement_rms = std::sqrt(sum / n);
  e.mean_strain = greatest({mean.xx / n, mean.yy / n, mean.xy / n});
  e.lost_share = 1 - double(alive) / double(tracker.state().size());
  return e;
}

// The increments of an affine motion at the nodes, exact for the forward anchor.
VectorField nodal_increments(const AffineMotion& motion, const Grid& grid, int pair) {
  VectorField field;
  field.pair = {pair, pair + 1};
  field.anchor = Anchor::forward;
  field.grid = grid;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const Vec2 x = grid.position(i, j), d = motion.next(x) - x;
      field.displacement.push_back({float(d.x()), float(d.y())});
    }
  field.status.assign(grid.node_count(), VectorStatus::valid);
  field.cov.assign(grid.node_count(), {0, 0, 0});
  field.score.assign(grid.node_count(), 1);
  return field;
}

// RMS error of the living particles' displacement, frame by frame, px.
struct Curve {
  std::string scheme;
  std::vector<double> rms_px;
};

// A case whose frames are drawn and measured, and what is known of its motion.
struct Measurement {
  const Case& c;
  const Setting setting;
  const std::unique_ptr<image::FrameSource> source;
  const std::unique_ptr<io::RecordWriter> writer;
  const std::unique_ptr<MotionSource> drawn;  // the truth, at the seeds
  const AffineMotion motion;                  // of every frame, where `affine`
  bool affine = true;

  const std::vector<Frame>& frames() const { return source->frames(); }
  int last() const { return int(frames().size()) - 1; }
  double pixel() const { return setting.grid.spacing.x() / node_spacing_px(setting); }
};

std::unique_ptr<image::FrameSource> open_drawn(const Case& c, const fs::path& folder) {
  image::FrameOptions drawn;
  drawn.path = (folder / "frame_*.png").string();
  drawn.rate_hz = c.frames && c.frames->rate_hz ? *c.frames->rate_hz : 1.0;
  return image::open_frames(drawn, "");
}

Measurement draw_and_measure(const Case& c, const RunSettings& settings, Progress& progress) {
  const auto lock = std::make_shared<io::DirectoryLock>(settings.out);
  synthesize(c, settings, progress, lock.get());
  std::unique_ptr<image::FrameSource> source = open_drawn(c, settings.out / "frames");
  Setting setting = make_setting(c, source->width(), source->height());
  auto writer =
      std::make_unique<io::RecordWriter>(settings.out, record_head(c, setting, settings), false, settings.threads, lock);
  follow_masks(c, setting, *source, settings.threads, progress);
  set_camera_motion(find_camera_motion(c, setting, *source, settings.threads, progress), setting);
  writer->set_camera_motion(setting.camera_motion);
  set_filter(c, *source, settings.threads, progress, setting);
  measure(c, setting, *source, *writer, settings.threads, progress);
  const io::RecordReader truth(settings.out / "truth" / "record.h5");
  const AffineMotion motion = affine_motion(*c.synth, setting);
  return {c, std::move(setting), std::move(source), std::move(writer), truth.motion("truth"), motion,
          c.synth->motion == SynthMotion::affine || c.synth->motion == SynthMotion::none};
}

Curve drift_curve(const Measurement& m, const Measured& measured, np::DriftScheme scheme, int threads,
                  Progress& progress) {
  Case variant = m.c;
  variant.np = m.c.np.value_or(np::NpOptions{});
  variant.np->drift = scheme;
  variant.np->reseed = false;
  Curve curve;
  curve.scheme = scheme == np::DriftScheme::none               ? "summed increments"
                 : scheme == np::DriftScheme::reference_update ? "reference update"
                                                               : std::string(name_of(scheme));
  follow(variant, m.setting, m.frames(), measured, threads, progress, [&](std::size_t k, const np::Tracker& now) {
    const MotionFrame real = m.drawn->frame(k);
    double sum = 0;
    std::size_t alive = 0;
    for (std::size_t p = 0; p < now.state().size(); ++p) {
      const np::Tracker::Particle particle = now.state()[p];
      if (particle.status == ParticleStatus::ended) continue;
      const Vec2 x = now.particles().x0[p] + Vec2(double(real.u[p][0]), double(real.u[p][1]));
      sum += (particle.x - x).squaredNorm();
      ++alive;
    }
    curve.rms_px.push_back(std::sqrt(sum / double(std::max<std::size_t>(1, alive))) / m.pixel());
  });
  return curve;
}

void write_curves(const std::vector<Curve>& curves, const fs::path& out) {
  std::string table = "frame";
  plot::Chart chart{"frame", "RMS error of the displacement (px)", {}, true};
  for (const Curve& curve : curves) {
    table += "," + curve.scheme;
    plot::ChartCurve line{curve.scheme, {}, curve.rms_px};
    for (std::size_t k = 0; k < curve.rms_px.size(); ++k) line.x.push_back(double(k));
    chart.curves.push_back(std::move(line));
  }
  table += "\n";
  for (std::size_t k = 0; k < curves.front().rms_px.size(); ++k) {
    table += std::to_string(k);
    for (const Curve& curve : curves) table += "," + number(curve.rms_px[k], 6);
    table += "\n";
  }
  plot::write_chart(chart, out / "drift");
  plot::write_file(out / "drift.csv", table);
}

struct Criteria {
  VerifyResult& result;
  void at_most(const std::string& criterion, std::optional<double> limit, double reached) {
    if (limit) result.items.push_back({criterion, *limit, reached, std::isfinite(reached) && reached <= *limit});
  }
};

// All schemes of np.drift, the first without any and the last the one that is asked of.
void verify_drift(const Measurement& m, const RunSettings& settings, Progress& progress, Criteria& criteria) {
  const VerifyOptions& asked = m.c.verify;
  if (!asked.drift_px && !asked.drift_ratio) return;
  const Measured measured{plan_steps(m.frames()),
                          [&](const TrackStep& step) { return m.writer->pair(std::size_t(step.from)); },
                          [&](int k) { return m.source->read(k); }};
  std::vector<Curve> curves;
  for (const np::DriftScheme scheme : {np::DriftScheme::none, np::DriftScheme::leapfrog,
                                       np::DriftScheme::reference_update, np::DriftScheme::corrected})
    curves.push_back(drift_curve(m, measured, scheme, settings.threads, progress));
  write_curves(curves, settings.out);
  const double summed = curves.front().rms_px.back(), corrected = curves.back().rms_px.back();
  criteria.at_most("drift: final RMS error, corrected (px)", asked.drift_px, corrected);
  criteria.at_most("drift: final RMS error, corrected over summed increments", asked.drift_ratio, corrected / summed);
}

// Particles at the last frame against the truth, tracked through the images and through exact nodal increments.
void verify_particles(const Measurement& m, Criteria& criteria) {
  const VerifyOptions& asked = m.c.verify;
  if (!asked.displacement_rms_px && !asked.strain_error && !asked.nodal_error) return;
  const MotionFrame end = m.drawn->frame(m.drawn->times().size() - 1);
  const Truth truth = [&](const ParticleSet& set, std::size_t p, Vec2& x, Mat2& F) {
    if (m.affine) {
      x = m.motion.at(set.x0[p], m.last());
      F = m.motion.F(m.last());
    } else {  // the same seeds, in the same order
      x = set.x0[p] + Vec2(double(end.u[p][0]), double(end.u[p][1]));
      F = matrix(end.F[p]);
    }
  };
  const np::NpOptions own = m.c.np.value_or(np::NpOptions{});
  for (const int per_element : m.affine ? std::vector<int>{1, 4, 9} : std::vector<int>{own.per_element}) {
    Case variant = m.c;
    variant.np = own;
    variant.np->per_element = per_element;
    variant.np->reseed = false;  // the truth is known of the first frame's particles
    const std::string with = ", " + std::to_string(per_element) + " per element";
    np::Tracker images(*variant.np, seed_particles(variant, m.setting), 0);
    for (int k = 0; k < m.last(); ++k)
      images.step(m.writer->pair(std::size_t(k)), m.frames()[std::size_t(k) + 1].time);
    const Errors e = errors_of(images, truth);
    criteria.at_most("images: final displacement, RMS error (px)" + with, asked.displacement_rms_px,
                     e.displacement_rms / m.pixel());
    criteria.at_most("images: mean log strain, greatest error" + with, asked.strain_error, e.mean_strain);
    criteria.at_most("images: share of particles lost" + with, asked.lost_share, e.lost_share);
    if (!m.affine || !asked.nodal_error) continue;
    np::Tracker nodes(*variant.np, seed_particles(variant, m.setting), 0);
    for (int k = 0; k < m.last(); ++k) nodes.step(nodal_increments(m.motion, m.setting.grid, k), k + 1.0);
    const Errors exact = errors_of(nodes, truth);
    criteria.at_most("nodal increments: log strain, greatest error" + with, asked.nodal_error, exact.strain_max);
    criteria.at_most("nodal increments: displacement over spacing, greatest error" + with, asked.nodal_error,
                     exact.displacement_max / m.setting.grid.spacing.x());
  }
}

// How far what is at rest is off, anywhere in the image, once the camera's motion is removed.
void verify_camera(const Measurement& m, Criteria& criteria) {
  if (!m.c.verify.camera_px) return;
  const CameraMotion drawn = drawn_camera(m.c), &found = m.setting.camera_motion;
  double most = 0;
  for (std::size_t k = 0; k < drawn.at.size(); ++k)
    for (const double column : {0.0, m.setting.width - 1.0})
      for (const double row : {0.0, m.setting.height - 1.0}) {
        const Eigen::Vector3d p(column, row, 1), left = found.matrix(k).inverse() * drawn.matrix(k) * p;
        most = std::max(most, (left - p).head<2>().norm());
      }
  criteria.at_most("camera: motion left, greatest over frames and corners (px)", m.c.verify.camera_px, most);
}

}  // namespace

VerifyResult verify_case(const Case& c, const RunSettings& settings, Progress& progress) {
  VerifyResult result;
  result.name = c.name;
  const auto start = std::chrono::steady_clock::now();
  try {
    if (!c.synth) throw InputError("there is no [synth] table, so the truth is not known");
    const Measurement measurement = draw_and_measure(c, settings, progress);
    Criteria criteria{result};
    verify_camera(measurement, criteria);
    verify_drift(measurement, settings, progress, criteria);
    verify_particles(measurement, criteria);
    measurement.writer->set_frames(measurement.frames());
    measurement.writer->finish();
    if (result.items.empty()) throw InputError("there is no threshold in [verify]");
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& e) {
    result.failure = e.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.passed = result.failure.empty();
  for (const VerifyResult::Item& item : result.items) result.passed = result.passed && item.passed;
  return result;
}

}  // namespace pivnp::app

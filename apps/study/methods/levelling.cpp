#include "apps/study/methods/levelling.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/study/methods/tracking.hpp"
#include "apps/study/pipeline/measure.hpp"
#include "apps/study/pipeline/record_head.hpp"
#include "apps/study/pipeline/statistics.hpp"
#include "apps/study/synth/truth.hpp"
#include "compare/data/triangulation.hpp"
#include "compare/metrics/words.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

// Grey values, row by row.
struct Grey {
  int width = 0, height = 0;
  std::vector<float> value;

  float& at(int c, int r) { return value[std::size_t(r) * std::size_t(width) + std::size_t(c)]; }
  float at(int c, int r) const { return value[std::size_t(r) * std::size_t(width) + std::size_t(c)]; }
};

Grey grey_of(const ImageView& image) {
  Grey g{image.width, image.height, std::vector<float>(std::size_t(image.width) * std::size_t(image.height))};
  for (int r = 0; r < image.height; ++r)
    for (int c = 0; c < image.width; ++c)
      g.at(c, r) = image.depth == PixelDepth::u8    ? float(image.row<std::uint8_t>(r)[c])
                   : image.depth == PixelDepth::u16 ? float(image.row<std::uint16_t>(r)[c])
                                                    : image.row<float>(r)[c];
  return g;
}

struct Moments {
  double mean = 0, variance = 0;
};

Moments moments(const Grey& g, int c0, int c1, int r0, int r1) {
  double sum = 0, square = 0;
  const int left = std::max(0, c0), right = std::min(g.width - 1, c1), top = std::max(0, r0),
            bottom = std::min(g.height - 1, r1);
  const double n = double(right - left + 1) * double(bottom - top + 1);
  for (int r = top; r <= bottom; ++r)
    for (int c = left; c <= right; ++c) {
      sum += double(g.at(c, r));
      square += double(g.at(c, r)) * double(g.at(c, r));
    }
  return {sum / n, std::max(0.0, square / n - (sum / n) * (sum / n))};
}

Grey without_noise(const Grey& g, double noise) {
  Grey out = g;
  for (int r = 0; r < g.height; ++r)
    for (int c = 0; c < g.width; ++c) {
      const Moments m = moments(g, c - 1, c + 1, r - 1, r + 1);
      const double share = m.variance > 0 ? std::max(0.0, m.variance - noise) / std::max(m.variance, noise) : 0;
      out.at(c, r) = float(m.mean + share * (double(g.at(c, r)) - m.mean));
    }
  return out;
}

// Coefficients of the interpolating cubic B-spline, mirrored at the edges (Unser, Aldroubi & Eden 1993).
void prefilter(std::vector<double>& line) {
  const double z = std::sqrt(3.0) - 2;
  const std::size_t n = line.size();
  if (n < 2) return;
  double first = 0, power = 1;
  for (std::size_t k = 0; k < std::min<std::size_t>(n, 30); ++k, power *= z) first += power * line[k];
  for (double& v : line) v *= 6;
  line[0] = 6 * first;
  for (std::size_t k = 1; k < n; ++k) line[k] += z * line[k - 1];
  line[n - 1] = z / (z * z - 1) * (line[n - 1] + z * line[n - 2]);
  for (std::size_t k = n - 1; k-- > 0;) line[k] = z * (line[k + 1] - line[k]);
}

Grey coefficients(const Grey& g) {
  Grey out = g;
  std::vector<double> line;
  for (int r = 0; r < g.height; ++r) {
    line.assign(out.value.begin() + std::ptrdiff_t(r) * g.width, out.value.begin() + std::ptrdiff_t(r + 1) * g.width);
    prefilter(line);
    for (int c = 0; c < g.width; ++c) out.at(c, r) = float(line[std::size_t(c)]);
  }
  for (int c = 0; c < g.width; ++c) {
    line.clear();
    for (int r = 0; r < g.height; ++r) line.push_back(double(out.at(c, r)));
    prefilter(line);
    for (int r = 0; r < g.height; ++r) out.at(c, r) = float(line[std::size_t(r)]);
  }
  return out;
}

int mirrored(int k, int n) {
  if (n == 1) return 0;
  const int period = 2 * (n - 1);
  k = std::abs(k) % period;
  return k < n ? k : period - k;
}

double sample(const Grey& spline, const Vec2& px) {
  const double fc = std::floor(px.x()), fr = std::floor(px.y());
  const auto weights = [](double t) {
    const double s = 1 - t;
    return std::array<double, 4>{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                                 (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
  };
  const auto wc = weights(px.x() - fc), wr = weights(px.y() - fr);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += wr[std::size_t(j)] * wc[std::size_t(i)] *
             double(spline.at(mirrored(int(fc) - 1 + i, spline.width), mirrored(int(fr) - 1 + j, spline.height)));
  return sum;
}

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
      : has_rate_(has_rate), camera_(camera), motion_(motion), noise_(std::sqrt(noise)), seed_(seed),
        depth_(first.depth()), white_(first.white()) {
    for (const Frame& f : frames)
      if (f.time <= motion.times().back() * (1 + 1e-12)) frames_.push_back(f);
    const Grey raw = grey_of(first.view());
    still_ = without_noise(raw, noise);
    spline_ = coefficients(still_);
    const CarriedPoints start(motion, motion.times().front());
    material_.resize(still_.value.size());
    std::vector<float> background;
    for (int r = 0; r < still_.height; ++r)
      for (int c = 0; c < still_.width; ++c) {
        const std::size_t k = std::size_t(r) * std::size_t(still_.width) + std::size_t(c);
        material_[k] = start.origin(camera.to_world({double(c), double(r)})).has_value();
        if (!material_[k]) background.push_back(still_.value[k]);
      }
    std::vector<float>& of = background.empty() ? background = still_.value : background;
    std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(of.size() / 2), of.end());
    background_ = of[of.size() / 2];
  }

  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return has_rate_; }
  int width() const override { return still_.width; }
  int height() const override { return still_.height; }

  Image read(int index) override {
    const CarriedPoints now(motion_, frames_.at(std::size_t(index)).time);
    Image image(still_.width, still_.height, depth_, white_);
    for (int r = 0; r < still_.height; ++r)
      for (int c = 0; c < still_.width; ++c) {
        const std::size_t k = std::size_t(r) * std::size_t(still_.width) + std::size_t(c);
        double grey = material_[k] ? double(background_) : double(still_.value[k]);
        if (index == 0) {
          grey = double(still_.value[k]);
        } else if (const auto X = now.origin(camera_.to_world({double(c), double(r)}))) {
          const Vec2 from = camera_.to_pixel(*X);
          if (from.x() > -0.5 && from.y() > -0.5 && from.x() < still_.width - 0.5 && from.y() < still_.height - 0.5)
            grey = sample(spline_, from);
        }
        store(image, c, r, grey + noise_ * normal(std::uint64_t(index), k));
      }
    return image;
  }

 private:
  double normal(std::uint64_t frame, std::size_t pixel) const {
    const std::uint64_t stream = seed_ + 7919 * (frame + 1);
    const double a = std::max(uniform(stream, 2 * pixel), 1e-300), b = uniform(stream, 2 * pixel + 1);
    return std::sqrt(-2 * std::log(a)) * std::cos(2 * std::numbers::pi * b);
  }
  void store(Image& image, int c, int r, double grey) const {
    const double most = depth_ == PixelDepth::u8 ? 255 : depth_ == PixelDepth::u16 ? 65535 : double(white_);
    grey = std::clamp(grey, 0.0, most);
    if (depth_ == PixelDepth::u8) image.row<std::uint8_t>(r)[c] = std::uint8_t(std::lround(grey));
    else if (depth_ == PixelDepth::u16) image.row<std::uint16_t>(r)[c] = std::uint16_t(std::lround(grey));
    else image.row<float>(r)[c] = float(grey);
  }

  std::vector<Frame> frames_;
  bool has_rate_;
  image::Camera camera_;
  const MotionSource& motion_;
  double noise_;
  std::uint64_t seed_;
  PixelDepth depth_;
  float white_;
  Grey still_, spline_;
  std::vector<std::uint8_t> material_;  // at the first frame
  float background_ = 0;
};

}  // namespace

double noise_variance(const ImageView& first, const std::vector<Vec2>& nodes_px, int window_px,
                      const std::vector<VectorField>& pairs) {
  const Grey g = grey_of(first);
  const int half = window_px / 2;
  double best_score = -1, noise = 0;
  for (const VectorField& pair : pairs) {
    std::vector<double> scores, found;
    for (std::size_t n = 0; n < pair.score.size(); ++n) {
      if (pair.status[n] != VectorStatus::valid || !std::isfinite(pair.score[n])) continue;
      const int c = int(std::lround(nodes_px[n].x())), r = int(std::lround(nodes_px[n].y()));
      scores.push_back(double(pair.score[n]));
      found.push_back(std::max(0.0, 1 - double(pair.score[n])) *
                      moments(g, c - half, c + half, r - half, r + half).variance);
    }
    const double score = median(scores, std::nan(""));
    if (!(score > best_score)) continue;
    best_score = score;
    noise = median(found, std::nan(""));
  }
  return noise;
}

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
  measure(c, setting, *carried, levelled, settings.threads, progress);
  levelled.set_frames(carried->frames());
  track(c, setting, carried->frames(), carried.get(), {}, levelled, settings.threads, progress);
  levelled.pack();
  {
    const auto motion = levelled.motion("np");
    const Comparison like = compare::compare(measured, *motion, options, {}, progress, {}, {note, note});
    for (Metric m : like.metrics) {
      const auto known = compare::known_metric(m.name);
      if (!known || !known->facts->levelled) continue;
      m.name.insert(0, compare::levelled_prefix);
      m.definition += "; second: the simulation as it would have been measured (first frame carried by its motion, "
                      "same PIV and particles)";
      comparison.metrics.push_back(std::move(m));
    }
  }
  levelled.finish();
  comparison.remarks.push_back(
      "Levelled: the simulation was also measured from the first frame carried by its motion, with "
      "fresh noise of " +
      number(std::sqrt(noise), 3) + " grey values (standard deviation).");
}

}  // namespace pivnp::app

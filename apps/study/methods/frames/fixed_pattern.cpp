#include "apps/study/methods/frames/fixed_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "apps/study/pipeline/measure/measure.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/frames/filter.hpp"

namespace pivnp::app {

namespace {

constexpr double pattern_light_px = 32, window_px = 16;  // standard deviations of blurs
constexpr float at_rest = 0.85f;                 // correlation of frames as they stand

struct Plane {
  int width = 0, height = 0;
  float white = 255;
  std::vector<float> grey;

  Plane(int w, int h, float full) : width(w), height(h), white(full), grey(std::size_t(w) * std::size_t(h), 0.0f) {}
  Image image() const {
    Image out(width, height, PixelDepth::f32, white);
    std::copy(grey.begin(), grey.end(), out.row<float>(0));
    return out;
  }
};

void add(const ImageView& view, float share, Plane& sum) {
  for (int r = 0; r < view.height; ++r)
    for (int c = 0; c < view.width; ++c) {
      const float grey = view.depth == PixelDepth::u8    ? float(view.row<std::uint8_t>(r)[c])
                         : view.depth == PixelDepth::u16 ? float(view.row<std::uint16_t>(r)[c])
                                                         : view.row<float>(r)[c];
      sum.grey[std::size_t(r) * std::size_t(view.width) + std::size_t(c)] += share * grey;
    }
}

Plane blurred(const Plane& plane, double sigma) {
  Plane out(plane.width, plane.height, plane.white);
  const Image image = plane.image();
  const Image soft = image::blurred_image(image.view(), sigma);
  add(soft.view(), 1, out);
  return out;
}

Plane without_light(Plane plane) {
  const Plane light = blurred(plane, pattern_light_px);
  for (std::size_t k = 0; k < plane.grey.size(); ++k) plane.grey[k] -= light.grey[k];
  return plane;
}

Plane product(const Plane& a, const Plane& b) {
  Plane out(a.width, a.height, a.white);
  for (std::size_t k = 0; k < out.grey.size(); ++k) out.grey[k] = a.grey[k] * b.grey[k];
  return blurred(out, window_px);
}

// Median texture of some frames.
Plane median_of(image::FrameSource& source, const std::vector<int>& frames, std::size_t from, std::size_t to) {
  const Image median = image::background_of(int(to - from), [&](int k) { return source.read(frames[from + std::size_t(k)]); },
                                            image::Background::median);
  Plane out(median.width(), median.height(), median.white());
  add(median.view(), 1, out);
  return without_light(std::move(out));
}

}  // namespace

Image pattern_on_glass(image::FrameSource& source, int most) {
  const std::vector<int> frames = image::background_frames(int(source.frames().size()), most);
  const std::size_t count = frames.size();
  Plane pattern = median_of(source, frames, 0, count);
  const Plane first = median_of(source, frames, 0, 1), last = median_of(source, frames, count - 1, count);
  const Plane common = product(first, last), first_own = product(first, first), last_own = product(last, last);
  for (std::size_t k = 0; k < pattern.grey.size(); ++k)
    if (!(common.grey[k] < at_rest * std::sqrt(std::max(0.0f, first_own.grey[k] * last_own.grey[k])))) pattern.grey[k] = 0;
  return pattern.image();
}

namespace {

constexpr double grain_px = 6;  // a generous one
// The median of frames between which material has moved by less is, for a good part, that material.
constexpr double clear_of_itself_px = 8;
constexpr int least_frames = 8, pairs_looked_at = 6;

// What a node's material has moved over the whole sequence, px, from `read` of its pairs; no number where less than half of them are valid.
std::vector<double> path_lengths(const Setting& setting, std::size_t steps, std::size_t read, const std::function<VectorField(std::size_t)>& pair) {
  std::vector<Vec2> path(setting.grid.node_count(), Vec2(0, 0));
  std::vector<std::size_t> valid(path.size(), 0);
  for (std::size_t n = 0; n < read; ++n) {
    const VectorField field = pair(n * steps / read);
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (field.status[k] != VectorStatus::valid) continue;
      path[k] += Vec2(double(field.displacement[k][0]), double(field.displacement[k][1]));
      ++valid[k];
    }
  }
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  std::vector<double> out(path.size(), NAN);
  for (std::size_t k = 0; k < path.size(); ++k)
    if (valid[k] >= (read + 1) / 2) out[k] = path[k].norm() / pixel * double(steps) / double(read);
  return out;
}

// Up to four pairs of frames, as far apart as the sequence is long, where material has moved on.
StillPicture far_apart(const Setting& setting, image::FrameSource& source, const std::vector<double>& lengths) {
  constexpr int most_looks = 4;
  const int steps = int(source.frames().size()) - 1;
  StillPicture out;
  double correlation = 0, error = 0;
  int looks = 0;
  for (int late = 0; late < most_looks && 3 * late < steps; ++late) {
    const double share = double(steps - late) / steps;
    const StillPicture look = still_picture(prepared(setting, source.read(late % 2 == 0 ? 0 : late)),
                                            prepared(setting, source.read(late % 2 == 0 ? steps - late : steps)),
                                            amid_motion(setting, 0, lengths, grain_px / share));
    if (look.windows < 16) continue;
    correlation += look.correlation, error += look.error, out.windows += look.windows, ++looks;
  }
  // Looks share frames and pattern: their mean is no surer than one of them.
  if (looks > 0) out.correlation = correlation / looks, out.error = error / looks;
  return out;
}

// 1 where material about has moved on by `clear_of_itself_px`, else 0, without steps that would be texture. A node without
// vectors is as those about it are: the pattern may be what hides them.
Plane clear_of_material(const Setting& setting, const Plane& like, const std::vector<double>& lengths) {
  Plane known(like.width, like.height, like.white), clear = known;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    if (!std::isfinite(lengths[k])) continue;
    const Vec2 place = setting.camera.to_pixel(setting.grid.position(int(k) % setting.grid.nx, int(k) / setting.grid.nx));
    const long c = std::lround(place.x()), r = std::lround(place.y());
    if (c < 0 || r < 0 || c >= like.width || r >= like.height) continue;
    const std::size_t at = std::size_t(r) * std::size_t(like.width) + std::size_t(c);
    known.grey[at] = 1;
    clear.grey[at] = lengths[k] >= clear_of_itself_px ? 1.0f : 0.0f;
  }
  const double reach = std::max(window_px, 2 * node_spacing_px(setting));
  known = blurred(known, reach), clear = blurred(clear, reach);
  for (std::size_t k = 0; k < clear.grey.size(); ++k)
    clear.grey[k] = known.grey[k] > 0 ? std::clamp(4 * clear.grey[k] / known.grey[k] - 3, 0.0f, 1.0f) : 0.0f;
  return clear;
}

}  // namespace

StillPicture fixed_texture(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair) {
  constexpr std::size_t most_pairs = 16;  // whose vectors stand for all
  const std::size_t steps = source.frames().size() - 1;
  if (!setting.cameras.empty() || steps < 2) return {};
  return far_apart(setting, source, path_lengths(setting, steps, std::min(most_pairs, steps), pair));
}

Image pattern_over_motion(const Case& c, const Setting& setting, image::FrameSource& source, int most, int threads, Progress& progress) {
  Image all = pattern_on_glass(source, most);
  const int frames = int(source.frames().size());
  if (!setting.cameras.empty() || frames < least_frames) return all;
  Plane pattern(all.width(), all.height(), all.white());
  add(all.view(), 1, pattern);
  Case quick = c;
  quick.piv = piv::PivOptions{};
  quick.piv->method = "fast";
  // Without the pattern, which would hold paths back.
  image::FilterOptions options;
  options.background = image::Background::pattern;
  Setting freed = setting;
  freed.filter = std::make_shared<const image::FrameFilter>(options, std::move(all));
  const std::vector<double> lengths = path_lengths(freed, std::size_t(frames - 1), pairs_looked_at, [&](std::size_t k) {
    if (progress.stop_requested()) throw Interrupted();
    return measure_pair(quick, freed, source, {int(k), int(k) + 1}, threads);
  });
  const Plane clear = clear_of_material(setting, pattern, lengths);
  for (std::size_t k = 0; k < pattern.grey.size(); ++k) pattern.grey[k] *= clear.grey[k];
  return pattern.image();
}

std::vector<std::string> pattern_remarks(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair) {
  const StillPicture seen = fixed_texture(setting, source, pair);
  if (!seen.seen()) return {};
  return {"Texture that stands still lies over material that moves, as dirt, scratches or a reflection on the glass do: amid material that has moved on by "
          "more than 6 px, frames correlate as they stand by " + number(seen.correlation, 2) + " (+- " + number(seen.error, 1) +
          "). It draws vectors towards zero, in every pair alike, which no closure shows. preprocess.background = \"pattern\" takes it out."};
}

}  // namespace pivnp::app

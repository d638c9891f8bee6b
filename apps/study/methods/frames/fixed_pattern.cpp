#include "apps/study/methods/frames/fixed_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

StillPicture fixed_texture(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair) {
  constexpr double grain = 6;             // px, a generous one
  constexpr std::size_t most_pairs = 16;  // whose vectors stand for all
  constexpr int most_looks = 4;
  const int frames = int(source.frames().size()), steps = frames - 1;
  StillPicture out;
  if (!setting.cameras.empty() || steps < 2) return out;
  const std::size_t read = std::min<std::size_t>(most_pairs, std::size_t(steps));
  std::vector<Vec2> path(setting.grid.node_count(), Vec2(0, 0));
  std::vector<std::size_t> valid(path.size(), 0);
  for (std::size_t n = 0; n < read; ++n) {
    const VectorField field = pair(n * std::size_t(steps) / read);
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (field.status[k] != VectorStatus::valid) continue;
      path[k] += Vec2(double(field.displacement[k][0]), double(field.displacement[k][1]));
      ++valid[k];
    }
  }
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  double correlation = 0, error = 0;
  int looks = 0;
  for (int late = 0; late < most_looks && 3 * late < steps; ++late) {
    const double share = double(steps - late) / steps;
    std::vector<Vec2> moved;
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (valid[k] < (read + 1) / 2) continue;
      if (share * path[k].norm() * double(steps) / double(read) < grain * pixel) continue;
      moved.push_back(setting.camera.to_pixel(setting.grid.position(int(k) % setting.grid.nx, int(k) / setting.grid.nx)));
    }
    const StillPicture look = still_picture(prepared(setting, source.read(late % 2 == 0 ? 0 : late)),
                                            prepared(setting, source.read(late % 2 == 0 ? steps - late : steps)), moved);
    if (look.windows < 16) continue;
    correlation += look.correlation, error += look.error, out.windows += look.windows, ++looks;
  }
  // Looks share frames and pattern: their mean is no surer than one of them.
  if (looks > 0) out.correlation = correlation / looks, out.error = error / looks;
  return out;
}

std::vector<std::string> pattern_remarks(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair) {
  const StillPicture seen = fixed_texture(setting, source, pair);
  if (!seen.seen()) return {};
  return {"Texture that stands still lies over material that moves, as dirt, scratches or a reflection on the glass do: where the material has moved on by "
          "more than 6 px, frames correlate as they stand by " + number(seen.correlation, 2) + " (+- " + number(seen.error, 1) +
          "). It draws vectors towards zero, in every pair alike, which no closure shows. preprocess.background = \"pattern\" takes it out."};
}

}  // namespace pivnp::app

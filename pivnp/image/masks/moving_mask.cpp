#include "pivnp/image/masks/moving_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/image/files/frame_files.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "pivnp/image/masks/raster.hpp"

namespace pivnp::image {

namespace {

namespace fs = std::filesystem;

std::vector<Vec2> outline_of(const MaskOptions& o, const Camera& camera, const std::string& what) {
  std::vector<Vec2> out;
  if (!o.polygon_px.empty()) out = Polygon(positions_of(o.polygon_px), what + ".polygon_px").vertices();
  for (const Vec2& x : positions_of(o.polygon_m)) out.push_back(camera.to_pixel(x));
  if (o.circle_px.size() == 3) {
    constexpr int sides = 90;
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * std::numbers::pi * k / sides;
      out.emplace_back(o.circle_px[0] + o.circle_px[2] * std::cos(a), o.circle_px[1] + o.circle_px[2] * std::sin(a));
    }
  }
  for (const Vec2& p : out)
    if (!p.allFinite()) throw InputError(what + ": a vertex lies beyond what the camera sees");
  return out;
}

Vec2 middle_of(const std::vector<Vec2>& outline) {
  Vec2 lower = outline.front(), upper = lower;
  for (const Vec2& p : outline) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  return (lower + upper) / 2;
}

// Rows "frame,right_px,down_px,turn_deg" under that head, by increasing frame.
std::vector<std::pair<double, CameraPlace>> told_motion(const fs::path& file, const std::string& what) {
  std::ifstream in = open_regular_file(file, what + ": '" + file.string() + "'");
  std::string line;
  std::getline(in, line);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  const std::string head = "frame,right_px,down_px,turn_deg";
  if (line != head) throw InputError(what + ": '" + file.string() + "' begins with '" + line.substr(0, 60) + "', expected '" + head + "'");
  std::vector<std::pair<double, CameraPlace>> out;
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r") continue;
    double frame = 0, right = 0, down = 0, turn = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &frame, &right, &down, &turn) != 4 || !std::isfinite(frame + right + down + turn))
      throw InputError(what + ": '" + file.string() + "', line " + std::to_string(number) + ": found '" + line.substr(0, 60) +
                       "', expected four numbers");
    if (!out.empty() && !(frame > out.back().first))
      throw InputError(what + ": '" + file.string() + "', line " + std::to_string(number) + ": expected frames in increasing order");
    CameraPlace place;
    place.shift = {right, down};
    place.turn = radians(turn);
    out.emplace_back(frame, place);
  }
  if (out.empty()) throw InputError(what + ": '" + file.string() + "' holds no row");
  return out;
}

std::vector<fs::path> mask_images(const fs::path& base, const std::string& pattern, const std::string& what) {
  const fs::path path = base / pattern;
  const auto numbered = NumberedName::parse(path.filename().string(), what);
  const FrameFiles files = fs::is_directory(path) ? files_in_folder(path, what)
                           : numbered             ? files_of_pattern(path.parent_path(), *numbered, what)
                                                  : files_of_glob(base, pattern, what);
  std::vector<fs::path> out;
  for (const auto& file : files.files) out.push_back(file.path);
  return out;
}

void require_one_shape(const MaskOptions& o, const std::string& what) {
  const int shapes = int(!o.polygon_px.empty()) + int(!o.polygon_m.empty()) + int(!o.circle_px.empty()) + int(!o.image.empty()) +
                     int(!o.images.empty()) + int(o.glare.has_value()) + int(o.air != AirKind::none);
  if (shapes != 1)
    throw InputError(what + ": found " + std::to_string(shapes) + " shapes, expected one of polygon_px, polygon_m, circle_px, image, images, glare, air");
  const bool moves = o.follow || !o.motion.empty();
  if (moves && (!o.image.empty() || !o.images.empty() || o.glare || o.air != AirKind::none)) throw InputError(what + ": a motion is given, but no outline that could move; expected polygon_px, polygon_m or circle_px");
  if (o.follow_by != FollowBy::texture && !o.follow) throw InputError(what + ".follow_by: given without follow = true");
  if (o.follow && !o.motion.empty()) throw InputError(what + ".motion: given together with follow, expected one of them");
}

template <class T>
void mark_bright(const ImageView& image, int row, double least, std::vector<std::uint8_t>& covered) {
  const T* grey = image.row<T>(row);
  for (int c = 0; c < image.width; ++c) covered[std::size_t(c)] = double(grey[c]) >= least;
}

bool goes_with_camera(const MaskOptions& o) { return !o.moves() && !o.polygon_m.empty(); }

std::vector<Vec2> finer(const std::vector<Vec2>& vertices, int pieces) {
  std::vector<Vec2> out;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    for (int n = 0; n < pieces; ++n) out.push_back(vertices[k] + n / double(pieces) * (vertices[(k + 1) % vertices.size()] - vertices[k]));
  return out;
}

}  // namespace

MovingMasks::MovingMasks(const std::vector<std::pair<std::string, MaskOptions>>& named, const Camera& camera, int width, int height,
                         const fs::path& base, bool camera_moves)
    : width_(width), height_(height) {
  for (const auto& [name, options] : named) {
    const std::string what = "mask." + name;
    const bool in_world = camera_moves && goes_with_camera(options);
    if (!options.moves() && !in_world) continue;
    require_one_shape(options, what);
    Item item{name, options, outline_of(options, camera, what), {}, {}, {}, {}, {}};
    if (in_world) item.world = finer(positions_of(options.polygon_m), camera.lens().straight() ? 1 : 32);
    if (!options.images.empty()) item.images = mask_images(base, options.images, what + ".images");
    if (!options.motion.empty()) item.told = told_motion(base / options.motion, what + ".motion");
    items_.push_back(std::move(item));
  }
}

void MovingMasks::require_frames(std::size_t frames) const {
  for (const Item& item : items_)
    if (!item.images.empty() && item.images.size() != frames)
      throw InputError("mask." + item.name + ".images: found " + std::to_string(item.images.size()) + " images, expected one for each of the " +
                       std::to_string(frames) + " frames");
}

std::vector<MovingMasks::Followed> MovingMasks::to_follow() const {
  std::vector<Followed> out;
  for (std::size_t k = 0; k < items_.size(); ++k)
    if (items_[k].options.follow) out.push_back({k, items_[k].name, items_[k].outline, items_[k].options.follow_by});
  return out;
}

bool MovingMasks::any_in_world() const {
  return std::any_of(items_.begin(), items_.end(), [](const Item& item) { return !item.world.empty(); });
}

bool MovingMasks::wants_background() const {
  return std::any_of(items_.begin(), items_.end(), [](const Item& item) { return item.options.air == AirKind::still && item.background.empty(); });
}

void MovingMasks::set_background(const ImageView& first, const ImageView& second, const std::vector<std::uint8_t>& material) {
  for (Item& item : items_)
    if (item.options.air == AirKind::still) item.background = StillBackground(first, second, material);
}

// As one place.
CameraMotion MovingMasks::at(const Item& item, int frame) const {
  if (!item.motion.empty()) return {item.motion.centre, {item.motion.at.at(std::size_t(frame))}};
  CameraMotion out{middle_of(item.outline), {CameraPlace{}}};
  if (item.told.empty()) return out;
  const auto after = std::find_if(item.told.begin(), item.told.end(), [&](const auto& row) { return row.first >= frame; });
  if (after == item.told.end()) out.at[0] = item.told.back().second;
  else if (after == item.told.begin()) out.at[0] = after->second;
  else {
    const auto &a = *(after - 1), &b = *after;
    const double t = (frame - a.first) / (b.first - a.first);
    out.at[0].shift = (1 - t) * a.second.shift + t * b.second.shift;
    out.at[0].turn = (1 - t) * a.second.turn + t * b.second.turn;
  }
  return out;
}

std::vector<Vec2> MovingMasks::outline_at(const Item& item, int frame) const {
  if (!item.world.empty() && !cameras_.empty()) {
    std::vector<Vec2> out;
    for (const Vec2& x : item.world) out.push_back(cameras_.at(std::size_t(frame)).to_pixel(x));
    return out;
  }
  std::vector<Vec2> out = item.outline;
  if (out.empty()) return out;
  const Mat3 moved = at(item, frame).matrix(0);
  for (Vec2& p : out) p = (moved * Eigen::Vector3d(p.x(), p.y(), 1)).head<2>();
  return out;
}

std::vector<std::vector<Vec2>> MovingMasks::outlines(int frame) const {
  std::vector<std::vector<Vec2>> out;
  for (const Item& item : items_) out.push_back(outline_at(item, frame));
  return out;
}

void MovingMasks::apply(int frame, const ImageView& image, Mask& mask) const {
  if (items_.empty()) return;
  if (mask.empty()) mask = Mask(width_, height_);
  const auto columns = std::size_t(width_);
  std::vector<std::uint8_t> covered(columns * std::size_t(height_)), line(columns);
  for (const Item& item : items_) {
    std::fill(covered.begin(), covered.end(), std::uint8_t{0});
    const std::vector<Vec2> outline = outline_at(item, frame);
    Image picture;
    if (!item.images.empty()) {
      const std::string what = "mask." + item.name + ".images";
      picture = read_image_file(item.images.at(std::size_t(frame)), what);
      if (picture.width() != width_ || picture.height() != height_)
        throw InputError(what + ": '" + item.images[std::size_t(frame)].string() + "' is " + std::to_string(picture.width()) + "x" +
                         std::to_string(picture.height()) + ", but the frames are " + std::to_string(width_) + "x" + std::to_string(height_));
    }
    const ImageView shown = picture.empty() ? image : picture.view();
    // Zero in a mask image, or at least so bright in the frame.
    const double least = item.options.glare ? *item.options.glare * double(image.white) : 0.5 / 255 * double(shown.white);
    std::vector<Run> runs;
    const AirKind air = item.options.air;
    if (air == AirKind::texture) covered = air_without_texture(image);
    if (air == AirKind::still) covered = item.background.find(image);
    for (int r = 0; r < height_ && air == AirKind::none; ++r) {
      if (!outline.empty()) {
        std::fill(line.begin(), line.end(), std::uint8_t{0});
        polygon_runs(outline, r, width_, runs);
        for (const Run& run : runs) std::fill(line.begin() + run.first, line.begin() + run.last + 1, std::uint8_t{1});
      } else {
        switch (shown.depth) {
          case PixelDepth::u8: mark_bright<std::uint8_t>(shown, r, least, line); break;
          case PixelDepth::u16: mark_bright<std::uint16_t>(shown, r, item.images.empty() ? least : 1, line); break;
          case PixelDepth::f32: mark_bright<float>(shown, r, item.images.empty() ? least : 1e-9, line); break;
        }
        if (!item.images.empty())
          for (auto& v : line) v = !v;
      }
      std::copy(line.begin(), line.end(), covered.begin() + std::ptrdiff_t(std::size_t(r) * columns));
    }
    grow(covered, width_, height_, item.options.grow_px);
    const std::uint8_t keep = item.options.invert ? 1 : 0;
    for (int r = 0; r < height_; ++r) {
      std::uint8_t* usable = mask.row(r);
      for (std::size_t c = 0; c < columns; ++c) usable[c] = std::uint8_t(usable[c] & (covered[std::size_t(r) * columns + c] == keep));
    }
  }
}

std::vector<fs::path> MovingMasks::files() const {
  std::vector<fs::path> out;
  for (const Item& item : items_) out.insert(out.end(), item.images.begin(), item.images.end());
  return out;
}

std::vector<std::pair<std::string, MaskOptions>> fixed_in_image(const std::vector<std::pair<std::string, MaskOptions>>& named) {
  std::vector<std::pair<std::string, MaskOptions>> out;
  std::copy_if(named.begin(), named.end(), std::back_inserter(out), [](const auto& mask) { return !goes_with_camera(mask.second); });
  return out;
}

Mask both(const Mask& a, const Mask& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  Mask out = a;
  const MaskView other = b.view();
  for (int r = 0; r < other.height; ++r)
    for (int c = 0; c < other.width; ++c) out.row(r)[c] = std::uint8_t(out.row(r)[c] & std::uint8_t(other.usable(c, r)));
  return out;
}

}  // namespace pivnp::image

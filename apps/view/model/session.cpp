#include "apps/view/model/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "apps/case/edit.hpp"
#include "apps/case/init.hpp"
#include "apps/case/values.hpp"
#include "apps/plot/files.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/records/record_check.hpp"

namespace pivnp::view {

namespace fs = std::filesystem;

namespace {

std::string frames_key(const app::Case& c) {
  if (!c.frames) return "";
  const image::FrameOptions& f = *c.frames;
  std::string key = f.path + "|" + std::to_string(f.first) + "|" + std::to_string(f.last.value_or(-1)) + "|" +
                    std::to_string(f.stride) + "|" + std::string(name_of(f.times)) + "|" + std::string(name_of(f.pairs));
  return key + "|" + app::toml_text(f.rate_hz);
}

// Frames that a case names; what cannot be opened is told in the window, and the case is open all the same.
void open_frames_of(const app::Case& c, const fs::path& folder, Opened& opened) {
  if (!c.frames || c.frames->path.empty()) {
    if (c.synth) opened.complaint = "The case draws its frames when it is run.";
    return;
  }
  try {
    opened.frames = std::make_shared<SharedFrames>(image::open_frames(*c.frames, folder));
  } catch (const InputError& error) {
    opened.complaint = error.what();
  }
}

app::Case readable(const std::string& text, const std::string& name, const fs::path& folder) {
  try {
    return app::parse_recorded_case(text, name, folder);
  } catch (const InputError&) {
    return {};
  }
}

// "FILE:3: fault; line 7: fault; and 2 more" by line.
std::vector<Fault> split_faults(const std::string& message, const std::string& label) {
  std::vector<Fault> out;
  std::string rest = message;
  while (!rest.empty()) {
    std::size_t cut = 0;
    do {
      cut = rest.find("; line ", cut + 1);
    } while (cut != std::string::npos && std::atoi(rest.c_str() + cut + 7) == 0);
    Fault fault{0, rest.substr(0, cut)};
    const std::string place = out.empty() ? label + ":" : "line ";
    if (fault.text.starts_with(place)) fault.line = std::atoi(fault.text.c_str() + place.size());
    out.push_back(std::move(fault));
    rest = cut == std::string::npos ? "" : rest.substr(cut + 2);
  }
  return out;
}

const char* section_of(ShapeKind kind) {
  return kind == ShapeKind::region ? "region" : kind == ShapeKind::mask ? "mask" : "boundary";
}

const char* first_name(ShapeKind kind) {
  return kind == ShapeKind::region ? "soil" : kind == ShapeKind::mask ? "mask" : "wall";
}

}  // namespace

Opened open_path(const fs::path& path) {
  Opened opened;
  if (io::is_record(path)) {
    opened.record = fs::is_directory(path) ? path / "record.h5" : path;
    return opened;
  }
  const bool folder = fs::is_directory(path);
  if (path.extension() == ".toml" || (folder && fs::exists(path / "case.toml"))) {
    opened.file = folder ? path / "case.toml" : path;
    opened.text = text_of_file(opened.file);
    opened.folder = opened.file.has_parent_path() ? opened.file.parent_path() : fs::path(".");
    open_frames_of(readable(opened.text, opened.file.string(), opened.folder), opened.folder, opened);
    return opened;
  }
  const fs::path whole = fs::absolute(path).lexically_normal();
  opened.frames = std::make_shared<SharedFrames>(image::open_frames({.path = whole.string()}, fs::current_path()));
  opened.folder = folder ? whole : whole.parent_path();
  app::FrameFacts facts{opened.frames->width(), opened.frames->height(), opened.frames->frames().size(), {}};
  if (opened.frames->has_rate() && facts.count > 1) {
    const double rate = double(facts.count - 1) / (opened.frames->frames().back().time - opened.frames->frames().front().time);
    if (std::isfinite(rate) && rate > 0) facts.rate_hz = std::round(rate * 1000) / 1000;
  }
  app::InitOptions options;
  options.frames = whole.string();
  options.folder = opened.folder;
  // Its outline is a guess to be edited; here outlines are drawn.
  opened.text = app::without_key(app::initial_case(options, facts), "case", {"region", "soil"});
  return opened;
}

void Session::take(Opened opened) {
  text_ = std::move(opened.text);
  file_ = std::move(opened.file);
  folder_ = std::move(opened.folder);
  frames_ = std::move(opened.frames);
  complaint_ = std::move(opened.complaint);
  saved_ = file_.empty() ? std::string() : text_;
  steps_ = {text_};
  at_ = 0;
  typing_ = false;
  seen_ = {};
  read_text();
  frames_opened_ = frames_key(seen_);
}

void Session::read_text() {
  faults_.clear();
  try {
    app::Case c = app::parse_case(text_, label(), folder_);
    c.file = file_;
    if (c.name.empty()) c.name = file_.empty() ? "case" : app::short_name(c);
    case_ = std::move(c);
  } catch (const InputError& error) {
    case_.reset();
    faults_ = split_faults(error.what(), label());
  }
  try {
    seen_ = app::parse_recorded_case(text_, label(), folder_);
  } catch (const InputError&) {  // no TOML: what was seen before stays, and the faults say so
  }
  const int width = frames_ ? frames_->width() : 0, height = frames_ ? frames_->height() : 0;
  camera_ = image::Camera();
  try {
    if (frames_) camera_ = image::make_camera(seen_.camera, width, height);
  } catch (const InputError& error) {
    if (faults_.empty()) faults_.push_back({0, error.what()});
  }
  shapes_ = shapes_of(seen_, camera_);
}

void Session::change(std::string text, bool typing) {
  if (text == text_) return;
  if (!(typing && typing_)) {
    steps_.resize(at_ + 1);
    steps_.emplace_back();
    ++at_;
  }
  steps_.resize(at_ + 1);
  typing_ = typing;
  text_ = steps_[at_] = std::move(text);
  read_text();
}

void Session::set_text(const std::string& text, bool typing) { change(text, typing); }

void Session::undo() {
  if (!can_undo()) return;
  text_ = steps_[--at_];
  typing_ = false;
  read_text();
}

void Session::redo() {
  if (!can_redo()) return;
  text_ = steps_[++at_];
  typing_ = false;
  read_text();
}

void Session::set_key(const app::KeyPath& key, const std::string& toml) {
  change(toml.empty() ? app::without_key(text_, label(), key) : app::with_key(text_, label(), key, toml));
}

std::string Session::free_name(const std::string& section, const std::string& wanted) const {
  const auto taken = [&](const std::string& name) {
    return std::any_of(shapes_.begin(), shapes_.end(), [&](const Shape& s) { return s.key[0] == section && s.name() == name; }) ||
           (section == "mask" && std::any_of(seen_.masks.begin(), seen_.masks.end(), [&](const auto& m) { return m.first == name; }));
  };
  std::string name = wanted;
  for (int k = 2; taken(name); ++k) name = wanted + "_" + std::to_string(k);
  return name;
}

std::string Session::add_shape(ShapeKind kind, const std::vector<Vec2>& points_px, const std::string& name) {
  Shape shape{kind, {}, kind == ShapeKind::wall, kind != ShapeKind::wall || points_px.size() > 2, points_px, false};
  if (kind == ShapeKind::still_zone) {
    shape.key = {"np", "still_zone_px"};
    require_outline(shape);
    change(app::with_key(app::without_key(text_, label(), {"np", "still_zone_m"}), label(), shape.key, toml_of(shape, camera_)));
    return shape.name();
  }
  const std::string section = section_of(kind), called = free_name(section, name.empty() ? first_name(kind) : name);
  shape.key = {section, called, !shape.closed ? "line_m" : shape.world ? "polygon_m" : "polygon_px"};
  require_outline(shape);
  std::string text = app::with_key(text_, label(), shape.key, toml_of(shape, camera_));
  if (kind == ShapeKind::wall) text = app::with_key(text, label(), {section, called, "type"}, "\"fixed\"");
  change(std::move(text));
  return called;
}

void Session::set_points(std::size_t index, const std::vector<Vec2>& points_px) {
  Shape shape = shapes_.at(index);
  if (shape.circle) throw InputError("mask." + shape.name() + ".circle_px: is a circle, expected its numbers to be edited in the text");
  shape.points = points_px;
  require_outline(shape);
  change(app::with_key(text_, label(), shape.key, toml_of(shape, camera_)));
}

void Session::remove_shape(std::size_t index) {
  app::KeyPath key = shapes_.at(index).key;
  if (key.size() == 3) key.pop_back();  // its section
  change(app::without_key(text_, label(), key));
}

void Session::copy_shape(std::size_t index, ShapeKind to) {
  const Shape shape = shapes_.at(index);
  if (!shape.closed && to != ShapeKind::wall)
    throw InputError(shape.key[0] + "." + shape.name() + ": found a line, expected an outline to make a " + std::string(name_of(to)) + " of");
  add_shape(to, shape.points, to == shape.kind ? shape.name() : std::string());
}

void Session::rename_shape(std::size_t index, const std::string& name) {
  const Shape& shape = shapes_.at(index);
  if (shape.key.size() != 3) throw InputError("np." + shape.key[1] + ": has no name of its own");
  if (name.empty()) throw InputError("[" + shape.key[0] + ".\"\"]: the name is empty");
  if (name != shape.name()) change(app::with_name(text_, label(), {shape.key[0], shape.key[1]}, name));
}

void Session::set_scale(const Vec2& one_px, const Vec2& other_px, double length) {
  const double apart = (other_px - one_px).norm();
  if (!(apart > 0) || !(length > 0) || !std::isfinite(length))
    throw InputError("camera.metres_per_pixel: found a length of " + app::toml_text(length) + " over " + app::toml_text(apart) +
                     " px, expected both to be more than 0");
  std::string text = text_;
  if (!seen_.camera.points_m.empty()) {
    const double factor = length / (camera_.to_world(other_px) - camera_.to_world(one_px)).norm();
    Points points = seen_.camera.points_m;
    for (Pair& p : points) p = {p[0] * factor, p[1] * factor};
    change(app::with_key(text, label(), {"camera", "points_m"}, app::toml_text(points)));
    return;
  }
  const double scale = length / apart;
  text = app::with_key(text, label(), {"camera", "metres_per_pixel"}, app::toml_text(scale));
  if (!seen_.camera.metres_per_pixel && frames_) {
    image::CameraOptions options = seen_.camera;
    options.metres_per_pixel = scale;
    const image::Camera scaled = image::make_camera(options, frames_->width(), frames_->height());
    for (const Shape& shape : shapes_)
      if (shape.world) text = app::with_key(text, label(), shape.key, toml_of(shape, scaled));
  }
  change(std::move(text));
}

void Session::set_origin(const Vec2& px) {
  if (seen_.camera.points_m.empty()) {
    const Pair place{std::round(px.x() * 100) / 100, std::round(px.y() * 100) / 100};
    change(app::with_key(text_, label(), {"camera", "origin_px"}, app::toml_text(place)));
    return;
  }
  const Vec2 zero = camera_.to_world(px);
  Points points = seen_.camera.points_m;
  for (Pair& p : points) p = {p[0] - zero.x(), p[1] - zero.y()};
  change(app::with_key(text_, label(), {"camera", "points_m"}, app::toml_text(points)));
}

void Session::set_horizontal(const Vec2& from_px, const Vec2& to_px) {
  if (!frames_) throw InputError("camera.points_px: there are no frames to see a direction in");
  if (!seen_.camera.metres_per_pixel && seen_.camera.points_m.empty())
    throw InputError("camera.metres_per_pixel: missing, expected a scale before the axes are turned");
  if (!((to_px - from_px).norm() > 0)) throw InputError("camera.points_px: found one place twice, expected two");
  // The four corners of the image stand for the camera: turned about the world's (0, 0).
  const Vec2 along = camera_.to_world(to_px) - camera_.to_world(from_px);
  const double angle = -std::atan2(along.y(), along.x());
  Mat2 turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  const double right = frames_->width() - 1, low = frames_->height() - 1;
  Points pixels, world;
  for (const Vec2& corner : {Vec2(0, low), Vec2(right, low), Vec2(right, 0), Vec2(0, 0)}) {
    const Vec2 x = turn * camera_.to_world(corner);
    pixels.push_back({corner.x(), corner.y()});
    world.push_back({x.x(), x.y()});
  }
  std::string text = app::without_key(app::without_key(text_, label(), {"camera", "metres_per_pixel"}), label(), {"camera", "origin_px"});
  text = app::with_key(text, label(), {"camera", "points_px"}, app::toml_text(pixels));
  change(app::with_key(text, label(), {"camera", "points_m"}, app::toml_text(world)));
}

bool Session::frames_stale() const { return frames_key(seen_) != frames_opened_; }

std::function<Opened()> Session::reopening() const {
  return [c = seen_, folder = folder_] {
    Opened opened;
    open_frames_of(c, folder, opened);
    return opened;
  };
}

void Session::take_frames(Opened opened) {
  frames_ = std::move(opened.frames);
  complaint_ = std::move(opened.complaint);
  frames_opened_ = frames_key(seen_);
  read_text();
}

void Session::save(const fs::path& file) {
  const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  std::string text = text_;
  if (seen_.frames && !seen_.frames->path.empty()) {
    const fs::path frames = fs::path(seen_.frames->path).is_absolute() ? fs::path(seen_.frames->path) : fs::absolute(folder_ / seen_.frames->path);
    const fs::path near = frames.lexically_normal().lexically_proximate(folder);
    const std::string path = near.string().starts_with("..") ? frames.lexically_normal().string() : near.string();
    if (fs::absolute(folder_).lexically_normal() != folder || (fs::path(seen_.frames->path).is_absolute() && path == near.string()))
      text = app::with_key(text, label(), {"frames", "path"}, app::toml_text(path));
  }
  plot::write_file(file, text);
  file_ = file;
  folder_ = folder;
  change(text);
  saved_ = text_;
  read_text();
  frames_opened_ = frames_key(seen_);
}

}  // namespace pivnp::view

#include "apps/study/methods/frames/camera_motion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/camera/similarity.hpp"
#include "pivnp/image/masks/outline_follower.hpp"
#include "pivnp/piv/window/subset.hpp"
#include "pivnp/piv/window/subset_search.hpp"

namespace pivnp::app {

namespace {

using image::RestSource;

constexpr double least_rest_score = 0.6;
constexpr std::size_t most_points = 400, most_searched = 12;
constexpr double tolerance_px = 0.5;     // farther from the shared motion a subset does not agree
constexpr double usual_share = 0.8;      // of the subsets of a zone at rest agree at least
constexpr double loud_residual_px = 0.1;

std::vector<Polygon> zones(const Case& c, const Setting& setting) {
  const image::CameraMotionOptions& o = c.camera_motion;
  const np::NpOptions np = c.np.value_or(np::NpOptions{});
  std::vector<Vec2> pixels, world;
  const bool own = !o.zone_px.empty() || !o.zone_m.empty();
  for (const Vec2& p : positions_of(own ? o.zone_px : np.still_zone_px)) pixels.push_back(setting.camera.to_world(p));
  world = positions_of(own ? o.zone_m : np.still_zone_m);
  std::vector<Polygon> out;
  if (!pixels.empty()) out.emplace_back(pixels, own ? "camera.motion.zone_px" : "np.still_zone_px");
  if (!world.empty()) out.emplace_back(world, own ? "camera.motion.zone_m" : "np.still_zone_m");
  return out;
}

// Centres of subsets, spread evenly, at most most_points.
template <class Wanted>
std::vector<Vec2> spread(const Setting& setting, double side, const Wanted& wanted) {
  for (double step = side / 2;; step *= 1.1) {
    std::vector<Vec2> out;
    for (double r = side / 2 + 2; r <= setting.height - 3 - side / 2; r += step)
      for (double c = side / 2 + 2; c <= setting.width - 3 - side / 2; c += step) {
        const Vec2 p(std::round(c), std::round(r));
        if (wanted(p)) out.push_back(p);
      }
    if (out.size() <= most_points) return out;
  }
}

std::vector<Vec2> points_at_rest(const Case& c, const Setting& setting) {
  const image::CameraMotionOptions& o = c.camera_motion;
  const double side = o.subset_px;
  const std::string section = of_file(c) + ": camera.motion";
  if (o.from == RestSource::targets) {
    if (o.targets_px.empty()) throw InputError(section + ".targets_px: missing, expected the centres of marks at rest");
    std::vector<Vec2> out = positions_of(o.targets_px);
    for (const Vec2& p : out)
      if (!(p.x() >= side / 2 && p.y() >= side / 2 && p.x() <= setting.width - 1 - side / 2 && p.y() <= setting.height - 1 - side / 2))
        throw InputError(section + ".targets_px: found (" + number(p.x()) + ", " + number(p.y()) +
                         "), expected targets at least half of subset_px (" + number(side) + ") from the image's edge");
    if (int(out.size()) < image::least_points(o.model))
      throw InputError(section + ".targets_px: found 1 target, expected at least two for model = \"" +
                       std::string(name_of(o.model)) + "\"; one shows a shift only");
    return out;
  }
  const auto whole = [&](const Vec2& p, const auto& inside) {  // the subset's middle and corners
    const double h = side / 2;
    for (const Vec2& d : {Vec2(0, 0), Vec2(-h, -h), Vec2(h, -h), Vec2(-h, h), Vec2(h, h)})
      if (!inside(Vec2(p + d))) return false;
    return true;
  };
  if (o.from == RestSource::still_zone) {
    const std::vector<Polygon> zone = zones(c, setting);
    if (zone.empty())
      throw InputError(section + ".zone_px: missing, expected a polygon of what is at rest (or np.still_zone_px)");
    std::vector<Vec2> out = spread(setting, side, [&](const Vec2& p) {
      return whole(p, [&](const Vec2& q) { return zone.front().contains(setting.camera.to_world(q)); });
    });
    if (int(out.size()) < image::least_points(o.model))
      throw InputError(section + ".zone_px: it holds " + std::to_string(out.size()) + " subsets of " + number(side) +
                       " px, expected at least " + std::to_string(image::least_points(o.model)) + "; a larger zone, or a smaller subset_px");
    return out;
  }
  const MaskView mask = setting.mask.view();
  std::vector<Vec2> out = spread(setting, side, [&](const Vec2& p) {
    return whole(p, [&](const Vec2& q) {
      if (!mask.usable(std::clamp(int(q.x()), 0, setting.width - 1), std::clamp(int(q.y()), 0, setting.height - 1))) return false;
      if (c.regions.empty()) return true;
      const Vec2 x = setting.camera.to_world(q);
      return std::none_of(setting.regions.begin(), setting.regions.end(), [&](const Region& r) { return r.polygon.contains(x); });
    });
  });
  if (int(out.size()) < 8)
    throw InputError(section + ".from: \"dominant\": regions and masks leave " + std::to_string(out.size()) +
                     " subsets of the image, expected at least 8; name a zone or targets that are at rest");
  return out;
}

// Of points, those far apart: each next is the one farthest from those before.
std::vector<std::size_t> far_apart(const std::vector<Vec2>& points, std::size_t count) {
  std::vector<std::size_t> out{0};
  std::vector<double> off(points.size(), INFINITY);
  while (out.size() < std::min(count, points.size())) {
    for (std::size_t k = 0; k < points.size(); ++k) off[k] = std::min(off[k], (points[k] - points[out.back()]).norm());
    out.push_back(std::size_t(std::max_element(off.begin(), off.end()) - off.begin()));
  }
  return out;
}

class Follower {
 public:
  Follower(const Case& c, const Setting& setting, std::vector<Vec2> points, int threads)
      : o_(c.camera_motion), setting_(setting), points_(std::move(points)), threads_(threads) {
    centre_ = {(setting.width - 1) / 2.0, (setting.height - 1) / 2.0};
    subset_.side_px = o_.subset_px | 1;
    subset_.farthest_px = 6;
    subset_.min_usable = 0.9;
  }
  const Vec2& centre() const { return centre_; }

  // Keeps the points that have texture.
  void start(const Image& first) {
    first_ = first.view();
    reference_.assign(first.view(), {}, threads_);
    std::vector<piv::AffinePrediction> same;
    for (const Vec2& p : points_) same.push_back({p, p, Mat2::Identity()});
    const auto matches = piv::match_subsets(reference_, reference_, same, subset_, threads_);
    std::vector<Vec2> kept;
    for (std::size_t k = 0; k < points_.size(); ++k)
      if (matches[k].found && matches[k].cov[0] + matches[k].cov[1] < 0.01) kept.push_back(points_[k]);
    points_ = std::move(kept);
  }
  std::size_t size() const { return points_.size(); }

  CameraPlace place(const Image& image, const CameraPlace& before) {
    now_.assign(image.view(), {}, threads_);
    if (const auto searched = search(image.view(), before))
      if (const auto found = matched(*searched)) return *found;
    if (const auto found = matched(before)) return *found;
    CameraPlace lost = before;
    lost.points = lost.agree = 0;
    lost.var_shift += o_.search_px * o_.search_px / 3.0;  // anywhere within the search
    return lost;
  }

 private:
  Vec2 at(const CameraPlace& place, const Vec2& pixel) const {
    const CameraMotion motion{centre_, {place}};
    const Vec2 ideal = setting_.camera.lens().to_ideal(pixel);
    const Eigen::Vector3d moved = motion.matrix(0) * Eigen::Vector3d(ideal.x(), ideal.y(), 1);
    return setting_.camera.lens().to_pixel(moved.head<2>());
  }

  // To whole pixels, by a few subsets far apart.
  std::optional<CameraPlace> search(const ImageView& image, const CameraPlace& before) const {
    std::vector<image::RestPoint> found;
    for (const std::size_t k : far_apart(points_, most_searched)) {
      const auto hit = piv::search_subset(first_, image, points_[k], at(before, points_[k]), subset_.side_px, o_.search_px);
      if (hit && hit->score >= least_rest_score)
        found.push_back({setting_.camera.lens().to_ideal(points_[k]), setting_.camera.lens().to_ideal(hit->to), 0});
    }
    const image::RestFit fit = image::fit_rest(found, o_.model, centre_, 1.5, 0.3);
    if (!fit.found || 2 * fit.place.agree < int(found.size())) return std::nullopt;
    return fit.place;
  }

  std::optional<CameraPlace> matched(const CameraPlace& guess) const {
    std::vector<piv::AffinePrediction> predictions;
    Mat2 turn;
    turn << std::cos(guess.turn), -std::sin(guess.turn), std::sin(guess.turn), std::cos(guess.turn);
    for (const Vec2& p : points_) predictions.push_back({p, at(guess, p), guess.scale * turn});
    const auto matches = piv::match_subsets(reference_, now_, predictions, subset_, threads_);
    std::vector<image::RestPoint> found;
    for (std::size_t k = 0; k < matches.size(); ++k)
      if (matches[k].found && matches[k].score >= least_rest_score)
        found.push_back({setting_.camera.lens().to_ideal(points_[k]), setting_.camera.lens().to_ideal(matches[k].to),
                         (matches[k].cov[0] + matches[k].cov[1]) / 2});
    const image::RestFit fit = image::fit_rest(found, o_.model, centre_, tolerance_px);
    if (!fit.found || 3 * fit.place.agree < int(points_.size())) return std::nullopt;
    return fit.place;
  }

  const image::CameraMotionOptions& o_;
  const Setting& setting_;
  std::vector<Vec2> points_;  // pixels of the first frame
  int threads_;
  Vec2 centre_;
  piv::SubsetOptions subset_;
  piv::SubsetImage reference_, now_;
  ImageView first_;
};

std::string name_of_source(RestSource from) {
  return from == RestSource::still_zone ? "the still zone" : from == RestSource::targets ? "the targets" : "the image outside material";
}

InputError tool_lost(const std::string& what, const image::FrameSource& source, int k, int search_px) {
  return InputError(what + ": the tool was not found again in frame " + std::to_string(k) + " (" + source.frames()[std::size_t(k)].name +
                    "), expected it within " + std::to_string(search_px) +
                    " px of where it was; camera.motion.search_px may be greater, or its motion is given by a file (motion)");
}

CameraMotion motion_of_outline(const Case& c, const image::MovingMasks::Followed& shape, const std::string& what, image::FrameSource& source,
                               Progress& progress) {
  const int search = c.camera_motion.search_px, frames = int(source.frames().size());
  const Image first = source.read(0);
  const image::OutlineFollower follower(first.view(), shape.outline, search, what);
  CameraMotion motion;
  motion.centre = follower.centre();
  motion.at.emplace_back();
  for (int k = 1; k < frames; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    const Image frame = source.read(k);
    motion.at.push_back(follower.place(frame.view(), motion.at.back()));
    if (motion.at.back().points == 0) throw tool_lost(what, source, k, search);
    progress.update("tool " + shape.name, k, frames - 1);
  }
  return motion;
}

// Of air = "still": what the scene shows where no material is.
void give_background(Setting& setting, image::FrameSource& source) {
  const Image first = source.read(0), second = source.read(source.frames().size() > 1 ? 1 : 0);
  std::vector<std::uint8_t> material(std::size_t(setting.width) * std::size_t(setting.height));
  for (int r = 0; r < setting.height; ++r)
    for (int k = 0; k < setting.width; ++k) {
      const Vec2 x = setting.camera.to_world({double(k), double(r)});
      material[std::size_t(r) * std::size_t(setting.width) + std::size_t(k)] =
          std::any_of(setting.regions.begin(), setting.regions.end(), [&](const Region& region) { return region.polygon.contains(x); });
    }
  setting.moving_masks.set_background(first.view(), second.view(), material);
}

}  // namespace

CameraMotion find_camera_motion(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                                Progress& progress) {
  if (c.camera_motion.from == RestSource::none) return {};
  Follower follower(c, setting, points_at_rest(c, setting), threads);
  const Image first = source.read(0);
  follower.start(first);
  const std::string where = of_file(c) + ": camera.motion.from: ";
  if (int(follower.size()) < image::least_points(c.camera_motion.model))
    throw InputError(where + name_of_source(c.camera_motion.from) + ": found " + std::to_string(follower.size()) +
                     " subsets with texture, expected at least " + std::to_string(image::least_points(c.camera_motion.model)));
  CameraMotion motion;
  motion.centre = follower.centre();
  motion.at.emplace_back();
  motion.at.front().points = motion.at.front().agree = int(follower.size());
  const int frames = int(source.frames().size());
  for (int k = 1; k < frames; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    motion.at.push_back(follower.place(source.read(k), motion.at.back()));
    progress.update("camera motion", k, frames - 1);
  }
  return motion;
}

void follow_masks(const Case& c, Setting& setting, image::FrameSource& source, int threads, Progress& progress) {
  setting.moving_masks.require_frames(source.frames().size());
  if (setting.moving_masks.wants_background()) give_background(setting, source);
  for (const auto& shape : setting.moving_masks.to_follow()) {
    Case tool = c;
    tool.camera_motion.model = image::MotionModel::rigid;
    tool.camera_motion.subset_px = 31;
    const std::string what = of_file(c) + ": mask." + shape.name + ".follow";
    if (shape.by == image::FollowBy::outline) {
      setting.moving_masks.set_motion(shape.item, motion_of_outline(c, shape, what, source, progress));
      continue;
    }
    const Polygon inside(shape.outline, what);
    const double reach = 0.35 * tool.camera_motion.subset_px;  // most of a subset lies on the tool
    std::vector<Vec2> points = spread(setting, tool.camera_motion.subset_px, [&](const Vec2& p) {
      for (const Vec2& d : {Vec2(0, 0), Vec2(reach, 0), Vec2(-reach, 0), Vec2(0, reach), Vec2(0, -reach)})
        if (!inside.contains(p + d)) return false;
      return true;
    });
    Setting square_on = setting;  // the tool is followed in the image as it is
    square_on.camera = image::Camera();
    Follower follower(tool, square_on, std::move(points), threads);
    const Image first = source.read(0);
    follower.start(first);
    if (follower.size() < 2)
      throw InputError(what + ": found " + std::to_string(follower.size()) + " subsets of " + std::to_string(tool.camera_motion.subset_px) +
                       " px with texture in it, expected at least 2; a larger outline, follow_by = \"outline\", or its motion from a file (motion)");
    CameraMotion motion;
    motion.centre = follower.centre();
    motion.at.emplace_back();
    const int frames = int(source.frames().size());
    for (int k = 1; k < frames; ++k) {
      if (progress.stop_requested()) throw Interrupted();
      motion.at.push_back(follower.place(source.read(k), motion.at.back()));
      if (motion.at.back().points == 0) throw tool_lost(what, source, k, tool.camera_motion.search_px);
      progress.update("tool " + shape.name, k, frames - 1);
    }
    setting.moving_masks.set_motion(shape.item, std::move(motion));
  }
}

std::vector<Remark> camera_motion_remarks(const Case& c, const CameraMotion& motion, const std::vector<Frame>& frames) {
  std::vector<Remark> remarks;
  if (motion.empty()) return remarks;
  const std::string what = name_of_source(c.camera_motion.from);
  std::size_t farthest = 0, step = 0, worst = 0, lost = 0, first_lost = 0, apart = 0, first_apart = 0;
  double shift = 0, jump = 0, turn = 0, zoom = 0, residual = 0;
  for (std::size_t k = 1; k < motion.at.size(); ++k) {
    const CameraPlace& p = motion.at[k];
    if (p.points == 0) {
      if (lost++ == 0) first_lost = k;
      continue;
    }
    if (p.shift.norm() > shift) shift = p.shift.norm(), farthest = k;
    if (const double d = (p.shift - motion.at[k - 1].shift).norm(); d > jump) jump = d, step = k;
    turn = std::max(turn, std::abs(p.turn)), zoom = std::max(zoom, std::abs(p.scale - 1));
    if (p.residual > residual) residual = p.residual, worst = k;
    if (p.agree < usual_share * p.points && apart++ == 0) first_apart = k;
  }
  const auto frame = [&](std::size_t k) { return frames[k].name; };
  if (shift > 0)
    remarks.push_back({"The camera moved, measured by " + what + ": by up to " + number(shift, 3) + " px (" + frame(farthest) + "), " +
                      number(jump, 3) + " px from one frame to the next (" + frame(step) + "), " +
                      number(turn * 180 / std::numbers::pi, 2) + " degrees and " + number(100 * zoom, 2) +
                      " % of scale. This is removed from all vectors."});
  if (apart > 0)
    remarks.push_back({"Not all of " + what + " is at rest: in " + std::to_string(apart) + (apart == 1 ? " frame" : " frames") +
                      ", first in " + frame(first_apart) + ", fewer than " + number(100 * usual_share) +
                      " % of its subsets move alike (" + std::to_string(motion.at[first_apart].agree) + " of " +
                      std::to_string(motion.at[first_apart].points) + " within " + number(tolerance_px) + " px). What most of them share was taken as the camera's motion.", RemarkWeight::doubt});
  else if (residual > loud_residual_px)
    remarks.push_back({"What should be at rest, " + what + ", is not: its subsets depart from one common motion by " + number(residual, 2) +
                      " px RMS in " + frame(worst) + ".", RemarkWeight::doubt});
  if (lost > 0)
    remarks.push_back({"The camera's motion is not known in " + std::to_string(lost) + (lost == 1 ? " frame" : " frames") + ", first in " +
                      frame(first_lost) + ": " + what + " was not found again within camera.motion.search_px (" +
                      std::to_string(c.camera_motion.search_px) + " px). The place of the frame before was kept there.", RemarkWeight::doubt});
  return remarks;
}

std::vector<std::string> still_zone_remarks(const Case& c, const Setting& setting, std::size_t pairs,
                                            const std::function<VectorField(std::size_t)>& pair) {
  if (c.camera_motion.from != RestSource::none || setting.width == 0) return {};
  const std::vector<Polygon> zone = zones(c, setting);
  if (zone.empty()) return {};
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  constexpr double floor_px = 0.1, errors = 4, of_a_median = std::numbers::pi / 2;
  Vec2 place = Vec2::Zero();
  double most = 0, jump = 0, variance = 0;  // variance: of what the vectors' own error adds up to, a component
  std::size_t at = 0;
  for (std::size_t k = 0; k < pairs; ++k) {
    const VectorField field = pair(k);
    std::vector<double> u, v, own;
    for (std::size_t n = 0; n < field.status.size(); ++n) {
      if (field.status[n] != VectorStatus::valid) continue;
      if (!zone.front().contains(setting.grid.position(int(n) % setting.grid.nx, int(n) / setting.grid.nx))) continue;
      u.push_back(double(field.displacement[n][0]));
      v.push_back(double(field.displacement[n][1]));
      if (const double trace = double(field.cov[n][0]) + double(field.cov[n][1]); std::isfinite(trace))
        own.push_back(trace / 2 * (field.path_factor.empty() ? 1.0 : double(field.path_factor[n])));
    }
    if (u.size() < 3) continue;
    const double alike = std::max(1.0, double(field.correlation_length) / setting.grid.spacing.x());  // nodes of one error
    variance += of_a_median * median(std::move(own)) / std::max(1.0, double(u.size()) / (alike * alike));
    const Vec2 step(median(std::move(u)), median(std::move(v)));
    place += step;
    const double by_chance = errors * std::sqrt(variance) / pixel;
    if (place.norm() / pixel > std::max(floor_px, by_chance)) most = std::max(most, place.norm() / pixel);
    if (step.norm() / pixel > jump) jump = step.norm() / pixel, at = k;
  }
  if (!(most > 0)) return {};
  return {"The still zone is not at rest: its median displacement grows to " + number(most, 3) + " px, " + number(jump, 3) +
          " px of it between frames " + std::to_string(at) + " and " + std::to_string(at + 1) +
          ". If the camera moved, all displacements hold its motion; camera.motion.from = \"still_zone\" removes it."};
}

}  // namespace pivnp::app

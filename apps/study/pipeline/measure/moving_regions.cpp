#include "apps/study/pipeline/measure/moving_regions.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/study/pipeline/measure/outside_evidence.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr double first_apart_px = 4, most_apart_px = 6, least_apart_px = 2;

double pixel_size(const Setting& setting) { return setting.grid.spacing.x() / node_spacing_px(setting); }

// Points between those that are too far apart; those too near go.
void even_out(double px, std::vector<OutlinePoint>& points) {
  std::vector<OutlinePoint> out;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const OutlinePoint &a = points[k], &b = points[(k + 1) % points.size()];
    if (!out.empty() && (a.place - out.back().place).norm() < least_apart_px * px) continue;
    out.push_back(a);
    const double gap = (b.place - a.place).norm() / px;
    const int pieces = std::min(1000, int(std::ceil(gap / first_apart_px)));
    for (int n = 1; gap > most_apart_px && n < pieces; ++n) {
      OutlinePoint between = n * 2 < pieces ? a : b;
      between.place = a.place + (b.place - a.place) * (double(n) / pieces);
      between.moved = a.moved + (b.moved - a.moved) * (double(n) / pieces);
      out.push_back(between);
    }
  }
  points = std::move(out);
}

void carry_points(double px, MovingOutline& outline) {
  for (OutlinePoint& p : outline.points) p.place += p.moved;
  even_out(px, outline.points);
}

}  // namespace

std::vector<MovingOutline> outlines_of_regions(const Setting& setting) {
  std::vector<MovingOutline> out;
  for (const Region& region : setting.regions) {
    MovingOutline& outline = out.emplace_back(MovingOutline{region.name, {}});
    for (const Vec2& vertex : region.polygon.vertices()) outline.points.push_back({.place = vertex});
    even_out(pixel_size(setting), outline.points);
  }
  return out;
}

bool move_outlines(const VectorField& field, const Setting& setting, int window_px, std::vector<MovingOutline>& outlines) {
  const auto inside = inside_outlines(outlines, setting.camera_at(field.pair[0]), setting.width, setting.height);
  for (MovingOutline& outline : outlines) {
    if (!find_moves(field, inside, setting, window_px * pixel_size(setting), outline)) return false;
    for (OutlinePoint& p : outline.points) p.place += p.moved;
  }
  return true;
}

void carry_outlines(const VectorField& field, const Setting& setting, int window_px, std::vector<MovingOutline>& outlines) {
  if (!move_outlines(field, setting, window_px, outlines)) return outlines.clear();
  for (MovingOutline& outline : outlines) even_out(pixel_size(setting), outline.points);
}

std::vector<std::uint8_t> inside_outlines(const std::vector<MovingOutline>& outlines, const image::Camera& camera, int width, int height) {
  std::vector<std::uint8_t> out(std::size_t(width) * std::size_t(height), 0);
  std::vector<std::vector<std::pair<double, int>>> crossings(static_cast<std::size_t>(height));  // of each row: column, sense
  for (const MovingOutline& outline : outlines) {
    for (auto& row : crossings) row.clear();
    Vec2 a = camera.to_pixel(outline.points.back().place);
    for (const OutlinePoint& point : outline.points) {
      const Vec2 b = camera.to_pixel(point.place);
      const double top = std::min(a.y(), b.y()), bottom = std::max(a.y(), b.y());
      // Rows in (top, bottom]: a corner counts once.
      for (int r = int(std::clamp(std::floor(top) + 1, 0.0, double(height))); r < height && r <= bottom; ++r)
        crossings[std::size_t(r)].emplace_back(a.x() + (b.x() - a.x()) * (r - a.y()) / (b.y() - a.y()), b.y() > a.y() ? 1 : -1);
      a = b;
    }
    for (int r = 0; r < height; ++r) {
      auto& row = crossings[std::size_t(r)];
      std::sort(row.begin(), row.end());
      int winding = 0;
      for (std::size_t n = 0; n + 1 < row.size(); ++n) {
        winding += row[n].second;
        if (winding == 0) continue;
        const int from = int(std::clamp(std::ceil(row[n].first), 0.0, double(width)));
        const int to = int(std::clamp(std::floor(row[n + 1].first) + 1, 0.0, double(width)));
        if (from < to) std::fill(out.begin() + r * std::ptrdiff_t(width) + from, out.begin() + r * std::ptrdiff_t(width) + to, std::uint8_t{1});
      }
    }
  }
  return out;
}

bool find_moves(const VectorField& field, const std::vector<std::uint8_t>& inside, const Setting& setting, double reach, MovingOutline& outline) {
  constexpr double deviation = 0.4, stiffness = 0.05, least_weight = 3;
  const Grid& grid = field.grid;
  const image::Camera& camera = setting.camera_at(field.pair[0]);
  const int cells = int(std::ceil(reach / grid.spacing.x())) + 1;
  std::size_t asked = 0, carried = 0;
  for (OutlinePoint& point : outline.points) {
    const int i0 = int(std::lround((point.place.x() - grid.origin.x()) / grid.spacing.x())),
              j0 = int(std::lround((point.place.y() - grid.origin.y()) / grid.spacing.y()));
    Mat3 normal = Mat3::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    bool near = false;
    for (int j = std::max(0, j0 - cells); j <= std::min(grid.ny - 1, j0 + cells); ++j)
      for (int i = std::max(0, i0 - cells); i <= std::min(grid.nx - 1, i0 + cells); ++i) {
        const std::size_t n = grid.node(i, j);
        const Vec2 at = grid.position(i, j);
        near = near || (at - point.place).norm() < reach;
        if (field.status[n] != VectorStatus::valid) continue;
        const Vec2 d(double(field.displacement[n][0]), double(field.displacement[n][1]));
        const Vec2 start = field.anchor == Anchor::central ? Vec2(at - d / 2) : at, off = start - point.place;
        if (!(off.norm() < reach)) continue;
        const Vec2 px = camera.to_pixel(start);
        const int column = int(std::lround(px.x())), row = int(std::lround(px.y()));
        if (column < 0 || row < 0 || column >= setting.width || row >= setting.height ||
            !inside[std::size_t(row) * std::size_t(setting.width) + std::size_t(column)])
          continue;
        const double scale = deviation * reach, weight = std::exp(-0.5 * off.squaredNorm() / (scale * scale));
        const Eigen::Vector3d terms(1, off.x() / scale, off.y() / scale);
        normal += weight * terms * terms.transpose();
        right += weight * terms * d.transpose();
      }
    point.carried = normal(0, 0) > 0;
    asked += near, carried += near && point.carried;
    if (!point.carried) continue;
    // A plane where vectors surround the place, their mean where they do not.
    const double slopes = stiffness * normal(0, 0) + std::max(0.0, least_weight - normal(0, 0));
    normal(1, 1) += slopes, normal(2, 2) += slopes;
    const Eigen::Matrix<double, 3, 2> fit = normal.ldlt().solve(right);
    point.moved = Vec2(fit(0, 0), fit(0, 1));
  }
  // What no vector carries goes with the nearest point on either side that one does.
  const std::size_t count = outline.points.size();
  std::vector<std::size_t> with;
  for (std::size_t k = 0; k < count; ++k)
    if (outline.points[k].carried) with.push_back(k);
  for (std::size_t k = 0; k < count && !with.empty(); ++k) {
    if (outline.points[k].carried) continue;
    const auto after = std::upper_bound(with.begin(), with.end(), k);
    const std::size_t b = after == with.end() ? with.front() : *after, a = after == with.begin() ? with.back() : *(after - 1);
    const double from_a = double((k + count - a) % count), to_b = double((b + count - k) % count);
    outline.points[k].moved = (to_b * outline.points[a].moved + from_a * outline.points[b].moved) / (from_a + to_b);
  }
  return 2 * carried >= asked;
}

MovingRegions::MovingRegions(const Setting& setting, int window_px, bool on, double row_time_s, std::vector<double> times)
    : setting_(setting), window_px_(window_px), row_time_s_(row_time_s), times_(std::move(times)) {
  if (on) now_ = kept_ = outlines_of_regions(setting);
}

void MovingRegions::look(int frame, const ImageView& first, const ImageView& second) {
  mask_.clear();
  if (now_.empty()) return;
  const auto inside = inside_outlines(now_, setting_.camera_at(frame), setting_.width, setting_.height);
  mask_ = judge_outside(inside, setting_, {frame, frame + 1}, first, second, window_px_, now_);
}

MaskView MovingRegions::mask() const {
  if (mask_.empty()) return {};
  return {mask_.data(), setting_.width, setting_.height, setting_.width};
}

bool MovingRegions::revise(const VectorField& own, const ImageView& first, const ImageView& second) {
  constexpr std::size_t few = 3;
  std::vector<std::vector<bool>> before;
  const auto inside = inside_outlines(now_, setting_.camera_at(own.pair[0]), setting_.width, setting_.height);
  for (MovingOutline& outline : now_) {
    auto& masked = before.emplace_back();
    for (const OutlinePoint& p : outline.points) masked.push_back(app::left_out(p.outside));
    find_moves(own, inside, setting_, window_px_ * pixel_size(setting_), outline);
  }
  mask_ = judge_outside(inside, setting_, own.pair, first, second, window_px_, now_);
  std::size_t changed = 0;
  for (std::size_t n = 0; n < now_.size(); ++n)
    for (std::size_t k = 0; k < now_[n].points.size(); ++k) changed += app::left_out(now_[n].points[k].outside) != before[n][k];
  return changed > few;
}

void MovingRegions::carry(const VectorField& own) {
  const auto inside = inside_outlines(now_, setting_.camera_at(own.pair[0]), setting_.width, setting_.height);
  for (auto outline = now_.begin(); outline != now_.end();) {
    for (const OutlinePoint& p : outline->points) ++judged_, masked_ += app::left_out(p.outside);
    if (!find_moves(own, inside, setting_, window_px_ * pixel_size(setting_), *outline)) {
      const std::string words = "Region '" + outline->name + "' was lost after frame " + std::to_string(own.pair[0]) +
                                ": vectors were found along less than half of its outline. From there on nothing beyond the regions was left out.";
      lost_ = {words};
      now_.clear();  // what is left of the others would take this one's material for ground
      return;
    }
    carry_points(pixel_size(setting_), *outline);
    ++outline;
  }
}

void MovingRegions::carry_on() {
  for (MovingOutline& outline : now_) carry_points(pixel_size(setting_), outline);
}

void MovingRegions::keep(const VectorField& kept) {
  if (kept_.empty()) return;
  if (row_time_s_ == 0) return carry_outlines(kept, setting_, window_px_, kept_);
  const std::vector<MovingOutline> before = kept_;
  if (!move_outlines(kept, setting_, window_px_, kept_)) return kept_.clear();
  // A point is seen tau (r - r_m) after the time of its frame, and one frame later at another row.
  const double dt = times_.at(std::size_t(kept.pair[1])) - times_.at(std::size_t(kept.pair[0])), middle = (setting_.height - 1) / 2.0;
  for (std::size_t n = 0; n < kept_.size(); ++n) {
    for (std::size_t k = 0; k < kept_[n].points.size(); ++k) {
      OutlinePoint& p = kept_[n].points[k];
      const OutlinePoint& was = before[n].points[k];
      const double from = setting_.camera.to_pixel(was.place).y(), to = setting_.camera.to_pixel(p.place).y();
      if (!std::isfinite(from + to)) continue;
      Vec2 later = (to - from) * p.moved;
      if (kept_moves_) later += (from - middle) * (p.moved - was.moved);
      p.place += row_time_s_ / dt * later;
    }
    even_out(pixel_size(setting_), kept_[n].points);
  }
  kept_moves_ = true;
}

// What is outside is found anew, so that it does not depend on where a run was taken up again.
void MovingRegions::begin_group(bool one_more) {
  now_ = kept_;
  if (one_more) carry_on();
  for (MovingOutline& outline : now_)
    for (OutlinePoint& p : outline.points) p.outside = Outside::unknown;
}

std::vector<Remark> MovingRegions::remarks() const {
  std::vector<Remark> out;
  for (const std::string& words : lost_) out.push_back({words, RemarkWeight::doubt});
  if (const double share = left_out(); share >= 0.005)
    out.push_back({"The regions moved with their material as masks: beside " + number(std::round(100 * share)) +
                   " % of their outlines, over all pairs, what lies outside stood still and was left out (piv.follow_regions)."});
  return out;
}

}  // namespace pivnp::app

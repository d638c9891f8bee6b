#include "pivnp/image/masks/outline_follower.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::image {

namespace {

constexpr int inside_px = 7, outside_px = 3, across = inside_px + outside_px + 1, along = 8;
constexpr double coarse_sigma = 2.5, fine_sigma = 1, least_score = 0.6;
constexpr std::size_t most_strips = 400;

using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Vector5 = Eigen::Matrix<double, 5, 1>;

double grey_at(const ImageView& image, int c, int r) {
  c = std::clamp(c, 0, image.width - 1), r = std::clamp(r, 0, image.height - 1);
  switch (image.depth) {
    case PixelDepth::u8: return double(image.row<std::uint8_t>(r)[c]) / double(image.white);
    case PixelDepth::u16: return double(image.row<std::uint16_t>(r)[c]) / double(image.white);
    case PixelDepth::f32: return double(image.row<float>(r)[c]) / double(image.white);
  }
  return 0;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double n = 0, sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) continue;
    n += 1, sa += a[k], sb += b[k], aa += a[k] * a[k], bb += b[k] * b[k], ab += a[k] * b[k];
  }
  const double va = aa - sa * sa / n, vb = bb - sb * sb / n;
  return n > 0 && va > 0 && vb > 0 ? (ab - sa * sb / n) / std::sqrt(va * vb) : 0;
}

double median_of(std::vector<double> v) {
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}

}  // namespace

// A part of an image, smoothed.
struct OutlineFollower::Patch {
  int left = 0, top = 0, width = 0, height = 0, image_width = 0, image_height = 0;
  std::vector<float> grey;

  double at(int c, int r) const { return double(grey[std::size_t(r) * std::size_t(width) + std::size_t(c)]); }
  // NaN beyond the image. Bilinear.
  double value(const Vec2& p) const {
    if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= image_width - 1 && p.y() <= image_height - 1)) return NAN;
    const double x = std::clamp(p.x() - left, 0.0, width - 1.001), y = std::clamp(p.y() - top, 0.0, height - 1.001);
    const int c = int(x), r = int(y);
    const double a = x - c, b = y - r;
    return (1 - b) * ((1 - a) * at(c, r) + a * at(c + 1, r)) + b * ((1 - a) * at(c, r + 1) + a * at(c + 1, r + 1));
  }
};

struct OutlineFollower::Solution {
  CameraPlace place;
  double score = 0;
};

Vec2 OutlineFollower::moved(const CameraPlace& place, const Vec2& p) const {
  const double c = std::cos(place.turn), s = std::sin(place.turn);
  const Vec2 d = p - centre_;
  return centre_ + Vec2(c * d.x() - s * d.y(), s * d.x() + c * d.y()) + place.shift;
}

OutlineFollower::Patch OutlineFollower::patch_about(const ImageView& image, const CameraPlace& place, double margin, double sigma) const {
  Vec2 lower = moved(place, points_.front()), upper = lower;
  for (const Vec2& p : points_) lower = lower.cwiseMin(moved(place, p)), upper = upper.cwiseMax(moved(place, p));
  Patch out;
  out.image_width = image.width, out.image_height = image.height;
  out.left = int(std::floor(std::clamp(lower.x() - margin, 0.0, image.width - 3.0)));
  out.top = int(std::floor(std::clamp(lower.y() - margin, 0.0, image.height - 3.0)));
  out.width = std::max(3, int(std::ceil(std::clamp(upper.x() + margin, 2.0, image.width - 1.0))) - out.left + 1);
  out.height = std::max(3, int(std::ceil(std::clamp(upper.y() + margin, 2.0, image.height - 1.0))) - out.top + 1);
  out.width = std::min(out.width, image.width - out.left), out.height = std::min(out.height, image.height - out.top);
  const int reach = int(std::ceil(3 * sigma));
  std::vector<double> weight;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) weight.push_back(std::exp(-k * k / (2 * sigma * sigma))), sum += weight.back();
  std::vector<float> rows(std::size_t(out.width) * std::size_t(out.height + 2 * reach));
  for (int r = 0; r < out.height + 2 * reach; ++r)
    for (int c = 0; c < out.width; ++c) {
      double v = 0;
      for (int k = -reach; k <= reach; ++k) v += weight[std::size_t(k + reach)] * grey_at(image, out.left + c + k, out.top + r - reach);
      rows[std::size_t(r) * std::size_t(out.width) + std::size_t(c)] = float(v / sum);
    }
  out.grey.resize(std::size_t(out.width) * std::size_t(out.height));
  for (int r = 0; r < out.height; ++r)
    for (int c = 0; c < out.width; ++c) {
      double v = 0;
      for (int k = 0; k <= 2 * reach; ++k) v += weight[std::size_t(k)] * double(rows[std::size_t(r + k) * std::size_t(out.width) + std::size_t(c)]);
      out.grey[std::size_t(r) * std::size_t(out.width) + std::size_t(c)] = float(v / sum);
    }
  return out;
}

// Means over the strips, NaN where a strip leaves the image; `slope`: of each point. Of strips, each `every`-th.
std::vector<double> OutlineFollower::band(const Patch& patch, const CameraPlace& place, std::vector<Vec2>* slope, std::size_t every) const {
  std::vector<double> out(points_.size() / along, NAN);
  if (slope) slope->resize(points_.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (k / across % every != 0) continue;
    double sum = 0;
    for (std::size_t n = k * along; n < (k + 1) * along; ++n) {
      const Vec2 p = moved(place, points_[n]);
      sum += patch.value(p);
      if (slope)
        (*slope)[n] = {(patch.value(p + Vec2(0.5, 0)) - patch.value(p - Vec2(0.5, 0))), (patch.value(p + Vec2(0, 0.5)) - patch.value(p - Vec2(0, 0.5)))};
    }
    out[k] = sum / along;
  }
  return out;
}

OutlineFollower::OutlineFollower(const ImageView& first, std::vector<Vec2> outline, int search_px, const std::string& what)
    : search_px_(search_px) {
  double area = 0, length = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 &a = outline[k], &b = outline[(k + 1) % outline.size()];
    area += a.x() * b.y() - b.x() * a.y(), length += (b - a).norm();
  }
  Vec2 lower = outline.front(), upper = lower;
  for (const Vec2& p : outline) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  centre_ = (lower + upper) / 2;
  const double outward = area > 0 ? 1 : -1;  // of (t_y, -t_x) along the way of the vertices
  // Points a pixel apart on the way round; strips where the image holds them.
  const double every = std::max(double(along), length / double(most_strips));
  std::vector<std::pair<Vec2, Vec2>> way;  // place and outward normal, every pixel
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 a = outline[k], t = outline[(k + 1) % outline.size()] - a;
    const int pieces = std::max(1, int(std::lround(t.norm())));
    for (int n = 0; n < pieces; ++n) way.emplace_back(a + (n + 0.5) / pieces * t, outward * Vec2(t.y(), -t.x()).normalized());
  }
  for (double at = 0; at + along <= double(way.size()); at += every)
    for (int s = -inside_px; s <= outside_px; ++s)
      for (int n = 0; n < along; ++n) points_.push_back(way[std::size_t(at) + std::size_t(n)].first + s * way[std::size_t(at) + std::size_t(n)].second);
  if (points_.size() < std::size_t(4 * across * along))
    throw InputError(what + ": its outline is " + number(length, 3) + " px long, expected at least " + std::to_string(4 * along));
  const CameraPlace rest;
  coarse_ = band(patch_about(first, rest, outside_px, coarse_sigma), rest);
  std::vector<Vec2> slope;
  const Patch patch = patch_about(first, rest, outside_px, fine_sigma);
  fine_ = band(patch, rest, &slope);
  std::vector<double> steps;
  for (std::size_t k = 0; k < fine_.size(); k += across)
    if (const double d = std::abs(fine_[k] - fine_[k + across - 1]); std::isfinite(d)) steps.push_back(d);
  step_ = median_of(std::move(steps));
  if (!(step_ > 0.02))
    throw InputError(what + ": no edge is seen along it in the first frame: grey values inside and outside differ by " +
                     number(100 * step_, 2) + " % of white in the median, expected more than 2 %");
  Mat2 normal = Mat2::Zero();  // of shifts, over the strips
  for (std::size_t k = 0; k < fine_.size(); ++k) {
    if (!std::isfinite(fine_[k])) continue;
    Vec2 j = Vec2::Zero();
    for (std::size_t n = k * along; n < (k + 1) * along; ++n)
      if (slope[n].allFinite()) j += slope[n];
    normal += j * j.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat2> shifts(normal);
  if (!(shifts.eigenvalues()[0] > 0.02 * shifts.eigenvalues()[1]))
    throw InputError(what + ": its outline shows motion in one direction alone, as a straight edge does; expected an outline with edges in "
                     "several directions, or the motion from a file (motion)");
  // What is found again must be more alike than the like of it elsewhere.
  const Patch around = patch_about(first, rest, search_px_ + outside_px, coarse_sigma);
  double elsewhere = 0;
  for (int r = -search_px_; r <= search_px_; r += 2)
    for (int c = -search_px_; c <= search_px_; c += 2) {
      if (std::hypot(c, r) < inside_px) continue;
      CameraPlace there;
      there.shift = {double(c), double(r)};
      elsewhere = std::max(elsewhere, correlation(band(around, there, nullptr, 2), coarse_));
    }
  least_score_ = std::clamp(elsewhere + 0.1, least_score, 0.9);
  // How much of a turn the normals of the outline itself show, beyond what looks as a shift: a circle, none.
  Eigen::Matrix3d shown = Eigen::Matrix3d::Zero();
  for (const auto& [p, n] : way) {
    const Eigen::Vector3d j(n.x(), n.y(), n.dot(Vec2(-(p - centre_).y(), (p - centre_).x())));
    shown += j * j.transpose() / double(way.size());
  }
  const Vec2 mixed = shown.topRightCorner<2, 1>(), shift = Mat2(shown.topLeftCorner<2, 2>()).ldlt().solve(mixed);
  turns_ = shown(2, 2) - mixed.dot(shift) > 0.005 * (upper - lower).squaredNorm() / 4;
}

OutlineFollower::Solution OutlineFollower::refine(const Patch& patch, const std::vector<double>& reference, CameraPlace place, int steps) const {
  Solution out;
  out.place = place;
  double gain = 1, offset = 0;
  for (int step = 0; step <= steps; ++step) {
    std::vector<Vec2> slope;
    const std::vector<double> now = band(patch, out.place, &slope);
    std::vector<double> off;
    for (std::size_t k = 0; k < now.size(); ++k)
      if (std::isfinite(now[k]) && std::isfinite(reference[k])) off.push_back(std::abs(now[k] - gain * reference[k] - offset));
    if (off.size() < now.size() / 3) return {};
    const double scale = std::max(1.4826 * median_of(off), 0.05 * step_), far = 4.685 * scale;
    Matrix5 normal = Matrix5::Zero();
    Vector5 right = Vector5::Zero();
    double squares = 0, weights = 0;
    int used = 0;
    out.place.points = out.place.agree = 0;
    const double c = std::cos(out.place.turn), s = std::sin(out.place.turn);
    for (std::size_t strip = 0; strip < now.size(); strip += across) {
      int whole = 0, near = 0;
      for (std::size_t k = strip; k < strip + across; ++k) {
        if (!std::isfinite(now[k]) || !std::isfinite(reference[k])) continue;
        ++whole;
        Vector5 j = Vector5::Zero();
        for (std::size_t n = k * along; n < (k + 1) * along; ++n) {
          const Vec2 d = points_[n] - centre_, turned(-s * d.x() - c * d.y(), c * d.x() - s * d.y());
          j.head<2>() += slope[n] / along;
          j[2] += slope[n].dot(turned) / along;
        }
        if (!j.allFinite()) continue;
        j[3] = -reference[k], j[4] = -1;
        const double r = now[k] - gain * reference[k] - offset, q = r / far;
        if (std::abs(r) < 0.3 * step_) ++near;
        if (std::abs(q) >= 1) continue;
        const double w = (1 - q * q) * (1 - q * q);
        normal += w * j * j.transpose(), right -= w * r * j;
        squares += w * r * r, weights += w, ++used;
      }
      if (whole < across) continue;
      ++out.place.points;
      if (near > 0.7 * across) ++out.place.agree;
    }
    if (used < 20) return {};
    if (!turns_) normal.row(2).setZero(), normal.col(2).setZero(), normal(2, 2) = 1, right[2] = 0;
    const Eigen::LDLT<Matrix5> solver(normal);
    out.place.residual = std::sqrt(squares / weights) / step_;
    const Matrix5 inverse = solver.solve(Matrix5::Identity());
    const double spread = squares / weights;
    out.place.var_shift = spread * (inverse(0, 0) + inverse(1, 1)) / 2;
    out.place.var_turn = turns_ ? spread * inverse(2, 2) : 0;
    out.score = correlation(now, reference);
    if (step == steps) break;
    const Vector5 delta = solver.solve(right);
    if (!delta.allFinite() || delta.head<2>().norm() > search_px_) return {};
    out.place.shift += delta.head<2>();
    out.place.turn += delta[2];
    gain += delta[3], offset += delta[4];
    if (delta.head<2>().norm() < 1e-4 && std::abs(delta[2]) < 1e-6) steps = step + 1;
  }
  return out;
}

CameraPlace OutlineFollower::place(const ImageView& image, const CameraPlace& before) const {
  const Patch coarse = patch_about(image, before, search_px_ + outside_px, coarse_sigma);
  CameraPlace best = before;
  double most = -1;
  const double lever = (points_.front() - centre_).norm();
  const std::size_t every = std::max<std::size_t>(1, points_.size() / std::size_t(across * along) / 60);
  for (const int turn : turns_ ? std::vector<int>{0, -1, 1} : std::vector<int>{0})
    for (int r = -search_px_; r <= search_px_; r += 2)
      for (int c = -search_px_; c <= search_px_; c += 2) {
        CameraPlace there = before;
        there.shift += Vec2(c, r);
        there.turn += turn * 3 / std::max(lever, 1.0);
        if (const double score = correlation(band(coarse, there, nullptr, every), coarse_); score > most) most = score, best = there;
      }
  CameraPlace lost = before;
  lost.points = lost.agree = 0;
  const Solution rough = refine(coarse, coarse_, best, 15);
  if (!(rough.score > least_score_)) return lost;
  const Solution found = refine(patch_about(image, rough.place, 2 + outside_px, fine_sigma), fine_, rough.place, 25);
  const bool near = (found.place.shift - before.shift).norm() < 1.5 * search_px_ + 2;
  if (!(found.score > least_score_) || 2 * found.place.agree < found.place.points || !near) return lost;
  return found.place;
}

}  // namespace pivnp::image

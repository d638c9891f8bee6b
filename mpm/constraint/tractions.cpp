#include "mpm/constraint/tractions.hpp"

#include <cmath>
#include <limits>

#include "mpm/grid/sweeps.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

constexpr double upper_part = 1.5, whole_layer = 4.5;  // cells: where f = 1, and where it ends
constexpr double beside_face = 0.75;  // of a point's side: the points next to a face are nearer to it

}  // namespace

Tractions::Tractions(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const ParticleSet& particles,
                     const Vec2& cell) {
  std::vector<std::pair<std::size_t, InLayer>> layers;
  for (std::size_t b = 0; b < boundaries.size(); ++b)
    if (boundaries[b].second.type == BoundaryType::traction)
      add("boundary." + boundaries[b].first, boundaries[b].second, b, particles, cell, layers);
  if (pieces_.empty()) return;
  over_.assign(particles.size(), -1);
  for (std::size_t k = pieces_.size(); k-- > 0;) {
    std::int32_t& first = over_[pieces_[k].particle];
    pieces_[k].next = first;
    first = std::int32_t(k);
  }
  std::stable_sort(layers.begin(), layers.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  first_.assign(particles.size() + 1, 0);
  for (const auto& [particle, in_layer] : layers) {
    layers_.push_back(in_layer);
    ++first_[particle + 1];
  }
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
}

void Tractions::add(const std::string& key, const BoundaryOptions& o, std::size_t boundary, const ParticleSet& particles,
                    const Vec2& cell, std::vector<std::pair<std::size_t, InLayer>>& layers) {
  if (!o.traction_pa) throw InputError(key + ".traction_pa: missing beside type = \"traction\"");
  if (o.line_m.size() != 2) throw InputError(key + ".line_m: expected two end points of the loaded face");
  const Vec2 a(o.line_m[0][0], o.line_m[0][1]), b(o.line_m[1][0], o.line_m[1][1]);
  const double length = (b - a).norm();
  if (!(length > 0)) throw InputError(key + ".line_m: expected two different end points");
  const Vec2 along = (b - a) / length;
  if (!(o.rise_s >= 0)) throw InputError(key + ".rise_s: found " + number(o.rise_s) + ", expected 0 s or more");

  struct Near {
    std::size_t particle;
    double on, off;  // along the line; to its left
  };
  const Vec2 left(-along.y(), along.x());
  double depth = whole_layer * (std::abs(left.x()) * cell.x() + std::abs(left.y()) * cell.y());
  std::vector<Near> near;
  std::vector<Near> beside[2];  // to its left and right
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Vec2 d = particles.x0[k] - a;
    const Near n{k, d.dot(along), d.dot(left)};
    if (n.on < 0 || n.on > length || std::abs(n.off) >= depth) continue;
    near.push_back(n);
    if (std::abs(n.off) < beside_face * std::sqrt(double(particles.area[k]))) beside[n.off < 0].push_back(n);
  }
  if (beside[0].empty() && beside[1].empty())
    throw InputError(key + ".line_m: no particle lies along it, expected a face of the material");
  const bool right = beside[1].size() > beside[0].size();
  if (2 * beside[!right].size() > beside[right].size())
    throw InputError(key + ".line_m: material lies on both sides of it, expected a face of the material");
  std::vector<Near>& face = beside[right];
  std::sort(face.begin(), face.end(), [](const Near& m, const Near& n) { return m.on < n.on; });
  const std::size_t first_piece = pieces_.size();
  for (const Near& n : face)
    pieces_.push_back({.particle = n.particle,
                       .face = length / double(face.size()),
                       .along = along,
                       .traction = Vec2((*o.traction_pa)[0], (*o.traction_pa)[1]),
                       .follows = o.follows_face,
                       .rise = o.rise_s,
                       .until = o.until_s.value_or(std::numeric_limits<double>::infinity()),
                       .boundary = std::uint16_t(boundary),
                       .next = -1});

  const Vec2 normal = right ? left : Vec2(-left);
  const auto under = [&](const Near& n) { return right ? -n.off : n.off; };
  double volume = 0;
  for (const Near& n : near)
    if (under(n) > 0) volume += double(particles.area[n.particle]);
  depth = std::min(depth, volume / length);  // of a thin slab all
  const double upper = upper_part / whole_layer * depth;
  // f = 1 - 3 s^2 + 2 s^3, s from 0 to 1 where it falls.
  const auto fallen = [&](const Near& n) { return std::clamp((under(n) - upper) / (depth - upper), 0.0, 1.0); };
  const auto slope = [](double s) { return s * (1 - s); };
  double slopes = 0;
  for (const Near& n : near) slopes += double(particles.area[n.particle]) * slope(fallen(n));
  for (const Near& n : near) {
    if (under(n) >= depth || under(n) < -beside_face * std::sqrt(double(particles.area[n.particle]))) continue;
    const auto after = std::lower_bound(face.begin(), face.end(), n.on, [](const Near& m, double on) { return m.on < on; });
    auto piece = std::size_t(after - face.begin());
    if (after == face.end() || (piece > 0 && n.on - face[piece - 1].on < after->on - n.on)) --piece;
    const double s = fallen(n);
    layers.push_back({n.particle, {std::uint32_t(first_piece + piece), 1 - s * s * (3 - 2 * s), length * slope(s) / slopes, normal}});
  }
  if (o.rise_s > 0) changes_.push_back(o.rise_s);
  if (o.until_s) changes_.push_back(*o.until_s);
}

const Traction* Tractions::of(std::size_t particle) const {
  return over_.empty() || over_[particle] < 0 ? nullptr : &pieces_[std::size_t(over_[particle])];
}

void Tractions::add_to_loads(const Particles& p, GridState& g, double time, double dt, std::span<Impulse> of_boundaries,
                             int threads) const {
  const auto gradient = [&](std::size_t k) { return Mat2{{p.F_xx[k], p.F_xy[k]}, {p.F_yx[k], p.F_yy[k]}}; };
  std::vector<Vec2> traction(pieces_.size());
  for (std::size_t k = 0; k < p.size(); ++k)
    for (std::int32_t a = over_[p.index[k]]; a >= 0; a = pieces_[std::size_t(a)].next) {
      const Traction& piece = pieces_[std::size_t(a)];
      const Vec2 t = piece.share(time) * piece.traction_now(gradient(k));
      traction[std::size_t(a)] = t;
      if (p.cell[k] != Particles::ended) of_boundaries[piece.boundary].add(dt * piece.face * t, {p.x[k], p.y[k]});
    }
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    const auto loaded = [&](std::uint32_t k) { return !layers(p.index[k]).empty(); };
    for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
      for_points<S>(p, g, range, loaded, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
        const Mat2 F = gradient(k);
        for (const InLayer& l : layers(p.index[k])) {
          const Vec2 t = p.volume0[k] * traction[l.piece], normal = F * l.normal;
          for (int c = 0; c < S::width * S::width; ++c) {
            const int i = c % S::width, j = c / S::width;
            const double across = normal.x() * g.per_hx * x.g[i] * y.w[j] + normal.y() * g.per_hy * x.w[i] * y.g[j];
            const double by = l.share * across + l.change * x.w[i] * y.w[j];
            g.arrays.loads[at[c]].x += by * t.x();
            g.arrays.loads[at[c]].y += by * t.y();
          }
        }
      });
    });
  });
}

}  // namespace pivnp::mpm

#include "mpm/constraint/tractions.hpp"

#include <cmath>
#include <limits>
#include <set>

#include "mpm/constraint/face_layer.hpp"
#include "mpm/grid/sweeps.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

// Of a point's side: the points next to a face are nearer to it; where it just leaves out a row, the next one is not.
constexpr double beside_face = 0.75, beside_cut_face = 1.001;
constexpr double whole = 6, torn = 12;  // |F|^2 of a column's points: the stress is that of f up to one, and gone from the other on

// A point near a line: its place along it, its depth under the face (at first: to the line's left), and its side.
struct Near {
  std::size_t particle;
  double on, off, side;
  bool beside = false;  // the face
};

// The points of the material that has a face, from the face down; `normal`: out of it.
std::vector<Near> points_under(const std::string& key, const Vec2& from, const Vec2& along, double length, double depth,
                               const ParticleSet& particles, Vec2& normal) {
  const Vec2 left(-along.y(), along.x());
  std::vector<Near> near;
  std::set<std::int32_t> labels;  // of what has the face
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Vec2 d = particles.x0[k] - from;
    const Near n{k, d.dot(along), d.dot(left), std::sqrt(double(particles.area[k]))};
    if (n.on < 0 || n.on > length || std::abs(n.off) >= depth) continue;
    near.push_back(n);
  }
  for (const double within : {beside_face, beside_cut_face}) {
    if (!labels.empty()) break;
    for (Near& n : near)
      if ((n.beside = std::abs(n.off) < within * n.side)) labels.insert(particles.label[n.particle]);
  }
  if (labels.empty()) throw InputError(key + ".line_m: no particle lies along it, expected a face of the material");
  std::erase_if(near, [&](const Near& n) { return !labels.contains(particles.label[n.particle]); });
  const auto beyond = [&](double sign) {
    return std::count_if(near.begin(), near.end(), [&](const Near& n) { return sign * n.off > 0 && !n.beside; });
  };
  const auto to_left = beyond(1), to_right = beyond(-1);
  if (2 * std::min(to_left, to_right) > std::max(to_left, to_right))
    throw InputError(key + ".line_m: material lies on both sides of it, expected a face of the material");
  const bool right = to_right > to_left;
  normal = right ? left : Vec2(-left);
  for (Near& n : near) n.off = right ? -n.off : n.off;
  std::erase_if(near, [](const Near& n) { return n.off < 0 && !n.beside; });
  std::stable_sort(near.begin(), near.end(), [](const Near& m, const Near& n) { return m.off < n.off; });
  return near;
}

// Under each of the outermost points, from it down to the first gap; along the face.
std::vector<std::vector<Near>> columns_of(const std::vector<Near>& near) {
  std::vector<std::vector<Near>> columns;
  const auto nearest = [&](double on) {
    const auto closer = [&](const auto& m, const auto& n) { return std::abs(m.front().on - on) < std::abs(n.front().on - on); };
    return std::min_element(columns.begin(), columns.end(), closer);
  };
  for (const Near& n : near) {
    const auto column = nearest(n.on);
    if (n.beside && (column == columns.end() || std::abs(column->front().on - n.on) > 0.5 * n.side))
      columns.push_back({n});
  }
  std::sort(columns.begin(), columns.end(), [](const auto& m, const auto& n) { return m.front().on < n.front().on; });
  for (const Near& n : near) {
    auto& column = *nearest(n.on);
    if (column.front().particle != n.particle && n.off - column.back().off <= FaceLayer::gap * n.side) column.push_back(n);
  }
  return columns;
}

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

  const double most_depth = FaceLayer::cells * (std::abs(along.y()) * cell.x() + std::abs(along.x()) * cell.y());
  Vec2 normal;
  const auto columns = columns_of(points_under(key, a, along, length, most_depth, particles, normal));
  const double face = length / double(columns.size());
  for (const auto& column : columns) {
    const auto piece = std::uint32_t(pieces_.size());
    pieces_.push_back({.particle = column.front().particle,
                       .face = face,
                       .along = along,
                       .out = column.front().off * normal,
                       .traction = Vec2((*o.traction_pa)[0], (*o.traction_pa)[1]),
                       .follows = o.follows_face,
                       .rise = o.rise_s,
                       .until = o.until_s.value_or(std::numeric_limits<double>::infinity()),
                       .boundary = std::uint16_t(boundary),
                       .next = -1});
    // To the end of what is thinner.
    const FaceLayer layer{std::min(most_depth, column.back().off + 0.5 * column.back().side)};
    double slopes = 0, area = 0;
    for (const Near& n : column) {
      area += n.side * n.side;
      slopes += n.side * n.side * layer.fallen(n.off) * (1 - layer.fallen(n.off));
    }
    for (const Near& n : column) {
      const double s = layer.fallen(n.off);
      if (slopes > 0) layers.push_back({n.particle, {piece, FaceLayer::share(s), face * s * (1 - s) / slopes, face / area, normal}});
      else layers.push_back({n.particle, {piece, 0, face / area, face / area, normal}});  // of a single row: at its centre
    }
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
  std::vector<Vec2> traction(pieces_.size(), Vec2(0, 0));
  for (std::size_t k = 0; k < p.size(); ++k)
    for (std::int32_t a = over_[p.index[k]]; a >= 0; a = pieces_[std::size_t(a)].next) {
      const Traction& piece = pieces_[std::size_t(a)];
      if (p.cell[k] == Particles::ended) continue;  // its face has gone
      Vec2 t = piece.share(time) * piece.traction_now(gradient(k));
      double face = piece.face;
      if (g.axisymmetric) {  // of a radian; what follows its face acts on its present radius
        if (piece.follows) t *= p.F_zz[k];
        face *= p.x[k] / p.F_zz[k] + piece.out.x();
      }
      traction[std::size_t(a)] = t;
      of_boundaries[piece.boundary].add(dt * face * t, Vec2(p.x[k], p.y[k]) + gradient(k) * piece.out);
    }
  // In material that fails under its load the stress would grow with F: its column goes over to a body force.
  std::vector<double> stretch(pieces_.size(), 0.0);
  for (std::size_t k = 0; k < p.size(); ++k)
    for (const InLayer& l : layers(p.index[k]))
      if (p.cell[k] != Particles::ended) stretch[l.piece] = std::max(stretch[l.piece], gradient(k).squaredNorm());
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    const auto loaded = [&](std::uint32_t k) { return !layers(p.index[k]).empty(); };
    for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
      for_points<S>(p, g, range, loaded, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
        const Mat2 F = gradient(k);
        for (const InLayer& l : layers(p.index[k])) {
          const Vec2 t = p.volume0[k] * traction[l.piece], normal = F * l.normal;
          const double w = std::clamp((torn - stretch[l.piece]) / (torn - whole), 0.0, 1.0);
          // Axisymmetric: the divergence of f N has the term f N_r/r too.
          const double change = g.axisymmetric ? l.change + l.share * l.normal.x() * p.F_zz[k] / p.x[k] : l.change;
          const double body = w * change + (1 - w) * l.even;
          for (int c = 0; c < S::width * S::width; ++c) {
            const int i = c % S::width, j = c / S::width;
            const double across = normal.x() * g.per_hx * x.g[i] * y.w[j] + normal.y() * g.per_hy * x.w[i] * y.g[j];
            const double by = w * l.share * across + body * x.w[i] * y.w[j];
            g.arrays.loads[at[c]].x += by * t.x();
            g.arrays.loads[at[c]].y += by * t.y();
          }
        }
      });
    });
  });
}

}  // namespace pivnp::mpm

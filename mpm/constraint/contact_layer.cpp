#include "mpm/constraint/contact_layer.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/constraint/face_layer.hpp"
#include "mpm/grid/sweeps.hpp"

namespace pivnp::mpm {

namespace {

constexpr double least_depth = 1.2;   // cells of material that a layer needs
constexpr double least_area = 0.1;    // cells of a piece that have material under them: a sliver beside an edge would plough
constexpr double most_stretch2 = 6;   // |F|^2, beyond which material has flowed, and its points lie anyhow
constexpr double most_uneven = 0.15;  // of a layer's depth, by which its points may lie other than their volumes say

}  // namespace

void ContactLayer::begin(std::size_t pieces, int velocity_fields) {
  fields_ = velocity_fields;
  points_.clear();
  members_.resize(pieces * std::size_t(fields_));
  for (auto& m : members_) m.clear();
}

void ContactLayer::add(const Particles& p, const GridState& g, const Vec2& low, const Vec2& high, const Under& under) {
  const Vec2 h = g.grid.spacing, o = g.field_grid.origin;
  const auto cell = [&](double x, double origin, double side, int most) {
    return int(std::clamp(std::floor((x - origin) / side), 0.0, double(most)));
  };
  const double reach = FaceLayer::cells + 2;
  const int left = cell(low.x() - reach * h.x(), o.x(), h.x(), g.grid.nx - 2);
  const int right = cell(high.x() + reach * h.x(), o.x(), h.x(), g.grid.nx - 2);
  const int down = cell(low.y() - reach * h.y(), o.y(), h.y(), g.field_rows - 1);
  const int up = cell(high.y() + reach * h.y(), o.y(), h.y(), g.field_rows - 1);
  std::vector<UnderPiece> list;
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    for (int field = 0; field < g.velocity_fields; ++field)
      for (int j = field * g.field_rows + down; j <= field * g.field_rows + up; ++j) {
        const std::size_t from = g.cells.first_from(std::int32_t(g.grid.node(left, j)));
        const std::size_t to = g.cells.first_from(std::int32_t(g.grid.node(right, j)) + 1);
        for_points<S>(p, g, {from, to}, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
          const Mat2 F{{p.F_xx[k], p.F_xy[k]}, {p.F_yx[k], p.F_yy[k]}};
          list.clear();
          under({p.x[k], p.y[k]}, 0.5 * std::sqrt(p.area0(k)) * F, list);
          if (list.empty()) return;
          const double volume = p.volume0[k] * (F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0));
          for (const UnderPiece& u : list)
            members_[u.piece * std::size_t(fields_) + std::size_t(field)].push_back({points_.size(), u.share * volume, g.axisymmetric ? p.x[k] : 1.0, F.squaredNorm(), u});
          Point point;
          std::copy(at, at + S::width * S::width, point.node);
          for (int a = 0; a < S::width; ++a) {
            point.wx[a] = x.w[a];
            point.wy[a] = y.w[a];
            point.gx[a] = x.g[a] * g.per_hx;
            point.gy[a] = y.g[a] * g.per_hy;
          }
          points_.push_back(point);
        });
      }
  });
}

MaterialFace ContactLayer::face(const GridState& g, std::size_t piece, int field, std::vector<NodeShare>& nodes, bool held) {
  MaterialFace out;
  auto& members = members_[piece * std::size_t(fields_) + std::size_t(field)];
  if (members.empty()) return out;
  std::stable_sort(members.begin(), members.end(), [](const Member& m, const Member& n) { return m.at.depth < n.at.depth; });

  // Where the outermost points end: their mean, of others the less the deeper they lie.
  double outermost = members.front().at.depth - members.front().at.half, weight = 0, sum = 0;
  for (const Member& m : members) outermost = std::min(outermost, m.at.depth - m.at.half);
  for (const Member& m : members) {
    const double below = (m.at.depth - m.at.half - outermost) / (2 * m.at.half);
    if (below >= 1) continue;
    const double w = m.volume * (1 - below) * (1 - below);
    weight += w;
    sum += w * (m.at.depth - m.at.half);
  }
  out.gap = sum / weight;

  std::size_t size = 1;
  while (size < members.size() && members[size].at.depth - members[size - 1].at.depth <= FaceLayer::gap * 2 * members[size].at.half) ++size;
  members.resize(size);
  const Vec2 normal = members.front().at.normal.cwiseAbs();
  const double h = normal.dot(g.grid.spacing), end = members.back().at.depth + members.back().at.half - out.gap;
  out.state = MaterialFace::State::thin;
  const auto flowed = [](const Member& m) { return m.stretch2 > most_stretch2; };
  if (end < least_depth * h || (!held && std::any_of(members.begin(), members.end(), flowed))) return out;
  const FaceLayer layer{std::min(FaceLayer::cells * h, end)};  // to the end of what is thinner
  const auto fallen = [&](const Member& m) { return layer.fallen(m.at.depth - out.gap); };
  // Body forces that make up 1, and the stress whose end is where the points' volumes say.
  double area = 0, extent = 0, mean = 0, spread = 0, falling = 0;  // extent: of the area in the section, whatever its radius
  for (Member& m : members) {
    const double s = fallen(m);
    m.stress = m.volume * FaceLayer::share(s);
    m.body = m.volume * 6 * s * (1 - s) / (layer.depth - layer.upper);
    area += m.body;
    extent += m.body / m.radius;
    falling += m.volume * s * (1 - s);
  }
  if (!(area > 0) || !(falling > 0)) return out;
  if (extent < least_area * h) {
    out.state = MaterialFace::State::none;
    return out;
  }
  for (Member& m : members) {
    m.body /= area;
    m.stress /= area;
    mean += m.body * (m.at.depth - out.gap);
    out.along += m.body * m.at.along;
    spread += m.stress;
  }
  if (std::abs(mean - spread) > most_uneven * layer.depth) return out;
  // Linear fields are exact.
  for (Member& m : members) m.stress += (mean - spread) * m.volume * fallen(m) * (1 - fallen(m)) / falling;
  out.state = MaterialFace::State::found;
  out.area = area;

  place_.resize(g.grid.node_count(), -1);
  const std::size_t first = nodes.size();
  const int width = g.width;
  for (const Member& m : members) {
    if (m.body == 0 && m.stress == 0) continue;
    const Point& at = points_[m.point];
    for (int c = 0; c < g.stencil; ++c) {
      const int i = c % width, j = c / width;
      // e points into the material: the gradient along it is that towards the face with its sign changed.
      const double toward = m.at.normal.x() * at.gx[i] * at.wy[j] + m.at.normal.y() * at.wx[i] * at.gy[j];
      const double share = m.body * at.wx[i] * at.wy[j] - m.stress * toward;
      std::int32_t& place = place_[at.node[c]];
      if (place < 0) {
        place = std::int32_t(nodes.size() - first);
        nodes.push_back({std::uint32_t(at.node[c]), 0});
      }
      nodes[first + std::size_t(place)].share += share;
    }
  }
  for (std::size_t k = first; k < nodes.size(); ++k) place_[nodes[k].node] = -1;
  return out;
}

}  // namespace pivnp::mpm

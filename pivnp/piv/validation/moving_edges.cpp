#include "pivnp/piv/validation/moving_edges.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/dense/lattice_filter.hpp"

namespace pivnp::piv {

namespace {

struct Edges {
  std::vector<std::uint8_t> here;         // a point on an edge
  std::vector<float> normal_x, normal_y;  // unit vector across it
};

// Steps of the mean grey value from one side of a point to the other, both frames together.
Edges find_edges(const CellSums& sums) {
  constexpr int reach = 2;             // points to each side
  constexpr float step_share = 0.15f;  // difference over sum: one side is 1.35 times as bright as the other
  constexpr float usual = 4;  // and so many times what half of the image's points exceed: grains make steps too
  const CellLattice& lattice = sums.lattice;
  const std::size_t count = lattice.size();
  std::vector<float> f, g, usable, grey(count);
  binomial_mean(lattice, sums[CellSums::f], f);
  binomial_mean(lattice, sums[CellSums::g], g);
  binomial_mean(lattice, sums[CellSums::usable], usable);
  for (std::size_t k = 0; k < count; ++k) grey[k] = usable[k] > 0 ? (f[k] + g[k]) / usable[k] : 0.0f;
  Edges out{std::vector<std::uint8_t>(count), std::vector<float>(count), std::vector<float>(count)};
  std::vector<float> step(count), known;
  for (int j = reach; j + reach < lattice.ny; ++j)
    for (int i = reach; i + reach < lattice.nx; ++i) {
      const float left = grey[lattice.index(i - reach, j)], right = grey[lattice.index(i + reach, j)];
      const float above = grey[lattice.index(i, j - reach)], below = grey[lattice.index(i, j + reach)];
      if (!(std::min({left, right, above, below}) > 0)) continue;  // masked
      const float x = (right - left) / (right + left), y = (below - above) / (below + above), size = std::hypot(x, y);
      if (!std::isfinite(size)) continue;
      known.push_back(size);
      if (!(size > 0)) continue;
      const std::size_t k = lattice.index(i, j);
      step[k] = size, out.normal_x[k] = x / size, out.normal_y[k] = y / size;
    }
  if (known.empty()) return out;
  const auto middle = known.begin() + std::ptrdiff_t(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  for (std::size_t k = 0; k < count; ++k) out.here[k] = step[k] > std::max(step_share, usual * *middle);
  return out;
}

// Distance of (u, v) from the segment between both sides' displacements.
float departure(float u, float v, float u0, float v0, float u1, float v1) {
  const float du = u1 - u0, dv = v1 - v0, square = du * du + dv * dv;
  const float t = square > 0 ? std::clamp(((u - u0) * du + (v - v0) * dv) / square, 0.0f, 1.0f) : 0.0f;
  return std::hypot(u - u0 - t * du, v - v0 - t * dv);
}

}  // namespace

void reject_moving_edges(const CellSums& sums, const std::vector<float>& u, const std::vector<float>& v, float most_px,
                         std::vector<std::uint8_t>& good) {
  constexpr int reach = 4;     // points: so far from an edge its window and the smoothing carry its motion
  constexpr float beyond = 4;  // and so far from there lie the sides
  const CellLattice& lattice = sums.lattice;
  const Edges edges = find_edges(sums);
  const std::vector<std::uint8_t> trusted = good;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      if (!edges.here[k]) continue;
      const float nx = edges.normal_x[k], ny = edges.normal_y[k];
      // Along the edge's normal, from one side to the other.
      const auto place = [&](float along, std::size_t& at) {
        const int x = i + static_cast<int>(std::lround(along * nx)), y = j + static_cast<int>(std::lround(along * ny));
        if (x < 0 || y < 0 || x >= lattice.nx || y >= lattice.ny) return false;
        at = lattice.index(x, y);
        return true;
      };
      std::size_t one = 0, other = 0, at = 0;
      if (!place(-reach - beyond, one) || !place(reach + beyond, other) || !trusted[one] || !trusted[other]) continue;
      const float across = std::hypot(u[other] - u[one], v[other] - v[one]);
      for (int step = -reach; step <= reach; ++step)
        if (place(static_cast<float>(step), at) &&
            departure(u[at], v[at], u[one], v[one], u[other], v[other]) > std::max(most_px, across))
          good[at] = 0;
    }
}

}  // namespace pivnp::piv

#include "pivnp/piv/sampling/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::piv {

bool switched_on(const NodeLattice& nodes, std::size_t k) { return nodes.on.empty() || nodes.on[k] != 0; }

Box bounding_box(const NodeLattice& nodes, float margin, int width, int height) {
  float x0 = std::numeric_limits<float>::max(), y0 = x0, x1 = -x0, y1 = -x0;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (!switched_on(nodes, k)) continue;
    const auto [x, y] = nodes.pixel[k];
    if (!(x >= 0 && x <= static_cast<float>(width - 1) && y >= 0 && y <= static_cast<float>(height - 1))) continue;
    x0 = std::min(x0, x), x1 = std::max(x1, x);
    y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  if (x1 < x0) return {};
  Box box;
  box.x0 = std::max(0, static_cast<int>(std::floor(x0 - margin)));
  box.y0 = std::max(0, static_cast<int>(std::floor(y0 - margin)));
  box.x1 = std::min(width, static_cast<int>(std::ceil(x1 + margin)) + 1);
  box.y1 = std::min(height, static_cast<int>(std::ceil(y1 + margin)) + 1);
  return box;
}

float node_spacing(const NodeLattice& nodes) {
  const auto mean_step = [&](int count_along, int count_across, std::size_t along, std::size_t across) {
    if (count_along < 2) return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (int b = 0; b < count_across; ++b)
      for (int a = 0; a + 1 < count_along; ++a) {
        const auto& p = nodes.pixel[std::size_t(b) * across + std::size_t(a) * along];
        const auto& q = nodes.pixel[std::size_t(b) * across + std::size_t(a + 1) * along];
        sum += std::hypot(q[0] - p[0], q[1] - p[1]);
      }
    return sum / (double(count_along - 1) * count_across);
  };
  const auto nx = static_cast<std::size_t>(nodes.nx);
  const double step = std::min(mean_step(nodes.nx, nodes.ny, 1, nx), mean_step(nodes.ny, nodes.nx, nx, 1));
  return std::isfinite(step) ? static_cast<float>(step) : 0.0f;
}

EvenLattice even_lattice(const Box& box, float spacing) {
  EvenLattice lattice;
  lattice.nx = std::max(1, static_cast<int>(std::lround(static_cast<float>(box.width()) / spacing)));
  lattice.ny = std::max(1, static_cast<int>(std::lround(static_cast<float>(box.height()) / spacing)));
  lattice.dx = static_cast<float>(box.width()) / static_cast<float>(lattice.nx);
  lattice.dy = static_cast<float>(box.height()) / static_cast<float>(lattice.ny);
  lattice.x0 = static_cast<float>(box.x0) - 0.5f + 0.5f * lattice.dx;
  lattice.y0 = static_cast<float>(box.y0) - 0.5f + 0.5f * lattice.dy;
  return lattice;
}

NodeLattice nodes_near(const EvenLattice& lattice, const NodeLattice& nodes, float reach) {
  NodeLattice points;
  points.nx = lattice.nx;
  points.ny = lattice.ny;
  const std::size_t count = std::size_t(lattice.nx) * std::size_t(lattice.ny);
  points.pixel.resize(count);
  points.on.assign(count, 0);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i)
      points.pixel[std::size_t(j) * std::size_t(lattice.nx) + std::size_t(i)] = {
          lattice.x0 + static_cast<float>(i) * lattice.dx, lattice.y0 + static_cast<float>(j) * lattice.dy};
  const auto first = [](float from, float step, int n) {
    return static_cast<int>(std::clamp(std::ceil(from / step), 0.0f, static_cast<float>(n)));
  };
  const auto last = [](float to, float step, int n) {
    return static_cast<int>(std::clamp(std::floor(to / step), -1.0f, static_cast<float>(n - 1)));
  };
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (!switched_on(nodes, k)) continue;
    const float x = nodes.pixel[k][0] - lattice.x0, y = nodes.pixel[k][1] - lattice.y0;
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    for (int j = first(y - reach, lattice.dy, lattice.ny); j <= last(y + reach, lattice.dy, lattice.ny); ++j)
      for (int i = first(x - reach, lattice.dx, lattice.nx); i <= last(x + reach, lattice.dx, lattice.nx); ++i)
        points.on[std::size_t(j) * std::size_t(lattice.nx) + std::size_t(i)] = 1;
  }
  return points;
}

}  // namespace pivnp::piv

#include "mpm/averages.hpp"

#include <algorithm>

namespace pivnp::mpm {

namespace {

constexpr std::size_t n_fields = 15;

}  // namespace

// Beyond the grid a row and one more are read before it, two rows and some after.
Averages::Averages(const Grid& nodes) : row_(nodes.nx), edges_(0), corners_(0) {
  const std::size_t size = nodes.node_count() + 3 * std::size_t(nodes.nx) + 8;
  edges_ = OfGrid<EdgeSums>(size);
  corners_ = OfGrid<CornerSums>(size);
  for (std::size_t f = 0; f < n_fields; ++f) fields_.emplace_back(size);
}

AverageArrays Averages::arrays() {
  const std::size_t first = std::size_t(row_) + 1;
  double* f[n_fields];
  for (std::size_t k = 0; k < n_fields; ++k) f[k] = fields_[k].data() + first;
  return {edges_.data() + first, corners_.data() + first, f[0], f[1], f[2],  f[3],  f[4],  f[5],  f[6],
          f[7],                  f[8],                    f[9], f[10], f[11], f[12], f[13], f[14], row_};
}

AverageView Averages::view() {
  const AverageArrays a = arrays();
  return {a.edges, a.corners, a.mean};
}

void Averages::forget(const std::vector<std::uint32_t>& before, const std::vector<std::uint32_t>& now) {
  const AverageArrays a = arrays();
  auto next = now.begin();
  for (const std::uint32_t n : before) {
    while (next != now.end() && *next < n) ++next;
    if (next != now.end() && *next == n) continue;
    a.edges[n] = {};
    a.corners[n] = {};
    for (auto& field : fields_) field[n + std::size_t(row_) + 1] = 0;
  }
}

}  // namespace pivnp::mpm

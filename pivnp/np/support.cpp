#include "pivnp/np/support.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pivnp::np {

namespace {

// Not worth waking threads for.
constexpr std::size_t few_nodes = 20000, few_fits = 500;

// The usable ones of the 4 x 4 nodes of an element and its ring, as LocalFit wants them.
struct Neighbourhood {
  std::uint16_t nodes = 0;
  std::array<std::array<double, 2>, 16> values{};
};

template <class Real>
Neighbourhood usable_around(const Nodes<Real>& nodes, const std::vector<std::uint8_t>& node_class,
                            std::size_t element) {
  const Grid& grid = nodes.grid;
  const int i = int(element % std::size_t(grid.nx - 1)), j = int(element / std::size_t(grid.nx - 1));
  Neighbourhood found;
  for (int k = 0; k < 16; ++k) {
    const int a = i - 1 + k % 4, b = j - 1 + k / 4;
    if (a < 0 || b < 0 || a >= grid.nx || b >= grid.ny || node_class[grid.node(a, b)] > 1) continue;
    found.nodes = std::uint16_t(found.nodes | 1u << k);
    const auto& d = nodes.displacement[grid.node(a, b)];
    found.values[std::size_t(k)] = {double(d[0]), double(d[1])};
  }
  return found;
}

}  // namespace

template <class Real>
void SupportMap::build(const Nodes<Real>& nodes) {
  const Grid& grid = nodes.grid;
  node_class_.resize(grid.node_count());
#pragma omp parallel for schedule(static) if (grid.node_count() > few_nodes)
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(grid.node_count()); ++n) {
    const auto& d = nodes.displacement[n];
    const VectorStatus s = nodes.status[n];
    const bool good = usable(s) && std::isfinite(d[0]) && std::isfinite(d[1]);
    node_class_[std::size_t(n)] = !good ? 2 : s == VectorStatus::replaced ? 1 : 0;
  }

  support_.resize(grid.element_count());
  fitted_elements_.clear();
  std::size_t element = 0;
  for (int j = 0; j + 1 < grid.ny; ++j)
    for (int i = 0; i + 1 < grid.nx; ++i, ++element) {
      const std::uint8_t* below = &node_class_[grid.node(i, j)];
      const std::uint8_t* above = below + grid.nx;
      const std::uint8_t worst = std::max(std::max(below[0], below[1]), std::max(above[0], above[1]));
      support_[element] = static_cast<Support>(worst);
      if (worst > 1) fitted_elements_.push_back(element);
    }

  fits_.resize(fitted_elements_.size());
#pragma omp parallel for schedule(static) if (fits_.size() > few_fits)
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(fits_.size()); ++n) {
    const std::size_t at = fitted_elements_[std::size_t(n)];
    const Neighbourhood around = usable_around(nodes, node_class_, at);
    const auto fit = LocalFit::of(around.nodes, around.values);
    support_[at] = fit ? Support::fitted : Support::none;
    if (fit) fits_[std::size_t(n)] = *fit;
  }
}

const LocalFit& SupportMap::fit(std::size_t element) const {
  const auto found = std::lower_bound(fitted_elements_.begin(), fitted_elements_.end(), element);
  assert(found != fitted_elements_.end() && *found == element);
  return fits_[std::size_t(found - fitted_elements_.begin())];
}

template void SupportMap::build(const Nodes<float>&);
template void SupportMap::build(const Nodes<double>&);

}  // namespace pivnp::np

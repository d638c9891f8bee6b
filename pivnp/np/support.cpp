#include "pivnp/np/support.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

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

namespace {

// The mean of what the fits of the (up to four) elements around a lost node say there; false if there is none.
bool fitted_value(const Grid& grid, const SupportMap& support, std::size_t node, std::array<double, 2>& value) {
  const int i = int(node % std::size_t(grid.nx)), j = int(node / std::size_t(grid.nx));
  Vec2 sum = Vec2::Zero();
  int count = 0;
  for (int b = std::max(j - 1, 0); b <= std::min(j, grid.ny - 2); ++b)
    for (int a = std::max(i - 1, 0); a <= std::min(i, grid.nx - 2); ++a) {
      const std::size_t element = grid.element(a, b);
      if (support.at(element) != Support::fitted) continue;
      const LocalFit& fit = support.fit(element);
      sum += fit.value + fit.slope * (Vec2(i - a, j - b) - fit.centroid);
      ++count;
    }
  if (count > 0) value = {sum.x() / count, sum.y() / count};
  return count > 0;
}

}  // namespace

void fill_gaps(const Grid& grid, const SupportMap& support, std::vector<std::array<double, 2>>& values) {
  std::vector<std::uint8_t> filled(values.size());
  std::vector<std::size_t> open;
  for (std::size_t n = 0; n < values.size(); ++n) {
    filled[n] = support.node_class(n) < 2;
    if (!filled[n] && !fitted_value(grid, support, n, values[n])) open.push_back(n);
  }
  for (std::size_t n = 0; n < values.size(); ++n) filled[n] = 1;
  for (const std::size_t n : open) filled[n] = 0;
  while (!open.empty()) {
    std::vector<std::size_t> reached, rest;
    for (const std::size_t n : open) {
      const int i = int(n % std::size_t(grid.nx)), j = int(n / std::size_t(grid.nx));
      std::array<double, 2> sum{0, 0};
      int count = 0;
      for (int b = std::max(j - 1, 0); b <= std::min(j + 1, grid.ny - 1); ++b)
        for (int a = std::max(i - 1, 0); a <= std::min(i + 1, grid.nx - 1); ++a) {
          const std::size_t m = grid.node(a, b);
          if (!filled[m]) continue;
          ++count;
          for (std::size_t q = 0; q < 2; ++q) sum[q] += values[m][q];
        }
      if (count == 0) {
        rest.push_back(n);
        continue;
      }
      for (std::size_t q = 0; q < 2; ++q) values[n][q] = sum[q] / count;
      reached.push_back(n);
    }
    for (const std::size_t n : reached) filled[n] = 1;
    if (reached.empty()) {  // no usable node at all
      for (const std::size_t n : rest) values[n] = {0, 0};
      return;
    }
    open = std::move(rest);
  }
}

template void SupportMap::build(const Nodes<float>&);
template void SupportMap::build(const Nodes<double>&);

}  // namespace pivnp::np

#include "mpm/particles.hpp"

#include <algorithm>
#include <numeric>

namespace pivnp::mpm {

std::vector<std::vector<double>*> Particles::state() {
  return {&x,      &y,      &vx,     &vy,     &mass,        &volume0, &F_xx,       &F_xy, &F_yx, &F_yy, &J,   &tau_xx,
          &tau_yy, &tau_zz, &tau_xy, &plastic_dev, &gap, &dissipated, &C_xx, &C_xy, &C_yx, &C_yy, &half};
}

void Particles::resize(std::size_t n, bool affine, bool sized) {
  for (auto* array : state()) array->assign(n, 0.0);
  if (!affine)
    for (auto* array : {&C_xx, &C_xy, &C_yx, &C_yy}) array->clear();
  if (!sized) half.clear();
  for (auto* array : {&xi, &eta, &de_xx, &de_yy, &de_zz, &de_xy, &spin, &G_xx, &G_xy, &G_yx, &G_yy, &mean})
    array->assign(n, 0.0);
  opened.assign(n, 0);
  cell.assign(n, ended);
  index.assign(n, 0);
}

void Particles::sort_by_cell() {
  std::vector<std::uint32_t> order(size());
  std::iota(order.begin(), order.end(), 0u);
  for (const Body& body : bodies)
    std::stable_sort(order.begin() + std::ptrdiff_t(body.begin), order.begin() + std::ptrdiff_t(body.end),
                     [&](std::uint32_t a, std::uint32_t b) {
                       // As unsigned numbers, ended points (-1) come last.
                       return std::uint32_t(cell[a]) < std::uint32_t(cell[b]);
                     });
  const auto permute = [&](auto& array) {
    if (array.empty()) return;
    auto sorted = array;
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = array[order[k]];
    array.swap(sorted);
  };
  for (auto* array : state()) permute(*array);
  permute(xi);
  permute(eta);
  permute(opened);
  permute(cell);
  permute(index);
}

}  // namespace pivnp::mpm

#include "mpm/state/particles.hpp"

#include <algorithm>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pivnp::mpm {

void ask_for_large_pages([[maybe_unused]] void* start, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  constexpr std::size_t large = std::size_t{2} << 20;
  const auto from = (reinterpret_cast<std::uintptr_t>(start) + large - 1) / large * large;
  const auto to = (reinterpret_cast<std::uintptr_t>(start) + bytes) / large * large;
  if (to > from) madvise(reinterpret_cast<void*>(from), to - from, MADV_HUGEPAGE);  // advice: a refusal changes nothing
#endif
}

std::vector<Array*> Particles::state() {
  return {&x,      &y,      &vx,     &vy,     &mass,        &volume0, &F_xx,       &F_xy, &F_yx, &F_yy, &J,   &tau_xx,
          &tau_yy, &tau_zz, &tau_xy, &plastic_dev, &gap, &dissipated, &C_xx, &C_xy, &C_yx, &C_yy, &carried_x, &carried_y, &half};
}

void Particles::resize(std::size_t n, bool several, bool affine, bool sized, bool tied, bool kept) {
  for (auto* array : state()) {
    const bool of_apic = array == &C_xx || array == &C_xy || array == &C_yx || array == &C_yy;
    const bool of_ties = array == &carried_x || array == &carried_y;
    const bool used = of_apic ? affine : of_ties ? tied : array == &half ? sized : array == &mass ? several : true;
    *array = Array(used ? n : 0, 0.0);  // (emptied ones would keep their memory)
  }
  for (auto* array : {&xi, &eta}) *array = Array(kept ? n : 0, 0.0);
  opened.assign(n, 0);
  cell.assign(n, ended);
  index.assign(n, 0);
}

void Particles::resize_increments(std::size_t n) {
  for (auto* array : {&de_xx, &de_yy, &de_zz, &de_xy, &spin}) {
    array->assign(n, 0.0);
    array->shrink_to_fit();
  }
}

PointView Particles::view() const {
  const auto at = [](const Array& a) { return a.empty() ? nullptr : const_cast<double*>(a.data()); };
  return {at(x),      at(y),      at(vx),     at(vy),    at(mass),  at(volume0), at(F_xx),  at(F_xy),  at(F_yx), at(F_yy),
          at(J),      at(tau_xx), at(tau_yy), at(tau_zz), at(tau_xy), at(C_xx),   at(C_xy),  at(C_yx),  at(C_yy), at(half),
          at(xi),     at(eta),    at(gap), density};
}

void Particles::sort_as(std::vector<std::uint32_t>& order, int threads) {
  std::vector<std::uint32_t> from(size());  // the old place of each new one
  std::uint32_t* next = from.data();
  for (const Body& body : bodies) {
    if (bodies.size() == 1) {
      next = std::copy(order.begin(), order.end(), next);
    } else {
      for (const std::uint32_t k : order)
        if (k >= body.begin && k < body.end) *next++ = k;
    }
    for (std::size_t k = body.begin; k < body.end; ++k)
      if (cell[k] == ended) *next++ = std::uint32_t(k);
  }
  const auto permute = [&](auto& array, auto& room) {
    if (array.empty()) return;
    const auto n = std::ptrdiff_t(from.size());
    room.resize(from.size());
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
    for (std::ptrdiff_t k = 0; k < n; ++k) room[std::size_t(k)] = array[from[std::size_t(k)]];
    array.swap(room);
  };
  Array of_state;
  for (auto* array : state()) permute(*array, of_state);
  std::vector<std::uint8_t> of_opened;
  std::vector<std::int32_t> of_cell;
  std::vector<std::uint32_t> of_index;
  permute(opened, of_opened);
  permute(cell, of_cell);
  permute(index, of_index);
  std::vector<std::uint32_t>& to = of_index;
  to.resize(from.size());
  for (std::uint32_t k = 0; k < from.size(); ++k) to[from[k]] = k;
  for (std::uint32_t& k : order) k = to[k];
}

}  // namespace pivnp::mpm

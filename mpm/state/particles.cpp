#include "mpm/state/particles.hpp"

#include <algorithm>
#include <type_traits>

#include "mpm/state/particle_fields.hpp"

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

namespace {

// Calls each(field, values) for the arrays of all components.
template <class Particles_, class Each>
void for_each_array(Particles_& p, Each&& each) {
  for_each_particle_field([&](const ParticleField& field, const auto&... column) { (each(field, p.*column.values), ...); });
}

}  // namespace

std::vector<Array*> Particles::state() {
  std::vector<Array*> arrays;
  for_each_array(*this, [&]<class T>(const ParticleField& field, T& values) {
    if constexpr (std::is_same_v<T, Array>)
      if (field.state) arrays.push_back(&values);
  });
  for (Array& values : history.numbers) arrays.push_back(&values);
  return arrays;
}

void Particles::resize(std::size_t n, const ParticleNeeds& needs) {
  for_each_array(*this, [&]<class T>(const ParticleField& field, T& values) {
    values = T(!field.need || needs.*field.need ? n : 0, typename T::value_type{});  // (emptied ones would keep their memory)
  });
  std::fill(cell.begin(), cell.end(), ended);
}

void Particles::resize_increments(std::size_t n) {
  for_each_array(*this, [&]<class T>(const ParticleField& field, T& values) {
    if (field.need == &ParticleNeeds::increments) values = T(n, typename T::value_type{});
  });
}

PointView Particles::view() const {
  PointView seen{};
  for_each_particle_field([&](const ParticleField&, const auto&... column) {
    const auto look = [&]<class T>(const Column<T>& c) {
      if constexpr (std::is_same_v<T, Array>)
        if (c.kernels && !(this->*c.values).empty()) seen.*c.kernels = const_cast<double*>((this->*c.values).data());
    };
    (look(column), ...);
  });
  if (const Array* opening = history.find(opening_strain.name)) seen.opening = const_cast<double*>(opening->data());
  seen.density = density;
  seen.outside = outside;
  seen.level = level;
  return seen;
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
  Array of_numbers;
  Flags of_flags;
  std::vector<std::int32_t> of_cell;
  std::vector<std::uint32_t> of_index;
  const auto room_of = [&]<class T>(const T&) -> T& {
    if constexpr (std::is_same_v<T, Array>) return of_numbers;
    else if constexpr (std::is_same_v<T, std::vector<std::int32_t>>) return of_cell;
    else return of_index;
  };
  for_each_array(*this, [&](const ParticleField& field, auto& values) {
    if (field.state) permute(values, room_of(values));
  });
  for (Array& values : history.numbers) permute(values, of_numbers);
  for (Flags& values : history.flags) permute(values, of_flags);
  std::vector<std::uint32_t>& to = of_index;
  to.resize(from.size());
  for (std::uint32_t k = 0; k < from.size(); ++k) to[from[k]] = k;
  for (std::uint32_t& k : order) k = to[k];
}

StressBatch batch_of(Particles& p, const Particles::Body& body, std::size_t begin, std::size_t size) {
  StressBatch b;
  b.size = size;
  for_each_particle_field([&](const ParticleField&, const auto&... column) {
    const auto look = [&]<class T>(const Column<T>& c) {
      if constexpr (std::is_same_v<T, Array>) {
        if (!c.laws && !c.laws_read) return;
        double* first = (p.*c.values).empty() ? nullptr : (p.*c.values).data() + begin;
        if (c.laws) b.*c.laws = first;
        else b.*c.laws_read = first;
      }
    };
    (look(column), ...);
  });
  for (std::size_t k = 0; k < body.history.numbers.size(); ++k) b.history[k] = p.history.numbers[body.history.numbers[k]].data() + begin;
  for (std::size_t k = 0; k < body.history.flags.size(); ++k) b.flags[k] = p.history.flags[body.history.flags[k]].data() + begin;
  return b;
}

StressBatch StressBatch::part(std::size_t begin, std::size_t n) const {
  StressBatch b = *this;
  b.size = n;
  b.move_increments(begin);
  if (places) b.places += begin;
  else b.move_state(begin);
  return b;
}

StressBatch StressBatch::point(std::size_t k) const {
  StressBatch b = *this;
  b.size = 1;
  b.places = nullptr;
  b.move_increments(k);
  b.move_state(places ? places[k] : k);
  return b;
}

// The increments, or all else that laws see.
template <bool increments>
void StressBatch::move(std::size_t by) {
  for_each_particle_field([&](const ParticleField& field, const auto&... column) {
    if ((field.need == &ParticleNeeds::increments) != increments) return;
    const auto move_by = [&]<class T>(const Column<T>& c) {
      if (c.laws && this->*c.laws) this->*c.laws += by;
      if (c.laws_read && this->*c.laws_read) this->*c.laws_read += by;
    };
    (move_by(column), ...);
  });
}

void StressBatch::move_increments(std::size_t by) { move<true>(by); }

void StressBatch::move_state(std::size_t by) {
  move<false>(by);
  for (double*& values : history) {
    if (!values) break;
    values += by;
  }
  for (std::uint8_t*& values : flags) {
    if (!values) break;
    values += by;
  }
}

}  // namespace pivnp::mpm

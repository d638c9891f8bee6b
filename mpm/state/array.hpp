// One number a point.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace pivnp::mpm {

/// Many arrays are streamed at once: with the system's small pages, large ones would outrun the tables of addresses.
void ask_for_large_pages(void* start, std::size_t bytes);

/// Memory that starts somewhere else in its page each time: arrays of equal length that all start a page would share the
/// same few places in the caches.
template <class T>
struct Staggered {
  using value_type = T;
  Staggered() = default;
  template <class U>
  Staggered(const Staggered<U>&) {}
  T* allocate(std::size_t n) {
    static std::atomic<std::size_t> count{0};
    const std::size_t lead = line * (1 + 11 * count++ % (page / line - 1));
    auto* start = static_cast<std::byte*>(::operator new(lead + n * sizeof(T), std::align_val_t{page}));
    ask_for_large_pages(start, lead + n * sizeof(T));
    *reinterpret_cast<std::size_t*>(start + lead - sizeof(std::size_t)) = lead;
    return reinterpret_cast<T*>(start + lead);
  }
  void deallocate(T* p, std::size_t) {
    auto* at = reinterpret_cast<std::byte*>(p);
    ::operator delete(at - *reinterpret_cast<std::size_t*>(at - sizeof(std::size_t)), std::align_val_t{page});
  }
  bool operator==(const Staggered&) const { return true; }

 private:
  static constexpr std::size_t line = 64, page = 4096;
};
using Array = std::vector<double, Staggered<double>>;
using Flags = std::vector<std::uint8_t>;

}  // namespace pivnp::mpm

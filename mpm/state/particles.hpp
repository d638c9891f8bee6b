// Material points as a structure of arrays.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#include "mpm/state/views.hpp"
#include "pivnp/core/grid/grid.hpp"

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

/// Points lie body after body (so that a material is called on a run of them), inside a body in the order of the last
/// re-sort by cell. `index` leads back to the ParticleSet. SI units. Arrays that a scheme does not use are empty.
struct Particles {
  struct Body {
    std::size_t begin = 0, end = 0;
    int material = 0;
  };
  static constexpr std::int32_t ended = -1;  // as `cell`: no longer simulated

  // State.
  Array x, y, vx, vy;
  Array volume0;                 // m^2
  Array mass;                    // kg/m; one body needs none, see mass_of()
  double density = 0;            // of one body, kg/m^3
  Array F_xx, F_xy, F_yx, F_yy;  // deformation gradient, of the point's own velocity gradient
  Array J;                       // volume ratio, of the averaged volumetric strain
  Array tau_xx, tau_yy, tau_zz, tau_xy;  // Kirchhoff stress, Pa
  Array plastic_dev, gap, dissipated;
  Array C_xx, C_xy, C_yx, C_yy;  // affine velocity field (APIC), 1/s
  Array carried_x, carried_y;    // by how much a tied side has set the point back (boundary.hpp), m
  Array half;                    // half side over the cell's (uGIMP)
  std::vector<std::uint8_t> opened;
  std::vector<std::int32_t> cell;    // index of the lower left node of the stencil, or `ended`
  std::vector<std::uint32_t> index;  // place in the ParticleSet

  // Of one step.
  Array xi, eta;                           // natural coordinates before the points moved (Where::kept)
  Array de_xx, de_yy, de_zz, de_xy, spin;  // increments, where strain and stress are apart (transfer.hpp)
  Array softened_by;                       // non-local plastic strain (material/nonlocal.hpp)

  std::vector<Body> bodies;

  std::size_t size() const { return x.size(); }
  double mass_of(std::size_t k) const { return mass.empty() ? density * volume0[k] : mass[k]; }
  /// All arrays of real state at `n` zeros; those of several bodies, APIC, uGIMP, tied sides and
  /// Where::kept where asked for.
  void resize(std::size_t n, bool several, bool affine, bool sized, bool tied = false, bool kept = true);
  /// Displacement of a point that started at x0.
  Vec2 displacement(std::size_t k, const Vec2& x0) const {
    const Vec2 d = Vec2(x[k], y[k]) - x0;
    return carried_x.empty() ? d : Vec2(d.x() - carried_x[k], d.y() - carried_y[k]);
  }
  /// As the kernels see them; a const object's are only read.
  PointView view() const;
  /// The increments at `n` zeros.
  void resize_increments(std::size_t n);
  /// Every array of real state, for copying, sorting and saving; some may be empty.
  std::vector<Array*> state();
  /// Puts the points of each body in the order in which they come in `order`, ended ones last, and has `order` tell
  /// where they are now.
  void sort_as(std::vector<std::uint32_t>& order, int threads);
};

}  // namespace pivnp::mpm

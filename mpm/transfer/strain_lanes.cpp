// A.12: log strain and rotation of the step at the points, and the averages against locking.
#include "mpm/transfer/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/transfer/strain_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/transfer/strain-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

void average_strain_slots(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          SlotRange slots) {
  with_lanes(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (S::W == 3)
      for_tiles(c, slots, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
        const auto l = lines_of<S>(p, c, cells, t, where, dt);
        add_to_averages(c, cells, volumes, l.xi, l.eta, joined_volume(p, t), dilation(t, l, c, cells, dt * c.per_hx, dt * c.per_hy));
      });
  });
}

std::size_t strain_slots(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, SlotRange slots,
                         const Increments& out, std::uint32_t* suspects) {
  return with_lanes(shape, [&](auto kind) HWY_ATTR {
    return Straining<decltype(kind)>{job, p, c, out, c.slot_begin[slots.begin]}.run(slots, suspects);
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(average_strain_slots);
HWY_EXPORT(strain_slots);

void average_strain_lanes(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          SlotRange slots) {
  HWY_DYNAMIC_DISPATCH(average_strain_slots)(shape, where, dt, volumes, p, c, slots);
}
std::size_t strain_lanes(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, SlotRange slots,
                         const Increments& out, std::uint32_t* suspects) {
  return HWY_DYNAMIC_DISPATCH(strain_slots)(shape, job, p, c, slots, out, suspects);
}

}  // namespace pivnp::mpm
#endif

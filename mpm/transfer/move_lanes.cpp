// From the nodes to the points: A.8-A.11, and the updated momentum back to the nodes (MUSL).
#include "mpm/transfer/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/transfer/move_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/transfer/move-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

template <class S, TransferKind transfer>
GatherSums move_all(const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  Moving<S, transfer> move{job, p, c};
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE { move.tile(t, cells); });
  return sums_of(move.fastest2, move.loss, move.good);
}

GatherSums move_range(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  return Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    switch (job.transfer) {
      case TransferKind::apic: return move_all<S, TransferKind::apic>(job, p, c, range);
      case TransferKind::aflip: return move_all<S, TransferKind::aflip>(job, p, c, range);
      case TransferKind::xpic: return move_all<S, TransferKind::xpic>(job, p, c, range);
      case TransferKind::flip: break;
    }
    return move_all<S, TransferKind::flip>(job, p, c, range);
  });
}

const char* target_name() { return lanes_name(); }

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(move_range);
HWY_EXPORT(target_name);

GatherSums move_lanes(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  return HWY_DYNAMIC_DISPATCH(move_range)(shape, job, p, c, range);
}
const char* simd_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace pivnp::mpm
#endif

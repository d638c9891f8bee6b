#include "mpm/state/scheme_rows.hpp"

namespace pivnp::mpm {

Registry<ShapeRow>& shapes() {
  static Registry<ShapeRow> rows = [] {
    Registry<ShapeRow> compiled;
    for (const ShapeRow& row : shape_rows) compiled.add(row);
    return compiled;
  }();
  return rows;
}

Registry<TransferRow>& transfers() {
  static Registry<TransferRow> rows = {
      {{{"flip", TransferKind::flip}, "points take the nodes' change of velocity"}, false, true},
      {{{"apic", TransferKind::apic}, "points take the nodes' velocity and its affine part"}, true},
      {{{"aflip", TransferKind::aflip}, "points take the nodes' change of velocity, and the affine part of their velocity"}, true, true},
      {{{"xpic", TransferKind::xpic}, "points take the nodes' velocity, filtered to an order"}}};
  return rows;
}

Registry<LockingRow>& lockings() {
  static Registry<LockingRow> rows = {
      {{{"none", Locking::none}, "stress and strain of every point as they are"}},
      {{{"selective", Locking::selective}, "volume and mean stress at the elements' centres"}, true},
      {{{"full", Locking::full}, "all strain and stress at the elements' centres"}, true},
      {{{"fbar", Locking::fbar}, "volume and mean stress averaged over points"}}};
  return rows;
}

}  // namespace pivnp::mpm

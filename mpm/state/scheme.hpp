// The numerical choices of a run.
#pragma once

namespace pivnp::mpm {

enum class ShapeKind { bilinear, gimp, bspline };
enum class TransferKind { flip, apic, aflip, xpic };
enum class StressUpdate { musl, usl, usf };
enum class Locking { none, selective, full, fbar };

/// What the options say, defaults of the named scheme filled in (scene_setup.hpp).
struct Scheme {
  ShapeKind shape = ShapeKind::bspline;
  TransferKind transfer = TransferKind::aflip;
  StressUpdate stress = StressUpdate::usl;
  Locking locking = Locking::fbar;
  double pic_per_s = 0;  // of FLIP and AFLIP: share 1 - exp(-rate dt) of PIC a step
  int xpic_order = 5;    // of XPIC
  double damping = 0;    // Cundall's local damping
  bool axisymmetric = false;  // x is the radius, y the axis; volumes, masses and forces are those of a radian

  /// Points carry an affine velocity field, that of the updated velocity.
  bool affine() const { return transfer == TransferKind::apic || transfer == TransferKind::aflip; }
  /// The updated velocity gives the affine field and the strain: one sweep can do both.
  bool strains_as_it_moves() const { return stress == StressUpdate::usl && affine(); }
  /// The points' velocity is the updated one of the nodes: where they were before they moved is known from it.
  bool takes_updated() const { return stress == StressUpdate::usl && transfer == TransferKind::apic; }
};

}  // namespace pivnp::mpm

// The numerical choices, one row each: the name in a case, what it is, what it needs or allows. The kernels are compiled
// for the values of the enums, so the lists are closed; nothing else lists them.
#pragma once

#include <array>
#include <string_view>

#include "mpm/state/scheme.hpp"
#include "pivnp/core/choice.hpp"

namespace pivnp::mpm {

struct ShapeRow : NamedValue<ShapeKind> {
  std::string_view text;
  int nodes;           // of a point, along an axis
  bool sized = false;  // points have a size of their own (Particles::half)

  /// Its cells are the squares around nodes; else elements between nodes.
  constexpr bool centred() const { return nodes % 2 == 1; }
};
inline constexpr std::array shape_rows{
    ShapeRow{{"bilinear", ShapeKind::bilinear}, "the element's bilinear functions", 2},
    ShapeRow{{"gimp", ShapeKind::gimp}, "hats averaged over a point's square (uGIMP)", 3, true},
    ShapeRow{{"bspline", ShapeKind::bspline}, "quadratic B-splines", 3}};
constexpr const auto& names_of(ShapeKind) { return shape_rows; }

struct TransferRow : NamedValue<TransferKind> {
  std::string_view text;
  bool affine = false;  // points carry an affine velocity field (Particles::C_xx)
  bool blends = false;  // takes a share of PIC (Scheme::pic_per_s)
};
inline constexpr std::array transfer_rows{
    TransferRow{{"flip", TransferKind::flip}, "points take the nodes' change of velocity", false, true},
    TransferRow{{"apic", TransferKind::apic}, "points take the nodes' velocity and its affine part", true},
    TransferRow{{"xpic", TransferKind::xpic}, "points take the nodes' velocity, filtered to an order"}};
constexpr const auto& names_of(TransferKind) { return transfer_rows; }

struct StressUpdateRow : NamedValue<StressUpdate> {
  std::string_view text;
};
inline constexpr std::array stress_update_rows{
    StressUpdateRow{{"musl", StressUpdate::musl}, "last, from velocities mapped again"},
    StressUpdateRow{{"usl", StressUpdate::usl}, "last"},
    StressUpdateRow{{"usf", StressUpdate::usf}, "first"}};
constexpr const auto& names_of(StressUpdate) { return stress_update_rows; }

struct LockingRow : NamedValue<Locking> {
  std::string_view text;
  bool of_elements = false;  // acts at the elements' centres: shapes of two nodes only
};
inline constexpr std::array locking_rows{
    LockingRow{{"none", Locking::none}, "stress and strain of every point as they are"},
    LockingRow{{"selective", Locking::selective}, "volume and mean stress at the elements' centres", true},
    LockingRow{{"full", Locking::full}, "all strain and stress at the elements' centres", true},
    LockingRow{{"fbar", Locking::fbar}, "volume and mean stress averaged over points"}};
constexpr const auto& names_of(Locking) { return locking_rows; }

enum class SchemeName { standard, geopart };
struct SchemeRow : NamedValue<SchemeName> {
  std::string_view text;
  Scheme choices;
};
inline constexpr std::array scheme_rows{
    SchemeRow{{"default", SchemeName::standard}, "B-splines, APIC, stress last, F-bar", {}},
    SchemeRow{{"geopart", SchemeName::geopart},
              "the thesis' program",
              {.shape = ShapeKind::bilinear,
               .transfer = TransferKind::flip,
               .stress = StressUpdate::musl,
               .locking = Locking::selective,
               .damping = 0.05}}};
constexpr const auto& names_of(SchemeName) { return scheme_rows; }

/// The row of a value.
template <Choice E>
constexpr const auto& row_of(E value) {
  const auto& rows = names_of(value);
  for (const auto& row : rows)
    if (row.value == value) return row;
  return rows.front();
}

}  // namespace pivnp::mpm

// The numerical choices, one row each: the name in a case, what it is, what it needs or allows. Kernels are compiled for the
// values of the enums; a row that is added to a registry has a value of its own and names the kernel that it runs. Nothing
// else lists them.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "mpm/state/scheme.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/registry.hpp"

namespace pivnp::mpm {

template <class E>
struct SchemeChoice : NamedValue<E> {
  std::string_view text;
  std::optional<E> kernel = {};  // that of another row; left out: its own

  constexpr E runs() const { return kernel.value_or(this->value); }
};

struct ShapeRow : SchemeChoice<ShapeKind> {
  int nodes;           // of a point, along an axis
  bool sized = false;  // points have a size of their own (Particles::half)

  /// Its cells are the squares around nodes; else elements between nodes.
  constexpr bool centred() const { return nodes % 2 == 1; }
};
/// Those that kernels are compiled for.
inline constexpr std::array shape_rows{
    ShapeRow{{{"bilinear", ShapeKind::bilinear}, "the element's bilinear functions"}, 2},
    ShapeRow{{{"gimp", ShapeKind::gimp}, "hats averaged over a point's square (uGIMP)"}, 3, true},
    ShapeRow{{{"bspline", ShapeKind::bspline}, "quadratic B-splines"}, 3}};
Registry<ShapeRow>& shapes();  // they, and what was added
inline const auto& names_of(ShapeKind) { return shapes(); }

struct TransferRow : SchemeChoice<TransferKind> {
  bool affine = false;  // points carry an affine velocity field (Particles::C_xx)
  bool blends = false;  // takes a share of PIC (Scheme::pic_per_s)
};
Registry<TransferRow>& transfers();
inline const auto& names_of(TransferKind) { return transfers(); }

struct StressUpdateRow : NamedValue<StressUpdate> {
  std::string_view text;
};
inline constexpr std::array stress_update_rows{
    StressUpdateRow{{"musl", StressUpdate::musl}, "last, from velocities mapped again"},
    StressUpdateRow{{"usl", StressUpdate::usl}, "last"},
    StressUpdateRow{{"usf", StressUpdate::usf}, "first"}};
constexpr const auto& names_of(StressUpdate) { return stress_update_rows; }

struct LockingRow : SchemeChoice<Locking> {
  bool of_elements = false;  // acts at the elements' centres: shapes of two nodes only
};
Registry<LockingRow>& lockings();
inline const auto& names_of(Locking) { return lockings(); }

enum class SchemeName { standard, geopart };
struct SchemeRow : NamedValue<SchemeName> {
  std::string_view text;
  Scheme choices;
};
inline constexpr std::array scheme_rows{
    SchemeRow{{"default", SchemeName::standard}, "B-splines, AFLIP, stress last, F-bar", {}},
    SchemeRow{{"geopart", SchemeName::geopart},
              "the thesis' program, without its damping",
              {.shape = ShapeKind::bilinear,
               .transfer = TransferKind::flip,
               .stress = StressUpdate::musl,
               .locking = Locking::selective}}};
constexpr const auto& names_of(SchemeName) { return scheme_rows; }

/// The row of a value.
template <Choice E>
constexpr const auto& row_of(E value) {
  const auto& rows = names_of(value);
  for (const auto& row : rows)
    if (row.value == value) return row;
  return *rows.begin();
}

}  // namespace pivnp::mpm

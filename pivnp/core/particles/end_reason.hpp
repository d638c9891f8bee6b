// Why a particle ended: one row a reason. Whoever names one, explains one or checks one that it has read asks here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pivnp/core/registry.hpp"

namespace pivnp {

enum class EndReason : std::uint8_t { none = 0, left_grid = 1, no_vectors = 2, bad_state = 3, left_image = 4, removed = 5 };

struct EndReasonRow {
  std::string_view name;   // as in docs/format.md
  EndReason value;         // as records store it: numbers stay, new ones are added at the end
  std::string_view words;  // what particles so ended did: "left the grid"
};

Registry<EndReasonRow>& end_reasons();

/// nullptr: a number that no row has (a record of a later version).
const EndReasonRow* find(EndReason reason);

/// The row's words, or one line that names the number where no row has it.
std::string words(EndReason reason);

}  // namespace pivnp

// What two motions' beginnings tell: whether their clocks differ, and whether the stated errors hold while nothing moves.
#pragma once

#include <optional>

#include "compare/alignment/onset.hpp"
#include "compare/measures/differences.hpp"

namespace pivnp::compare {

/// Read from the statistics over the particles at the common times; no frame is read again.
struct Beginnings {
  /// Onset of the mean |u|, second minus first (find_onset), with the power that fits both better. Uncertainty: scatter
  /// about the lines, and u_val in the rise over the speed there. Nothing where one does not move from rest.
  std::optional<Onset> difference;
  /// Greatest RMS difference over u_val at the times at which the second stands still (mean |u| below 2 % of its last):
  /// above two, the first has begun to move, or errs by more than it states. Nothing where the second never stands still
  /// after the start, or u_val is not known.
  std::optional<double> rest_over_u;
};
Beginnings beginnings(const Differences& differences);

}  // namespace pivnp::compare

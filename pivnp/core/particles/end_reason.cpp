#include "pivnp/core/particles/end_reason.hpp"

namespace pivnp {

Registry<EndReasonRow>& end_reasons() {
  static Registry<EndReasonRow> rows{
      {"none", EndReason::none, "were followed to the last frame"},
      {"left_grid", EndReason::left_grid, "left the measured or simulated grid"},
      {"no_vectors", EndReason::no_vectors, "lost the valid vectors around them"},
      {"bad_state", EndReason::bad_state, "were distorted beyond meaning (det F not positive, F not finite, or stretched a thousandfold)"},
      {"left_image", EndReason::left_image, "left the image or went under a mask"},
      {"removed", EndReason::removed, "were removed by the case (an excavation)"}};
  return rows;
}

const EndReasonRow* find(EndReason reason) {
  for (const EndReasonRow& row : end_reasons())
    if (row.value == reason) return &row;
  return nullptr;
}

std::string words(EndReason reason) {
  if (const EndReasonRow* row = find(reason)) return std::string(row->words);
  return "ended for a reason that this version does not know (number " + std::to_string(int(reason)) + ")";
}

}  // namespace pivnp

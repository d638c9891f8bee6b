// How good the vectors of a pair are, for the reader.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// Quality of one pair; shares are of the nodes in material that are not masked (of all that are not masked where the
/// material's place is not known).
struct PairQuality {
  std::array<int, 2> frames{0, 1};
  std::size_t nodes = 0;       // in material and not masked
  std::size_t outside = 0;     // not masked, but in front of no material
  bool material_known = false;
  std::size_t valid = 0, replaced = 0, rejected = 0, failed = 0;
  double score_median = 0, score_low = 0, score_high = 0;  // of the valid; low, high: 5th and 95th percentile; NaN if none
  double sigma = 0;                                        // RMS standard uncertainty of a valid vector's component
  std::uint8_t flag = 0;                                   // of the second frame
  double share(std::size_t n) const { return nodes == 0 ? 0 : double(n) / double(nodes); }
};
std::vector<PairQuality> pair_quality(const Content& content);

}  // namespace pivnp::report

#include "apps/report/content/material.hpp"

#include <algorithm>

#include "pivnp/core/particles/coverage.hpp"

namespace pivnp::report {

std::vector<std::uint8_t> nodes_in_material(const Content& content, const VectorField& field) {
  const bool stated = std::find(field.status.begin(), field.status.end(), VectorStatus::outside) != field.status.end();
  if (stated) {
    std::vector<std::uint8_t> inside;
    for (const VectorStatus s : field.status) inside.push_back(s != VectorStatus::outside);
    return inside;
  }
  const auto first = std::size_t(std::max(0, field.pair[0]));
  if (!content.tracked || first >= content.frames.size()) return {};
  return covered_nodes(*content.tracked, content.frames[first].time, field.grid);
}

}  // namespace pivnp::report

// What the tests of the case reader share.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "apps/case/case.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

/// The message that reading `text` as "c.toml" ends with; empty if it reads.
inline std::string refusal(const std::string& text) {
  try {
    parse_case(text, "c.toml", ".");
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "more than one line: " << error.what();
    return error.what();
  }
  return "";
}

/// A case that measures and simulates; tests change single lines of it.
inline const std::string whole_case = R"(name = "slope"
[frames]
path = "frames/*.png"
[camera]
metres_per_pixel = 2e-4
[region.sand]
polygon_m = [[0, 0], [0.3, 0], [0.2, 0.2], [0, 0.2]]
[material.sand]
density_kg_m3 = 1545
young_pa = 30e6
friction_deg = 43
[mpm]
per_element = 4
)";

/// `whole_case` with `from` replaced by `to`.
inline std::string changed(const std::string& from, const std::string& to) {
  std::string text = whole_case;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace pivnp::app

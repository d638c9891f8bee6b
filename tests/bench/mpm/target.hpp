// The instruction set that a program of figures runs on.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "mpm/transfer/lanes.hpp"
#include "tests/support/instruction_sets.hpp"

namespace pivnp::bench {

/// Runs the kernels on the set of this name (avx3, avx2, sse2); ends the program where there is none.
inline void choose_target(const std::string& name) {
  std::string known;
  for (const std::int64_t set : test::instruction_sets()) {
    test::choose_instruction_set(set);
    std::string each = mpm::simd_target();
    std::transform(each.begin(), each.end(), each.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    if (each == name) return;
    known += " " + each;
  }
  std::fprintf(stderr, "target=%s: this program and processor have%s\n", name.c_str(), known.c_str());
  std::exit(2);
}

}  // namespace pivnp::bench

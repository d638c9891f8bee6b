// Kernels on every instruction set that they are compiled for and this processor has.
#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "mpm/transfer/lanes.hpp"
#include "tests/support/instruction_sets.hpp"

namespace pivnp::mpm::test {

/// Runs `body` on the best instruction set and on the plainer ones.
template <class Body>
void on_every_target(Body&& body) {
  for (const std::int64_t set : pivnp::test::instruction_sets()) {
    pivnp::test::choose_instruction_set(set);
    SCOPED_TRACE(simd_target());
    body();
  }
  pivnp::test::choose_best_instruction_set();
}

}  // namespace pivnp::mpm::test

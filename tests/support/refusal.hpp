// What is said where something is refused.
#pragma once

#include <string>

#include "pivnp/core/error.hpp"

namespace pivnp::test {

/// The InputError's line; empty: nothing was refused.
template <class Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace pivnp::test

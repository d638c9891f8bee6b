// Messages about keys of a case, with file and line.
#pragma once

#include <utility>

#include "apps/case/case.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

/// What `work` gives. An InputError of it that is about a key of the case comes on with the key's place.
template <class Work>
auto placed(const Case& c, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const InputError& error) {
    throw InputError(with_place(c, error.what()));
  }
}

}  // namespace pivnp::app

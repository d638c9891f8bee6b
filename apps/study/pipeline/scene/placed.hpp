// Messages about keys of a case, with file and line.
#pragma once

#include <string>
#include <utility>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

/// What `work` gives. An InputError of it that is about a key of the case comes on with the key's place; one about
/// frames that the command line named does not.
template <class Work>
auto placed(const Case& c, const RunSettings& settings, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const InputError& error) {
    const std::string what = error.what();
    throw InputError(settings.frames && what.starts_with("frames") ? what : with_place(c, what));
  }
}

}  // namespace pivnp::app

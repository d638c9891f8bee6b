// Progress that nobody follows.
#pragma once

#include "pivnp/core/progress.hpp"

namespace pivnp {

inline SilentProgress silent;

}  // namespace pivnp

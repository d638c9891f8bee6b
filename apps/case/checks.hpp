// What only the whole case shows.
#pragma once

#include "apps/case/case.hpp"
#include "apps/case/document.hpp"

namespace pivnp::app {

/// Throws InputError of one line, with file, line and key, for options that contradict each other, outlines that are
/// none, materials that are missing, stages without what they need. `source` says where keys stand and which were
/// given; piv and np are still as the file has them.
void check_given(const Case& c, const Source& source);

}  // namespace pivnp::app

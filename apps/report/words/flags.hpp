// What was flagged.
#pragma once

#include <string>
#include <vector>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// Limits that are exceeded, then the remarks that are more than notes: what is not usable first. Empty if nothing was
/// flagged.
std::vector<std::string> flags(const Content& content);

}  // namespace pivnp::report

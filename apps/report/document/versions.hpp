// What wrote the report.
#pragma once

#include <string>

namespace pivnp::report {

std::string program_version();
/// One sentence: pivnp and what draws the figures.
std::string versions();

}  // namespace pivnp::report

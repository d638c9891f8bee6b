// What wrote the report.
#pragma once

#include <string>

namespace pivnp::report {

std::string program_version();
/// One sentence: version, commit and libraries of the program, and what draws the figures.
std::string versions();

}  // namespace pivnp::report

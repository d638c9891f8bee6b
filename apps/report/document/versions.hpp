// What wrote the report.
#pragma once

#include <string>

#include "pivnp/core/version.hpp"

namespace pivnp::report {

std::string program_version();

/// Version, commit and libraries of the program that wrote the record, and of this one where it is another; what draws
/// the figures.
std::string versions(const BuildInfo& record);

}  // namespace pivnp::report

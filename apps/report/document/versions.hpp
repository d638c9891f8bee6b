// What wrote the report.
#pragma once

#include <string>

namespace pivnp::report {

std::string program_version();
/// One sentence: pivnp, Qt, QCustomPlot.
std::string versions();

}  // namespace pivnp::report

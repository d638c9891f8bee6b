#include "apps/report/document/versions.hpp"

#include "apps/plot/canvas.hpp"

namespace pivnp::report {

std::string program_version() { return PIVNP_VERSION; }

std::string versions() { return "pivnp " + program_version() + "; figures by " + plot::drawing_libraries() + "."; }

}  // namespace pivnp::report

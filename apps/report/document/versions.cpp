#include "apps/report/document/versions.hpp"

#include "apps/plot/canvas.hpp"
#include "pivnp/core/version.hpp"

namespace pivnp::report {

std::string program_version() { return build_info().version; }

std::string versions() {
  const BuildInfo& build = build_info();
  return "pivnp " + build.version + " (commit " + build.commit + "), built with " + build.libraries + "; figures by " +
         plot::drawing_libraries() + ".";
}

}  // namespace pivnp::report

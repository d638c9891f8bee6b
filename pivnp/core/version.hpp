// What was built: for --version, records and reports.
#pragma once

#include <string>

namespace pivnp {

struct BuildInfo {
  std::string version;    // of the program: "0.1.0"
  std::string commit;     // `git describe` of the sources, "-dirty" if they were changed; "unknown" without git
  std::string libraries;  // those that results depend on, as found when it was configured: "CGAL 5.5.1, Eigen 3.4.0 ..."
};

/// Of this program. The version stands in the top CMakeLists.txt alone.
const BuildInfo& build_info();

}  // namespace pivnp

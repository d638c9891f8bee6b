#include "apps/report/document/versions.hpp"

#include <QtGlobal>
#include <qcustomplot.h>

#include "pivnp/core/version.hpp"

namespace pivnp::report {

std::string program_version() { return build_info().version; }

std::string versions() {
  return "pivnp " + program_version() + "; figures by QCustomPlot " QCUSTOMPLOT_VERSION_STR " on Qt " +
         std::string(qVersion()) + ".";
}

}  // namespace pivnp::report

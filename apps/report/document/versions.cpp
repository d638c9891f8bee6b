#include "apps/report/document/versions.hpp"

#include <QtGlobal>
#include <qcustomplot.h>

namespace pivnp::report {

std::string program_version() { return PIVNP_VERSION; }

std::string versions() {
  return "pivnp " + program_version() + "; figures by QCustomPlot " QCUSTOMPLOT_VERSION_STR " on Qt " +
         std::string(qVersion()) + ".";
}

}  // namespace pivnp::report

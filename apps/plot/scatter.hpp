// Between the sources that draw with QCustomPlot; for them only.
#pragma once

#include <qcustomplot.h>

#include "apps/plot/painter.hpp"

namespace pivnp::plot {

QCPScatterStyle scatter_style(const Symbol& symbol);
/// As in QPainter::drawText.
int qt_alignment(Align align);

}  // namespace pivnp::plot

// Qt as the figures use it. Only for files that draw with Qt themselves.
#pragma once

#include <string>

#include <QColor>
#include <QFont>
#include <QPen>
#include <QString>

#include "apps/plot/painter.hpp"
#include "pivnp/core/printable.hpp"

namespace pivnp::plot {

QColor qt_colour(Rgb rgb, int alpha = 255);
QFont qt_font(double points, bool bold = false);
QPen qt_pen(const Pen& pen);
inline QString qt(const std::string& text) { return QString::fromStdString(printable(text, true)); }

}  // namespace pivnp::plot

// Axes of a panel (declared in canvas.hpp).
#include <algorithm>
#include <cmath>

#include <qcustomplot.h>

#include "apps/plot/canvas.hpp"
#include "apps/plot/qt.hpp"

namespace pivnp::plot {

namespace {

// Ticks at whole multiples of a step; labels with a true minus sign.
class StepTicker final : public QCPAxisTickerFixed {
 protected:
  QString getTickLabel(double tick, const QLocale& locale, QChar format, int precision) override {
    if (std::abs(tick) < 1e-9 * tickStep()) tick = 0;
    return QCPAxisTickerFixed::getTickLabel(tick, locale, format, precision).replace(QLatin1Char('-'), QChar(0x2212));
  }
};

}  // namespace

QCPAxis* Panel::of(Axis axis) const { return rect_->axis(axis == Axis::x ? QCPAxis::atBottom : QCPAxis::atLeft); }

double Panel::x(double value) const { return of(Axis::x)->coordToPixel(value); }
double Panel::y(double value) const { return of(Axis::y)->coordToPixel(value); }
double Panel::lower(Axis axis) const { return of(axis)->range().lower; }

Rectangle Panel::frame() const {
  const QRectF r(rect_->rect());
  return {r.left(), r.top(), r.width(), r.height()};
}

Panel& Panel::axis(Axis axis, double lower, double upper, const std::string& label, int ticks) {
  if (!std::isfinite(lower) || !std::isfinite(upper)) lower = 0, upper = 1;
  if (!(upper > lower)) {
    const double about = std::max(std::abs(lower), 1e-12);
    upper = lower + about;
    if (lower != 0) lower -= about;
  }
  of(axis)->setRange(lower, upper);
  of(axis)->setLabel(qt(label));
  return step(axis, step_with_ticks(lower, upper, nice_step(upper - lower, ticks)));
}

Panel& Panel::logarithmic(Axis axis, double lower, double upper, int digits) {
  QCPAxis* a = of(axis);
  a->setScaleType(QCPAxis::stLogarithmic);
  a->setTicker(QSharedPointer<QCPAxisTickerLog>::create());
  a->setRange(lower, upper);
  a->setNumberPrecision(digits);
  if (lower < 1e-5) {  // powers of ten all along, not 10^-6 beside 0.0001
    a->setNumberFormat("eb");
    a->setNumberPrecision(0);
  }
  return *this;
}

Panel& Panel::small_ticks(Axis axis) {
  of(axis)->setSubTicks(true);
  of(axis)->setSubTickPen(qt_pen({}));
  of(axis)->setSubTickLength(0, int(0.6 * units_per_mm));
  return *this;
}

Panel& Panel::step(Axis axis, double step) {
  const auto ticker = QSharedPointer<StepTicker>::create();
  ticker->setTickStep(step);
  of(axis)->setTicker(ticker);
  return *this;
}

Panel& Panel::numbers(Axis axis, bool shown) {
  of(axis)->setTickLabels(shown);
  return *this;
}

Panel& Panel::ticks(Axis axis, bool shown) {
  of(axis)->setTicks(shown);
  return *this;
}

Panel& Panel::base_line(Axis axis, bool shown) {
  of(axis)->setBasePen(shown ? qt_pen({}) : QPen(Qt::NoPen));
  return *this;
}

Panel& Panel::visible(Axis axis, bool shown) {
  of(axis)->setVisible(shown);
  return *this;
}

Panel& Panel::pale_grid() {
  QCPGrid* grid = of(Axis::y)->grid();
  grid->setVisible(true);
  grid->setPen(qt_pen({.rgb = 0xe6e6e6, .points = 0.4}));
  grid->setZeroLinePen(qt_pen({.rgb = 0xc4c4c4, .points = 0.4}));
  return *this;
}

double step_with_ticks(double lower, double upper, double step) {
  const auto ticks = [&](double s) { return std::floor(upper / s * (1 + 1e-12)) - std::ceil(lower / s * (1 - 1e-12)) + 1; };
  for (int tries = 0; tries < 3 && upper > lower && ticks(step) < 2; ++tries) step = nice_step(step / 2, 1);
  return step;
}

double nice_step(double range, int count) {
  if (!(range > 0) || !std::isfinite(range)) return 1;
  const double raw = range / std::max(count, 1), power = std::pow(10.0, std::floor(std::log10(raw)));
  const double m = raw / power;
  return (m < 1.5 ? 1 : m < 3.2 ? 2 : m < 7.1 ? 5 : 10) * power;
}

double nice_length(double length) {
  if (!(length > 0) || !std::isfinite(length)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(length) + 1e-12)), m = length / power * (1 + 1e-12);
  return (m >= 5 ? 5 : m >= 2 ? 2 : 1) * power;
}

}  // namespace pivnp::plot

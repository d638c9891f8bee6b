#include "apps/plot/canvas.hpp"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <QApplication>
#include <QBuffer>
#include <QFontDatabase>
#include <QSvgGenerator>

namespace pivnp::report {

namespace {

// Ticks at whole multiples of a step; labels with a true minus sign.
class StepTicker final : public QCPAxisTickerFixed {
 protected:
  QString getTickLabel(double tick, const QLocale& locale, QChar format, int precision) override {
    if (std::abs(tick) < 1e-9 * tickStep()) tick = 0;
    return QCPAxisTickerFixed::getTickLabel(tick, locale, format, precision).replace(QLatin1Char('-'), QChar(0x2212));
  }
};

// A layer entry that paints what it is given.
class Painting final : public QCPLayerable {
 public:
  Painting(QCustomPlot* plot, const QString& layer, QCPAxisRect* panel, std::function<void(QCPPainter&)> painting)
      : QCPLayerable(plot, layer), panel_(panel), painting_(std::move(painting)) {}

 protected:
  void applyDefaultAntialiasingHint(QCPPainter* painter) const override { painter->setAntialiasing(true); }
  QRect clipRect() const override { return panel_ == nullptr ? QCPLayerable::clipRect() : panel_->rect(); }
  void draw(QCPPainter* painter) override {
    painter->setRenderHint(QPainter::SmoothPixmapTransform);
    painting_(*painter);
  }

 private:
  QCPAxisRect* panel_;
  std::function<void(QCPPainter&)> painting_;
};

void style(QCPAxis* axis) {
  axis->setBasePen(pen(ink, 0.5));
  axis->setTickPen(pen(ink, 0.5));
  axis->setSubTicks(false);
  axis->setTickLength(0, int(1.1 * units_per_mm));
  axis->setTickLabelFont(font(small_text));
  axis->setTickLabelColor(colour(ink));
  axis->setTickLabelPadding(int(0.7 * units_per_mm));
  axis->setLabelFont(font(normal_text));
  axis->setLabelColor(colour(ink));
  axis->setLabelPadding(int(0.9 * units_per_mm));
  axis->setNumberFormat("gb");
  axis->setNumberPrecision(5);
  axis->setLayer("axes");
  axis->grid()->setLayer("grid");
  axis->grid()->setVisible(false);
}

}  // namespace

void start_qt() {
  if (QCoreApplication::instance() != nullptr) return;
  // A record may be reported on by a service without a home; fontconfig then looks for a place for its cache.
  if (std::getenv("HOME") == nullptr && std::getenv("XDG_CACHE_HOME") == nullptr) {
    std::error_code none;
    const std::filesystem::path temporary = std::filesystem::temp_directory_path(none);
    if (!none) ::setenv("XDG_CACHE_HOME", (temporary / "pivnp-cache").c_str(), 0);
  }
  const char* before = std::setlocale(LC_ALL, nullptr);
  const std::string locale = before == nullptr ? "C" : before;
  // On the command line of Qt, so that a platform from the environment that cannot be reached does not end the program.
  static char name[] = "pivnp", option[] = "-platform", platform[] = "offscreen";
  static char* argv[] = {name, option, platform, nullptr};
  static int argc = 3;
  // Remarks on the desktop's folders mean nothing here.
  const QtMessageHandler handler =
      qInstallMessageHandler([](QtMsgType type, const QMessageLogContext&, const QString& text) {
        if (type == QtCriticalMsg || type == QtFatalMsg) std::fprintf(stderr, "Qt: %s\n", qPrintable(text));
      });
  new QApplication(argc, argv);  // lives as long as the process: Qt does not outlive static destruction well
  qInstallMessageHandler(handler);
  std::setlocale(LC_ALL, locale.c_str());
  QLocale::setDefault(QLocale::c());
}

QColor colour(Rgb rgb, int alpha) {
  return QColor(int(rgb >> 16 & 0xff), int(rgb >> 8 & 0xff), int(rgb & 0xff), alpha);
}

QFont font(double points, bool bold) {
  QFont f(QStringLiteral("DejaVu Sans"));
  f.setPixelSize(std::max(1, int(std::lround(points * units_per_point))));
  f.setBold(bold);
  f.setHintingPreference(QFont::PreferNoHinting);
  return f;
}

QPen pen(Rgb rgb, double points, Qt::PenStyle style) {
  return QPen(colour(rgb), points * units_per_point, style, Qt::FlatCap, Qt::RoundJoin);
}

QImage to_image(const Raster& raster) {
  return QImage(reinterpret_cast<const uchar*>(raster.pixels.data()), raster.width, raster.height, 4 * raster.width,
                QImage::Format_ARGB32)
      .copy();
}

double text_width(const QString& words, double points, bool bold) {
  return QFontMetricsF(font(points, bold)).horizontalAdvance(words) / units_per_mm;
}

Sheet::Sheet(double width_mm, double height_mm) : width_mm_(width_mm), height_mm_(height_mm) {
  start_qt();
  plot_ = std::make_unique<QCustomPlot>();
  plot_->setNoAntialiasingOnDrag(false);
  plot_->setAntialiasedElements(QCP::aeAll);
  plot_->setBackground(QBrush(Qt::white));
  plot_->setLocale(QLocale::c());
  plot_->setViewport(QRect(0, 0, int(width_mm * units_per_mm), int(height_mm * units_per_mm)));
  plot_->plotLayout()->clear();
  inset_ = new QCPLayoutInset;
  plot_->plotLayout()->addElement(0, 0, inset_);
}

Sheet::~Sheet() = default;

QCPAxisRect* Sheet::panel(double x_mm, double y_mm, double width_mm, double height_mm) {
  auto* rect = new QCPAxisRect(plot_.get(), true);
  rect->setAutoMargins(QCP::msNone);
  rect->setMargins(QMargins(0, 0, 0, 0));
  rect->setMinimumSize(1, 1);
  for (QCPAxis* axis : rect->axes()) style(axis);
  rect->axis(QCPAxis::atTop)->setVisible(false);
  rect->axis(QCPAxis::atRight)->setVisible(false);
  // Half a unit more: QCustomPlot cuts fractions off.
  inset_->addElement(rect, QRectF((x_mm * units_per_mm + 0.5) / (width_mm_ * units_per_mm),
                                  (y_mm * units_per_mm + 0.5) / (height_mm_ * units_per_mm), width_mm / width_mm_,
                                  height_mm / height_mm_));
  return rect;
}

QCPGraph* Sheet::graph(QCPAxisRect* panel) {
  QCPGraph* g = plot_->addGraph(panel->axis(QCPAxis::atBottom), panel->axis(QCPAxis::atLeft));
  g->setAdaptiveSampling(false);
  return g;
}

void Sheet::paint(QCPAxisRect* panel, std::function<void(QCPPainter&)> painting) {
  new Painting(plot_.get(), "grid", panel, std::move(painting));  // owned by the plot
}

void Sheet::paint_over(std::function<void(QCPPainter&)> painting) {
  new Painting(plot_.get(), "overlay", nullptr, std::move(painting));
}

void Sheet::text(double x_mm, double y_mm, const QString& words, int align, double points, bool bold, Rgb rgb,
                 double angle_deg) {
  paint_over([=](QCPPainter& p) {
    p.save();
    p.translate(x_mm * units_per_mm, y_mm * units_per_mm);
    p.rotate(angle_deg);
    p.setFont(font(points, bold));
    p.setPen(colour(rgb));
    const double w = 4000, h = 400;
    const double left = (align & Qt::AlignRight) ? -w : (align & Qt::AlignHCenter) ? -w / 2 : 0;
    const double top = (align & Qt::AlignBottom) ? -h : (align & Qt::AlignVCenter) ? -h / 2 : 0;
    p.drawText(QRectF(left, top, w, h), align, words);
    p.restore();
  });
}

void Sheet::draw(QCPPainter& painter) const {
  painter.save();
  painter.setMode(QCPPainter::pmVectorized);
  painter.setMode(QCPPainter::pmNonCosmetic);
  plot_->toPainter(&painter, int(width_mm_ * units_per_mm), int(height_mm_ * units_per_mm));
  painter.restore();
}

QImage Sheet::image(double dots_per_inch) const {
  const double scale = dots_per_inch / 25.4;
  QImage image(int(std::ceil(width_mm_ * scale)), int(std::ceil(height_mm_ * scale)), QImage::Format_RGB32);
  image.fill(Qt::white);
  image.setDotsPerMeterX(int(std::lround(scale * 1000)));
  image.setDotsPerMeterY(int(std::lround(scale * 1000)));
  QCPPainter painter(&image);
  painter.scale(scale / units_per_mm, scale / units_per_mm);
  draw(painter);
  return image;
}

QByteArray Sheet::png(double dots_per_inch) const {
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  image(dots_per_inch).save(&buffer, "PNG");
  return bytes;
}

QByteArray Sheet::svg() const {
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  {
    const QSize size(int(width_mm_ * units_per_mm), int(height_mm_ * units_per_mm));
    QSvgGenerator generator;
    generator.setOutputDevice(&buffer);
    generator.setResolution(int(25.4 * units_per_mm));
    generator.setSize(size);
    generator.setViewBox(QRect(QPoint(0, 0), size));
    QCPPainter painter(&generator);
    draw(painter);
  }
  return bytes;
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

void set_step(QCPAxis* axis, double step) {
  const auto ticker = QSharedPointer<StepTicker>::create();
  ticker->setTickStep(step);
  axis->setTicker(ticker);
}

void set_axis(QCPAxis* axis, double lower, double upper, const QString& label, int ticks) {
  if (!std::isfinite(lower) || !std::isfinite(upper)) lower = 0, upper = 1;
  if (!(upper > lower)) {
    const double about = std::max(std::abs(lower), 1e-12);
    upper = lower + about;
    if (lower != 0) lower -= about;
  }
  axis->setRange(lower, upper);
  set_step(axis, nice_step(upper - lower, ticks));
  axis->setLabel(label);
}

double draw_key(Sheet& sheet, double x_mm, double y_mm, Key key, Rgb rgb, const QString& words, double gap_mm) {
  const bool wide =
      key == Key::line || key == Key::dashed || key == Key::dotted || key == Key::dash_dot || key == Key::band;
  const double width = wide ? 7 : 2.4;
  sheet.paint_over([=](QCPPainter& p) {
    const double x = x_mm * units_per_mm, y = y_mm * units_per_mm, w = width * units_per_mm, c = x + w / 2;
    const double r = 0.9 * units_per_mm;
    p.setPen(pen(rgb, 1.1));
    p.setBrush(Qt::NoBrush);
    switch (key) {
      case Key::line: p.drawLine(QLineF(x, y, x + w, y)); break;
      case Key::dashed:
        p.setPen(pen(rgb, 1.1, Qt::DashLine));
        p.drawLine(QLineF(x, y, x + w, y));
        break;
      case Key::dotted:
        p.setPen(pen(rgb, 1.1, Qt::DotLine));
        p.drawLine(QLineF(x, y, x + w, y));
        break;
      case Key::dash_dot:
        p.setPen(pen(rgb, 1.1, Qt::DashDotLine));
        p.drawLine(QLineF(x, y, x + w, y));
        break;
      case Key::band:
        p.setPen(Qt::NoPen);
        p.setBrush(colour(rgb, 60));
        p.drawRect(QRectF(x, y - 1.1 * r, w, 2.2 * r));
        break;
      case Key::disc:
        p.setPen(Qt::NoPen);
        p.setBrush(colour(rgb));
        p.drawEllipse(QPointF(c, y), r, r);
        break;
      case Key::circle: p.drawEllipse(QPointF(c, y), r, r); break;
      case Key::square: p.drawRect(QRectF(c - r, y - r, 2 * r, 2 * r)); break;
      case Key::triangle: p.drawPolygon(QPolygonF({{c - r, y + r}, {c + r, y + r}, {c, y - r}})); break;
      case Key::cross:
        p.drawLine(QLineF(c - r, y - r, c + r, y + r));
        p.drawLine(QLineF(c - r, y + r, c + r, y - r));
        break;
      case Key::tile:
        p.setPen(pen(faint, 0.3));
        p.setBrush(colour(rgb));
        p.drawRect(QRectF(x, y - 1.2 * r, w, 2.4 * r));
        break;
    }
  });
  sheet.text(x_mm + width + 1.3, y_mm, words, Qt::AlignLeft | Qt::AlignVCenter, small_text);
  return x_mm + width + 1.3 + text_width(words, small_text) + gap_mm;
}

}  // namespace pivnp::report

#include "apps/plot/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include <QBuffer>
#include <QSvgGenerator>
#include <qcustomplot.h>

#include "apps/plot/files.hpp"
#include "apps/plot/qt.hpp"
#include "apps/plot/scatter.hpp"

namespace pivnp::plot {

namespace {

// Qt scales in threads of its pool, and waits forever for one that cannot be made. The memory of a thread that has ended is
// taken by the next.
void draw_image(QCPPainter& painter, const QRectF& place, const QImage& image) {
  try {
    std::thread([] {}).join();
  } catch (const std::system_error&) {
    throw std::bad_alloc();
  }
  painter.drawImage(place, image);
}

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

constexpr auto layer_below = "grid", layer_above = "overlay";  // QCustomPlot's layers under and over the axes

QImage image_of(const Raster& raster) {
  return QImage(reinterpret_cast<const uchar*>(raster.pixels.data()), raster.width, raster.height, 4 * raster.width,
                QImage::Format_ARGB32)
      .copy();
}

QVector<double> vector_of(const std::vector<double>& values) { return {values.begin(), values.end()}; }

void style(QCPAxis* axis) {
  axis->setBasePen(qt_pen({}));
  axis->setTickPen(qt_pen({}));
  axis->setSubTicks(false);
  axis->setTickLength(0, int(1.1 * units_per_mm));
  axis->setTickLabelFont(qt_font(small_text));
  axis->setTickLabelColor(qt_colour(ink));
  axis->setTickLabelPadding(int(0.7 * units_per_mm));
  axis->setLabelFont(qt_font(normal_text));
  axis->setLabelColor(qt_colour(ink));
  axis->setLabelPadding(int(0.9 * units_per_mm));
  axis->setNumberFormat("gb");
  axis->setNumberPrecision(5);
  axis->setLayer("axes");
  axis->grid()->setLayer("grid");
  axis->grid()->setVisible(false);
}

}  // namespace

struct Canvas::Plot {
  QCustomPlot widget;
  QCPLayoutInset* inset = nullptr;  // owned by the plot

  void paint(const char* layer, QCPAxisRect* panel, std::function<void(QCPPainter&)> painting) {
    new Painting(&widget, layer, panel, std::move(painting));  // owned by the plot
  }
  QCPGraph* graph(QCPAxisRect* panel, const std::vector<double>& x, const std::vector<double>& y, bool in_order) {
    QCPGraph* g = widget.addGraph(panel->axis(QCPAxis::atBottom), panel->axis(QCPAxis::atLeft));
    g->setAdaptiveSampling(false);
    g->setData(vector_of(x), vector_of(y), in_order);
    return g;
  }
};

Canvas::Canvas(double width_mm, double height_mm) : width_mm_(width_mm), height_mm_(height_mm) {
  start_qt();
  plot_ = std::make_unique<Plot>();
  QCustomPlot& widget = plot_->widget;
  widget.setNoAntialiasingOnDrag(false);
  widget.setAntialiasedElements(QCP::aeAll);
  widget.setBackground(QBrush(Qt::white));
  widget.setLocale(QLocale::c());
  widget.setViewport(QRect(0, 0, int(width_mm * units_per_mm), int(height_mm * units_per_mm)));
  widget.plotLayout()->clear();
  plot_->inset = new QCPLayoutInset;
  widget.plotLayout()->addElement(0, 0, plot_->inset);
}

Canvas::~Canvas() = default;

Panel Canvas::panel(double x_mm, double y_mm, double width_mm, double height_mm) {
  auto* rect = new QCPAxisRect(&plot_->widget, true);
  rect->setAutoMargins(QCP::msNone);
  rect->setMargins(QMargins(0, 0, 0, 0));
  rect->setMinimumSize(1, 1);
  // In an order of our own: axes() gives one that differs from run to run.
  for (const auto place : {QCPAxis::atLeft, QCPAxis::atRight, QCPAxis::atTop, QCPAxis::atBottom}) style(rect->axis(place));
  rect->axis(QCPAxis::atTop)->setVisible(false);
  rect->axis(QCPAxis::atRight)->setVisible(false);
  // Half a unit more: QCustomPlot cuts fractions off.
  plot_->inset->addElement(rect, QRectF((x_mm * units_per_mm + 0.5) / (width_mm_ * units_per_mm),
                                      (y_mm * units_per_mm + 0.5) / (height_mm_ * units_per_mm), width_mm / width_mm_,
                                      height_mm / height_mm_));
  return Panel(rect);
}

void Canvas::curve(const Panel& panel, const std::vector<double>& x, const std::vector<double>& y, const Pen& pen,
                   const std::optional<Symbol>& symbol) {
  QCPGraph* g = plot_->graph(panel.rect_, x, y, true);
  g->setPen(qt_pen(pen));
  if (symbol) g->setScatterStyle(scatter_style(*symbol));
}

void Canvas::points(const Panel& panel, const std::vector<double>& x, const std::vector<double>& y,
                    const Symbol& symbol) {
  QCPGraph* g = plot_->graph(panel.rect_, x, y, false);
  g->setLineStyle(QCPGraph::lsNone);
  g->setScatterStyle(scatter_style(symbol));
}

void Canvas::raster(const Panel& panel, const Raster& raster) {
  QCPAxisRect* rect = panel.rect_;
  plot_->paint(layer_below, rect, [rect, image = image_of(raster)](QCPPainter& p) { draw_image(p, rect->rect(), image); });
}

void Canvas::raster_over(double x_mm, double y_mm, double width_mm, double height_mm, const Raster& raster) {
  const QRectF place(x_mm * units_per_mm, y_mm * units_per_mm, width_mm * units_per_mm, height_mm * units_per_mm);
  plot_->paint(layer_above, nullptr, [place, image = image_of(raster)](QCPPainter& p) {
    p.setRenderHint(QPainter::SmoothPixmapTransform, false);
    draw_image(p, place, image);
  });
}

void Canvas::paint(const Panel& panel, std::function<void(Painter&)> painting) {
  plot_->paint(layer_below, panel.rect_, [painting = std::move(painting)](QCPPainter& p) {
    Painter painter(p);
    painting(painter);
  });
}

void Canvas::paint_over(std::function<void(Painter&)> painting) {
  plot_->paint(layer_above, nullptr, [painting = std::move(painting)](QCPPainter& p) {
    Painter painter(p);
    painting(painter);
  });
}

void Canvas::text(double x_mm, double y_mm, const std::string& words, Align align, const TextStyle& style) {
  plot_->paint(layer_above, nullptr, [=](QCPPainter& p) {
    p.save();
    p.translate(x_mm * units_per_mm, y_mm * units_per_mm);
    p.rotate(style.angle_deg);
    const int flags = qt_alignment(align);
    const double w = 4000, h = 400;
    const double left = (flags & Qt::AlignRight) ? -w : (flags & Qt::AlignHCenter) ? -w / 2 : 0;
    const double top = (flags & Qt::AlignBottom) ? -h : (flags & Qt::AlignVCenter) ? -h / 2 : 0;
    Painter(p).text({left, top, w, h}, words, align, style);
    p.restore();
  });
}

void Canvas::draw(QCPPainter& painter) const {
  painter.save();
  painter.setMode(QCPPainter::pmVectorized);
  painter.setMode(QCPPainter::pmNonCosmetic);
  plot_->widget.toPainter(&painter, int(width_mm_ * units_per_mm), int(height_mm_ * units_per_mm));
  painter.restore();
}

std::string Canvas::png(double dots_per_inch) const {
  const double scale = dots_per_inch / 25.4;
  QImage image(int(std::ceil(width_mm_ * scale)), int(std::ceil(height_mm_ * scale)), QImage::Format_RGB32);
  image.fill(Qt::white);
  image.setDotsPerMeterX(int(std::lround(scale * 1000)));
  image.setDotsPerMeterY(int(std::lround(scale * 1000)));
  {
    QCPPainter painter(&image);
    painter.scale(scale / units_per_mm, scale / units_per_mm);
    draw(painter);
  }
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  image.save(&buffer, "PNG");
  return bytes.toStdString();
}

std::string Canvas::svg() const {
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
  return bytes.toStdString();
}

void save(const Canvas& canvas, const std::filesystem::path& file, double dots_per_inch) {
  const std::string svg = canvas.svg(), png = canvas.png(dots_per_inch);
  if (file.has_parent_path()) make_folder(file.parent_path());
  write_file(file.string() + ".svg", svg);
  write_file(file.string() + ".png", png);
}

std::string drawing_libraries() { return "QCustomPlot " QCUSTOMPLOT_VERSION_STR " on Qt " + std::string(qVersion()); }

}  // namespace pivnp::plot

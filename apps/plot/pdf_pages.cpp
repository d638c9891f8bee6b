#include "apps/plot/pdf_pages.hpp"

#include <QBuffer>
#include <QPdfWriter>
#include <qcustomplot.h>

#include "apps/plot/qt.hpp"

namespace pivnp::plot {

struct PdfPages::Writer {
  QByteArray bytes;
  QBuffer buffer{&bytes};
  std::unique_ptr<QPdfWriter> pdf;
  QCPPainter painter;
};

PdfPages::PdfPages(const std::string& title) {
  start_qt();
  writer_ = std::make_unique<Writer>();
  Writer& w = *writer_;
  w.buffer.open(QIODevice::WriteOnly);
  w.pdf = std::make_unique<QPdfWriter>(&w.buffer);
  constexpr int resolution = 1200;
  w.pdf->setResolution(resolution);
  w.pdf->setPageSize(QPageSize(QPageSize::A4));
  w.pdf->setPageMargins(QMarginsF(0, 0, 0, 0));
  w.pdf->setTitle(qt(title));
  w.pdf->setCreator(QStringLiteral("pivnp"));
  w.painter.begin(w.pdf.get());
  w.painter.setRenderHint(QPainter::LosslessImageRendering);
  w.painter.setMode(QCPPainter::pmVectorized);
  w.painter.setMode(QCPPainter::pmNonCosmetic);
  w.painter.scale(resolution / (25.4 * units_per_mm), resolution / (25.4 * units_per_mm));
}

PdfPages::~PdfPages() = default;

QPainter& PdfPages::painter() { return writer_->painter; }

void PdfPages::draw(const Canvas& canvas, double x, double y, double scale) {
  writer_->painter.save();
  writer_->painter.translate(x, y);
  writer_->painter.scale(scale, scale);
  canvas.draw(writer_->painter);
  writer_->painter.restore();
}

void PdfPages::next_page() { writer_->pdf->newPage(); }

std::string PdfPages::finish() {
  writer_->painter.end();
  writer_->pdf.reset();
  return writer_->bytes.toStdString();
}

}  // namespace pivnp::plot

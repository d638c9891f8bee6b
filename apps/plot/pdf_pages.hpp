// Pages of a PDF on which text and figure canvases are drawn as vectors.
#pragma once

#include <memory>
#include <string>

#include "apps/plot/canvas.hpp"

class QPainter;

namespace pivnp::plot {

/// A4 pages in canvas units, 2100 by 2970; the first is there from the start.
class PdfPages {
 public:
  explicit PdfPages(const std::string& title);
  ~PdfPages();
  PdfPages(const PdfPages&) = delete;
  PdfPages& operator=(const PdfPages&) = delete;

  QPainter& painter();
  /// Draws a canvas with its top left corner at (x, y), so many times as large.
  void draw(const Canvas& canvas, double x, double y, double scale = 1);
  void next_page();
  /// The file's bytes. Nothing can be drawn after it.
  std::string finish();

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace pivnp::plot

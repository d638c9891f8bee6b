// The document cut into what cannot be cut further: lines, table rows, figures with their captions. Internal to this folder.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "apps/plot/pdf_pages.hpp"
#include "apps/report/document/document.hpp"

namespace pivnp::report {

struct Piece;
using Pieces = std::vector<Piece>;

constexpr double least_scale = 0.74;

/// Lines in columns that are read downwards, in a block for each page that it takes.
struct Columns {
  double line_height = 0;
  std::size_t count = 2, lines = 0;
  std::function<void(plot::PdfPages&, double x, double y, std::size_t line, std::size_t column)> draw;
};

/// Heights in canvas units (tenths of a millimetre).
struct Piece {
  double before = 0;  // free space above, dropped at the head of a page
  double height = 0;
  bool keep_next = false;  // must not end a page
  bool floats = false;     // may wait for the next page while text goes on
  bool barrier = false;    // a section starts: figures that wait come first
  std::function<void(plot::PdfPages&, double x, double y)> draw = {};
  double shrinks = 0;  // the part of the height that may be drawn down to `least_scale`, where a page has no room for all
  std::function<void(plot::PdfPages&, double x, double y, double scale)> draw_scaled = {};  // in place of draw
  std::shared_ptr<const Columns> columns = {};  // cut where a page ends; `height` is the least that may stand at its foot
  std::shared_ptr<const Pieces> repeat = {};  // a table's head, drawn again where a page starts with this piece
};

/// The whole document for a measure of `width`.
Pieces cut(const Document& document, double width);

}  // namespace pivnp::report

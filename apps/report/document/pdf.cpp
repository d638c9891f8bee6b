#include "apps/report/document/pdf.hpp"

#include "apps/report/document/text.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <QFontMetricsF>
#include <QPainter>

#include "apps/plot/qt.hpp"
#include "apps/report/document/pieces.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr double page_width = 2100, page_height = 2970, margin = 200, top = 150, foot = 190;
constexpr double column_width = page_width - 2 * margin, room = page_height - top - foot;

// Pieces from the top down. Figures share one scale, at which all fits.
struct Page {
  std::vector<const Piece*> pieces;
  double fixed = 0, shrinks = 0, scale = 1;
};

// Fills pages from the top. A figure that does not fit, even where all figures of the page shrink for it, waits for the head
// of the next page while the text goes on.
class Paginator {
 public:
  /// `largest`: the scale of figures where there is room.
  explicit Paginator(double largest) : largest_(largest) {}

  std::vector<Page> paginate(const Pieces& pieces) {
    for (std::size_t from = 0; from < pieces.size();) {
      std::size_t to = from;
      while (to + 1 < pieces.size() && pieces[to].keep_next) ++to;
      const std::span<const Piece> chain(&pieces[from], to - from + 1);
      while (chain[0].barrier && !waiting_.empty()) new_page();
      if (chain.size() == 1 && chain[0].floats && (!waiting_.empty() || !fits(chain))) waiting_.push_back(&chain[0]);
      else place(chain);
      from = to + 1;
    }
    while (!waiting_.empty()) new_page();
    return std::move(pages_);
  }

 private:
  bool empty() const { return pages_.empty() || pages_.back().pieces.empty(); }
  double used() const { return pages_.empty() ? room : pages_.back().fixed + pages_.back().scale * pages_.back().shrinks; }

  // Figures shrink for another figure, not for text.
  bool fits(std::span<const Piece> chain) const {
    if (pages_.empty()) return false;
    double fixed = pages_.back().fixed, shrinks = pages_.back().shrinks, scale = pages_.back().scale;
    bool first = empty();
    for (const Piece& p : chain) {
      fixed += (first ? 0 : p.before) + p.height - p.shrinks;
      shrinks += p.shrinks;
      first = false;
      if (p.shrinks > 0) scale = least_scale;
    }
    return fixed + scale * shrinks <= room;
  }

  void new_page() {
    pages_.emplace_back();
    while (!waiting_.empty()) {
      const std::span<const Piece> figure(waiting_.front(), 1);
      if (!empty() && !fits(figure)) break;
      put(*waiting_.front());
      waiting_.pop_front();
    }
  }

  void put(const Piece& piece) {
    Page& page = pages_.back();
    const bool first = page.pieces.empty();
    if (first && piece.repeat)
      for (const Piece& again : *piece.repeat) {
        page.pieces.push_back(&again);
        page.fixed += again.height;
      }
    page.pieces.push_back(&piece);
    page.fixed += (first ? 0 : piece.before) + piece.height - piece.shrinks;
    page.shrinks += piece.shrinks;
    if (page.shrinks > 0) page.scale = std::clamp((room - page.fixed) / page.shrinks, least_scale, largest_);
  }

  void put_columns(const Piece& piece) {
    const std::shared_ptr<const Columns> columns = piece.columns;
    for (std::size_t from = 0; from < columns->lines;) {
      const double before = from == 0 ? piece.before : 0, left = room - used() - (empty() ? 0 : before);
      const std::size_t needed = (columns->lines - from + columns->count - 1) / columns->count;
      const std::size_t rows = std::min(needed, std::size_t(std::max(0.0, left / columns->line_height)));
      if (rows < needed && rows < 4 && !empty()) {
        new_page();
        continue;
      }
      blocks_.push_back({.before = before, .height = double(rows) * columns->line_height, .draw = [=](PdfPages& pages, double x, double y) {
                           for (std::size_t r = 0; r < rows; ++r)
                             for (std::size_t c = 0; c < columns->count && from + c * rows + r < columns->lines; ++c)
                               columns->draw(pages, x, y + double(r) * columns->line_height, from + c * rows + r, c);
                         }});
      put(blocks_.back());
      from += rows * columns->count;
    }
  }

  void place(std::span<const Piece> chain) {
    if (pages_.empty()) new_page();
    // Figures that wait may fill several pages before text has room again.
    while (!fits(chain) && !(empty() && waiting_.empty())) new_page();
    for (const Piece& piece : chain) {
      if (piece.columns) {
        put_columns(piece);
        continue;
      }
      if (!empty() && !fits({&piece, 1})) new_page();  // a chain longer than a page
      put(piece);
    }
  }

  double largest_;
  std::vector<Page> pages_;
  std::deque<const Piece*> waiting_;
  std::deque<Piece> blocks_;  // of columns; the pages point to them
};

void draw_page(PdfPages& out, const Page& page) {
  double y = top;
  bool first = true;
  for (const Piece* piece : page.pieces) {
    if (!std::exchange(first, false)) y += piece->before;
    if (piece->draw_scaled) piece->draw_scaled(out, margin, y, page.scale);
    else piece->draw(out, margin, y);
    y += piece->height - piece->shrinks * (1 - page.scale);
  }
}

void draw_footer(QPainter& painter, const QString& title, std::size_t page, std::size_t pages) {
  painter.setFont(qt_font(7));
  painter.setPen(qt_colour(faint));
  const QRectF line(margin, page_height - 130, column_width, 50);
  const QString number = QString("%1 / %2").arg(page).arg(pages);
  painter.drawText(line, Qt::AlignRight | Qt::AlignVCenter, number);
  painter.drawText(line, Qt::AlignLeft | Qt::AlignVCenter,
                   QFontMetricsF(qt_font(7)).elidedText(title, Qt::ElideRight, column_width - 200));
}

}  // namespace

std::string pdf(const Document& document) {
  start_qt();
  const Pieces pieces = cut(document, column_width);
  // Figures as large as the fewest pages allow.
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  double chosen = 1;
  for (const double largest : {1.0, 0.95, 0.9, 0.85, 0.8})
    if (const std::size_t n = Paginator(largest).paginate(pieces).size(); n < fewest) fewest = n, chosen = largest;
  Paginator paginator(chosen);
  const std::vector<Page> pages = paginator.paginate(pieces);
  const std::string title = clean_utf8(document.title);
  PdfPages out(title);
  for (std::size_t k = 0; k < pages.size(); ++k) {
    if (k > 0) out.next_page();
    draw_page(out, pages[k]);
    draw_footer(out.painter(), qt(title), k + 1, pages.size());
  }
  return out.finish();
}

}  // namespace pivnp::report

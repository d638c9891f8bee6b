#include "apps/report/document/pdf.hpp"

#include "apps/report/document/text.hpp"

#include <algorithm>
#include <deque>
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

constexpr double page_width = 2100, page_height = 2970, margin = 200, foot = 230;
constexpr double column_width = page_width - 2 * margin, bottom = page_height - foot;

struct Placed {
  const Piece* piece;
  double y;
  double scale = 1;
};
using Page = std::vector<Placed>;

// Fills pages from the top. A figure that does not fit waits for the head of the next page while the text goes on.
class Paginator {
 public:
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
  double height(std::span<const Piece> chain) const {
    double h = 0;
    for (const Piece& p : chain) h += (empty() && h == 0 ? 0 : p.before) + p.height;
    return h;
  }
  bool empty() const { return pages_.empty() || pages_.back().empty(); }
  bool fits(std::span<const Piece> chain) const {
    const double least = chain.size() == 1 ? chain[0].shrinks * (1 - least_scale) : 0;
    return y_ + height(chain) - least <= bottom;
  }

  void new_page() {
    pages_.emplace_back();
    y_ = margin;
    while (!waiting_.empty()) {
      const std::span<const Piece> figure(waiting_.front(), 1);
      if (!empty() && !fits(figure)) break;
      put(*waiting_.front());
      waiting_.pop_front();
    }
  }

  void put(const Piece& piece) {
    if (!empty()) y_ += piece.before;
    else if (piece.repeat)
      for (const Piece& head : *piece.repeat) {
        pages_.back().push_back({&head, y_});
        y_ += head.height;
      }
    const double over = y_ + piece.height - bottom;
    const double scale = over > 0 && piece.shrinks > 0 ? std::max(least_scale, 1 - over / piece.shrinks) : 1;
    pages_.back().push_back({&piece, y_, scale});
    y_ += piece.height - piece.shrinks * (1 - scale);
  }

  void place(std::span<const Piece> chain) {
    if (pages_.empty()) new_page();
    // Figures that wait may fill several pages before text has room again.
    while (!fits(chain) && !(empty() && waiting_.empty())) new_page();
    for (const Piece& piece : chain) {
      if (!empty() && y_ + piece.before + piece.height > bottom) new_page();  // a chain longer than a page
      put(piece);
    }
  }

  std::vector<Page> pages_;
  std::deque<const Piece*> waiting_;
  double y_ = margin;
};

void draw_footer(QPainter& painter, const QString& title, std::size_t page, std::size_t pages) {
  painter.setFont(qt_font(7));
  painter.setPen(qt_colour(faint));
  const QRectF line(margin, page_height - 150, column_width, 50);
  const QString number = QString("%1 / %2").arg(page).arg(pages);
  painter.drawText(line, Qt::AlignRight | Qt::AlignVCenter, number);
  painter.drawText(line, Qt::AlignLeft | Qt::AlignVCenter,
                   QFontMetricsF(qt_font(7)).elidedText(title, Qt::ElideRight, column_width - 200));
}

}  // namespace

std::string pdf(const Document& document) {
  start_qt();
  const Pieces pieces = cut(document, column_width);
  const std::vector<Page> pages = Paginator().paginate(pieces);
  const std::string title = clean_utf8(document.title);
  PdfPages out(title);
  for (std::size_t k = 0; k < pages.size(); ++k) {
    if (k > 0) out.next_page();
    for (const Placed& placed : pages[k])
      if (placed.piece->draw_scaled) placed.piece->draw_scaled(out, margin, placed.y, placed.scale);
      else placed.piece->draw(out, margin, placed.y);
    draw_footer(out.painter(), qt(title), k + 1, pages.size());
  }
  return out.finish();
}

}  // namespace pivnp::report

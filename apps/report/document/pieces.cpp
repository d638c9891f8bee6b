#include "apps/report/document/pieces.hpp"

#include "apps/report/document/text.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <QPainter>
#include <QTextLayout>

#include "apps/plot/qt.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr double body_points = 8.5, caption_points = 7.5, table_points = 7.0, note_points = 5.6, code_points = 6.6,
                 fine_points = 6.0, between_columns = 50;

constexpr Rgb tint = 0xf4f6f8;

double leading(double points) { return 1.46 * points * units_per_point; }

QString qt_text(const std::string& text) { return QString::fromStdString(clean_utf8(text)); }

// Text broken into lines.
struct Lines {
  std::shared_ptr<QTextLayout> layout;
  double leading = 0;
  Rgb rgb = ink;
  int count() const { return layout->lineCount(); }
  double height() const { return leading * count(); }
  void draw(PdfPages& pages, double x, double y, int line) const {
    const QTextLine l = layout->lineAt(line);
    pages.painter().setPen(qt_colour(rgb));
    l.draw(&pages.painter(), QPointF(x, y - l.y() + (leading - l.height()) / 2));
  }
  void draw_all(PdfPages& pages, double x, double y) const {
    for (int k = 0; k < count(); ++k) draw(pages, x, y + k * leading, k);
  }
};

Lines break_lines(const QString& text, const QFont& f, double width, double line_height, int bold_first = 0,
                  Qt::Alignment align = Qt::AlignLeft, Rgb rgb = ink) {
  // Even an empty text takes a line.
  Lines lines{std::make_shared<QTextLayout>(text.isEmpty() ? QStringLiteral(" ") : text, f), line_height, rgb};
  QTextOption option(align);
  option.setWrapMode(QTextOption::WrapAtWordBoundaryOrAnywhere);
  lines.layout->setTextOption(option);
  if (bold_first > 0) {
    QTextLayout::FormatRange range;
    range.start = 0;
    range.length = bold_first;
    range.format.setFontWeight(QFont::Bold);
    lines.layout->setFormats({range});
  }
  lines.layout->setCacheEnabled(true);
  lines.layout->beginLayout();
  double y = 0;
  for (QTextLine line = lines.layout->createLine(); line.isValid(); line = lines.layout->createLine()) {
    line.setLineWidth(width);
    line.setPosition(QPointF(0, y));
    y += line.height();
  }
  lines.layout->endLayout();
  return lines;
}

class Cutter {
 public:
  Cutter(Pieces& pieces, double width) : pieces_(pieces), width_(width) {}

  void title(const Document& d) {
    flow(break_lines(qt_text(d.title), qt_font(17, true), width_, leading(15)), 0, 0, true);
    flow(break_lines(qt_text(d.subtitle), qt_font(9), width_, leading(9), 0, Qt::AlignLeft, 0x5f6368), 0, 12, true);
  }

  void operator()(const Heading& h) {
    const double points = h.level == 1 ? 11.5 : 9;
    flow(break_lines(qt_text(h.text), qt_font(points, true), width_, leading(points)), 0, h.level == 1 ? 75 : 45, true,
         h.level == 1);
    after_heading_ = true;
  }

  void operator()(const Paragraph& p) {
    if (!p.lead) return flow(break_lines(qt_text(p.text), qt_font(body_points), width_, leading(body_points)), 0, gap(32));
    const Lines lines = break_lines(qt_text(p.text), qt_font(body_points + 0.5), width_ - 80, leading(body_points + 0.5));
    const double height = lines.height() + 60, width = width_;
    pieces_.push_back({.before = 45, .height = height, .draw = [=](PdfPages& pages, double x, double y) {
                         pages.painter().fillRect(QRectF(x, y, width, height), qt_colour(tint));
                         pages.painter().fillRect(QRectF(x, y, 8, height), qt_colour(0x0b3d91));
                         lines.draw_all(pages, x + 45, y + 30);
                       }});
  }

  void operator()(const List& list) {
    for (const std::string& item : list.items) {
      const Lines lines = break_lines(qt_text(item), qt_font(body_points), width_ - 40, leading(body_points));
      const std::size_t first = pieces_.size();
      flow(lines, 40, gap(18));
      const auto text = pieces_[first].draw;
      pieces_[first].draw = [=](PdfPages& pages, double x, double y) {
        QPainter& p = pages.painter();
        p.setPen(Qt::NoPen);
        p.setBrush(qt_colour(ink));
        p.drawEllipse(QPointF(x + 16, y + leading(body_points) * 0.5), 5, 5);
        text(pages, x, y);
      };
    }
  }

  void operator()(const Code& code) {
    QFont f = qt_font(code_points);
    f.setFamily(QStringLiteral("DejaVu Sans Mono"));
    std::vector<Lines> rows;
    for (const QString& row : qt_text(code.text).split('\n'))
      rows.push_back(break_lines(row.isEmpty() ? QStringLiteral(" ") : row, f, width_ - 60, 1.35 * code_points * units_per_point));
    columns(rows, 1, gap(30), true);
  }

  void operator()(const Definitions& d) {
    std::vector<Lines> items;
    const double line_height = 1.26 * note_points * units_per_point;
    for (const auto& [name, text] : d.items) {
      const QString label = name.empty() ? QString() : qt_text(name) + (d.run_in ? " " : ": ");
      items.push_back(break_lines(label + qt_text(text), qt_font(note_points), (width_ - between_columns) / 2, line_height, int(label.size()),
                                  Qt::AlignLeft, 0x404040));
    }
    columns(items, 2, gap(14), false);
  }

  void operator()(const Figure& f) { figures({&f}); }

  void operator()(const OnScreen&) {}

  void operator()(const CaseText& c) { (*this)(Definitions{sections_of(c.toml), true}); }

  /// Side by side, if there are two.
  void figures(const std::vector<const Figure*>& row) {
    struct Part {
      std::shared_ptr<const Canvas> canvas;
      Lines caption;
      double left, width;
    };
    std::vector<Part> parts;
    const double gap_between = units_per_mm * (figure_width_mm - 2 * half_figure_mm);
    double left = 0, drawn = 0, words = 0;
    for (const Figure* f : row) {
      const double width = f->canvas->width_mm() > half_figure_mm ? width_ : (width_ - gap_between) / 2;
      const QString label = QString("Figure %1.").arg(++figure_);
      parts.push_back({f->canvas, break_lines(label + " " + qt_text(f->caption), qt_font(caption_points), width,
                                               leading(caption_points), int(label.size())), left, width});
      left += width + gap_between;
      drawn = std::max(drawn, f->canvas->height_mm() * units_per_mm);
      words = std::max(words, parts.back().caption.height());
    }
    pieces_.push_back({.before = gap(45), .height = drawn + 15 + words + 20, .floats = true, .shrinks = drawn,
                       .draw_scaled = [=](PdfPages& pages, double x, double y, double scale) {
                         for (const Part& p : parts) {
                           const double own = p.canvas->height_mm() * units_per_mm;  // the lower edges are in line
                           pages.draw(*p.canvas, x + p.left + p.width * (1 - scale) / 2, y + (drawn - own) * scale, scale);
                           p.caption.draw_all(pages, x + p.left, y + drawn * scale + 15);
                         }
                       }});
  }

  void operator()(const Table& t) {
    const QString label = QString("Table %1.").arg(++table_);
    const Lines caption = break_lines(label + " " + qt_text(t.caption), qt_font(caption_points), width_,
                                      leading(caption_points), int(label.size()));
    flow(caption, 0, gap(60), true);
    auto head = std::make_shared<Pieces>();
    const bool headed = std::any_of(t.head.begin(), t.head.end(), [](const std::string& text) { return !text.empty(); });
    if (headed) {
      head->push_back(row(t, t.head, true, false));
      head->front().before = 14;
      pieces_.push_back(head->front());
      pieces_.back().keep_next = true;
    }
    for (std::size_t k = 0; k < t.rows.size(); ++k) {
      pieces_.push_back(
          row(t, t.rows[k], false, k + 1 == t.rows.size(), k < t.notes.size() ? t.notes[k] : std::string(),
              k < t.marked.size() ? t.marked[k] : std::nullopt, !headed && k == 0));
      pieces_.back().repeat = head;
      // Neither the first row nor the last stands alone; a short table stands whole.
      pieces_.back().keep_next = k + 1 < t.rows.size() && (k == 0 || k + 2 == t.rows.size() || t.rows.size() <= 10);
    }
    after_heading_ = false;
  }

 private:
  double gap(double usual) { return std::exchange(after_heading_, false) ? std::min(usual, 22.0) : usual; }

  // Items below each other, in columns.
  void columns(const std::vector<Lines>& items, std::size_t count, double before, bool tinted) {
    if (items.empty()) return;
    std::vector<std::pair<Lines, int>> all;
    for (const Lines& lines : items)
      for (int k = 0; k < lines.count(); ++k) all.emplace_back(lines, k);
    const double height = items[0].leading, width = width_, step = (width_ + between_columns) / double(count);
    const auto lines = std::make_shared<Columns>();
    lines->line_height = height, lines->count = count, lines->lines = all.size();
    lines->draw = [=](PdfPages& pages, double x, double y, std::size_t line, std::size_t column) {
      if (tinted) pages.painter().fillRect(QRectF(x, y, width, height + 0.5), qt_colour(tint));
      all[line].first.draw(pages, x + (tinted ? 30 : 0) + double(column) * step, y, all[line].second);
    };
    const std::size_t least = std::min<std::size_t>(4, (all.size() + count - 1) / count);
    pieces_.push_back({.before = before, .height = height * double(least), .columns = lines});
    after_heading_ = false;
  }

  // Lines as pieces: neither the first nor the last stands alone on a page.
  void flow(const Lines& lines, double indent, double before, bool keep_all = false, bool barrier = false) {
    const int n = lines.count();
    for (int k = 0; k < n; ++k)
      pieces_.push_back({.before = k == 0 ? before : 0,
                         .height = lines.leading,
                         .keep_next = keep_all || (k + 1 < n && (k == 0 || k + 2 == n)),
                         .barrier = barrier && k == 0,
                         .draw = [=](PdfPages& pages, double x, double y) { lines.draw(pages, x + indent, y, k); }});
  }

  // `marked`: the cell that is set off, if any; `first`: of a table without a head.
  Piece row(const Table& t, const std::vector<std::string>& cells, bool head, bool last,
            const std::string& remark = "", std::optional<std::size_t> marked = std::nullopt, bool first = false) const {
    const double pad = t.fine ? 3 : 8, between = 26, width = width_, points = t.fine ? fine_points : table_points;
    std::vector<Lines> texts;
    std::vector<double> at;
    double x = 0, height = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double w = t.width[k] * width_ - (k + 1 < cells.size() ? between : 0);
      texts.push_back(break_lines(qt_text(cells[k]), qt_font(points, head || marked == k), w,
                                  1.36 * points * units_per_point, 0,
                                  t.align[k] == 'r' ? Qt::AlignRight : Qt::AlignLeft, marked == k ? 0xa40d24 : ink));
      at.push_back(x);
      x += t.width[k] * width_;
      height = std::max(height, texts.back().height());
    }
    const double above = height;
    const Lines note = break_lines(qt_text(remark), qt_font(note_points), width_,
                                   1.3 * note_points * units_per_point, 0, Qt::AlignLeft, faint);
    if (!remark.empty()) height += 3 + note.height();
    height += 2 * pad;
    const bool noted = !remark.empty(), opens = first;
    return {.height = height, .draw = [=](PdfPages& pages, double left, double y) {
              for (std::size_t k = 0; k < texts.size(); ++k) texts[k].draw_all(pages, left + at[k], y + pad);
              if (noted) note.draw_all(pages, left, y + pad + above + 3);
              const auto rule = [&](double at_y, const Pen& pen) {
                pages.painter().setPen(qt_pen(pen));
                pages.painter().drawLine(QLineF(left, at_y, left + width, at_y));
              };
              if (head || opens) rule(y, {ink, 0.9});
              rule(y + height, head ? Pen{ink, 0.5} : last ? Pen{ink, 0.9} : Pen{0xe2e2e2, 0.4});
            }};
  }

  Pieces& pieces_;
  double width_;
  int figure_ = 0, table_ = 0;
  bool after_heading_ = false;
};

}  // namespace

Pieces cut(const Document& document, double width) {
  Pieces pieces;
  Cutter cutter(pieces, width);
  cutter.title(document);
  const auto half = [&](std::size_t k) {
    const Figure* f = k < document.blocks.size() ? std::get_if<Figure>(&document.blocks[k]) : nullptr;
    return f != nullptr && f->canvas->width_mm() <= half_figure_mm ? f : nullptr;
  };
  for (std::size_t k = 0; k < document.blocks.size(); ++k) {
    if (half(k) && half(k + 1)) cutter.figures({half(k), half(k + 1)}), ++k;
    else std::visit(cutter, document.blocks[k]);
  }
  return pieces;
}

}  // namespace pivnp::report

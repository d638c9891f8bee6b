#include "apps/report/document/pieces.hpp"

#include "apps/report/document/text.hpp"

#include <algorithm>
#include <utility>

#include <QTextLayout>

#include "apps/plot/canvas.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/record/metric.hpp"

namespace pivnp::report {

namespace {

constexpr double body_points = 8.5, caption_points = 7.5, table_points = 7.0, note_points = 6.0, code_points = 6.6;

double leading(double points) { return 1.46 * points * units_per_point; }

QString qt_text(const std::string& text) { return QString::fromStdString(clean_utf8(text)); }

// Text broken into lines.
struct Lines {
  std::shared_ptr<QTextLayout> layout;
  double leading = 0;
  Rgb rgb = ink;
  int count() const { return layout->lineCount(); }
  double height() const { return leading * count(); }
  void draw(QCPPainter& p, double x, double y, int line) const {
    const QTextLine l = layout->lineAt(line);
    p.setPen(colour(rgb));
    l.draw(&p, QPointF(x, y - l.y() + (leading - l.height()) / 2));
  }
  void draw_all(QCPPainter& p, double x, double y) const {
    for (int k = 0; k < count(); ++k) draw(p, x, y + k * leading, k);
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
    flow(break_lines(qt_text(d.title), font(17, true), width_, leading(15)), 0, 0, true);
    flow(break_lines(qt_text(d.subtitle), font(9), width_, leading(9), 0, Qt::AlignLeft, 0x5f6368), 0, 12, true);
  }

  void operator()(const Heading& h) {
    const double points = h.level == 1 ? 11.5 : 9;
    flow(break_lines(qt_text(h.text), font(points, true), width_, leading(points)), 0, h.level == 1 ? 75 : 45, true,
         h.level == 1);
    after_heading_ = true;
  }

  void operator()(const Paragraph& p) {
    if (!p.lead) return flow(break_lines(qt_text(p.text), font(body_points), width_, leading(body_points)), 0, gap(32));
    const Lines lines = break_lines(qt_text(p.text), font(body_points + 0.5), width_ - 80, leading(body_points + 0.5));
    const double height = lines.height() + 60, width = width_;
    pieces_.push_back({45, height, false, false, false,
                       [=](QCPPainter& q, double x, double y) {
                         q.fillRect(QRectF(x, y, width, height), QColor(0xf4, 0xf6, 0xf8));
                         q.fillRect(QRectF(x, y, 8, height), colour(0x0b3d91));
                         lines.draw_all(q, x + 45, y + 30);
                       },
                       nullptr});
  }

  void operator()(const List& list) {
    for (const std::string& item : list.items) {
      const Lines lines = break_lines(qt_text(item), font(body_points), width_ - 40, leading(body_points));
      const std::size_t first = pieces_.size();
      flow(lines, 40, gap(18));
      const auto text = pieces_[first].draw;
      pieces_[first].draw = [=](QCPPainter& p, double x, double y) {
        p.setPen(Qt::NoPen);
        p.setBrush(colour(ink));
        p.drawEllipse(QPointF(x + 16, y + leading(body_points) * 0.5), 5, 5);
        text(p, x, y);
      };
    }
  }

  void operator()(const Code& code) {
    QFont f = font(code_points);
    f.setFamily(QStringLiteral("DejaVu Sans Mono"));
    double before = gap(30);
    const double width = width_, line_height = 1.35 * code_points * units_per_point;
    for (const QString& row : qt_text(code.text).split('\n')) {
      const Lines lines = break_lines(row.isEmpty() ? QStringLiteral(" ") : row, f, width_ - 60, line_height);
      for (int k = 0; k < lines.count(); ++k) {
        pieces_.push_back({before, line_height, false, false, false,
                           [=](QCPPainter& p, double x, double y) {
                             p.fillRect(QRectF(x, y, width, line_height + 0.5), QColor(0xf4, 0xf6, 0xf8));
                             lines.draw(p, x + 30, y, k);
                           },
                           nullptr});
        before = 0;
      }
    }
    after_heading_ = false;
  }

  void operator()(const Figure& f) {
    const QString label = QString("Figure %1.").arg(++figure_);
    const Lines caption = break_lines(label + " " + qt_text(f.caption), font(caption_points), width_,
                                      leading(caption_points), int(label.size()));
    const auto sheet = f.sheet;
    const double drawn = sheet->height_mm() * units_per_mm;
    pieces_.push_back({gap(60), drawn + 25 + caption.height() + 30, false, true, false,
                       [=](QCPPainter& p, double x, double y) {
                         p.save();
                         p.translate(x, y);
                         sheet->draw(p);
                         p.restore();
                         caption.draw_all(p, x, y + drawn + 25);
                       },
                       nullptr});
  }

  void operator()(const Table& t) {
    const QString label = QString("Table %1.").arg(++table_);
    const Lines caption = break_lines(label + " " + qt_text(t.caption), font(caption_points), width_,
                                      leading(caption_points), int(label.size()));
    flow(caption, 0, gap(60), true);
    auto head = std::make_shared<Pieces>();
    head->push_back(row(t, t.head, true, false));
    head->front().before = 14;
    pieces_.push_back(head->front());
    pieces_.back().keep_next = true;
    for (std::size_t k = 0; k < t.rows.size(); ++k) {
      pieces_.push_back(
          row(t, t.rows[k], false, k + 1 == t.rows.size(), k < t.notes.size() ? t.notes[k] : std::string()));
      pieces_.back().repeat = head;
      // Neither the first row nor the last stands alone.
      pieces_.back().keep_next = k + 1 < t.rows.size() && (k == 0 || k + 2 == t.rows.size());
    }
    after_heading_ = false;
  }

 private:
  double gap(double usual) { return std::exchange(after_heading_, false) ? std::min(usual, 22.0) : usual; }

  // Lines as pieces: neither the first nor the last stands alone on a page.
  void flow(const Lines& lines, double indent, double before, bool keep_all = false, bool barrier = false) {
    const int n = lines.count();
    for (int k = 0; k < n; ++k)
      pieces_.push_back({k == 0 ? before : 0, lines.leading, keep_all || (k + 1 < n && (k == 0 || k + 2 == n)), false,
                         barrier && k == 0, [=](QCPPainter& p, double x, double y) { lines.draw(p, x + indent, y, k); },
                         nullptr});
  }

  Piece row(const Table& t, const std::vector<std::string>& cells, bool head, bool last,
            const std::string& remark = "") const {
    const double pad = 9, between = 26, width = width_;
    std::vector<Lines> texts;
    std::vector<double> at;
    double x = 0, height = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double w = t.width[k] * width_ - (k + 1 < cells.size() ? between : 0);
      const bool over = cells[k] == name_of(Verdict::exceeded);
      texts.push_back(break_lines(qt_text(cells[k]), font(table_points, head || over), w,
                                  1.36 * table_points * units_per_point, 0,
                                  t.align[k] == 'r' ? Qt::AlignRight : Qt::AlignLeft, over ? 0xa40d24 : ink));
      at.push_back(x);
      x += t.width[k] * width_;
      height = std::max(height, texts.back().height());
    }
    const double above = height;
    const Lines note = break_lines(qt_text(remark), font(note_points), width_,
                                   1.3 * note_points * units_per_point, 0, Qt::AlignLeft, faint);
    if (!remark.empty()) height += 3 + note.height();
    height += 2 * pad;
    const bool noted = !remark.empty();
    return {0,
            height,
            false,
            false,
            false,
            [=](QCPPainter& p, double left, double y) {
              for (std::size_t k = 0; k < texts.size(); ++k) texts[k].draw_all(p, left + at[k], y + pad);
              if (noted) note.draw_all(p, left, y + pad + above + 3);
              auto rule = [&](double at_y, const QPen& line) {
                p.setPen(line);
                p.drawLine(QLineF(left, at_y, left + width, at_y));
              };
              if (head) rule(y, pen(ink, 0.9));
              rule(y + height, head ? pen(ink, 0.5) : last ? pen(ink, 0.9) : pen(0xe2e2e2, 0.4));
            },
            nullptr};
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
  for (const Block& block : document.blocks) std::visit(cutter, block);
  return pieces;
}

}  // namespace pivnp::report

// Status and score of the vectors, pair by pair.
#include <algorithm>
#include <cmath>

#include "apps/plot/parts.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

std::optional<Figure> quality_figure(const Content&, const std::vector<PairQuality>& pairs) {
  if (pairs.empty()) return std::nullopt;
  auto sheet = std::make_shared<Sheet>(figure_width_mm, 100);
  const double x = 17, w = 150;
  QCPAxisRect* shares = sheet->panel(x, 9, w, 36);
  QCPAxisRect* scores = sheet->panel(x, 53, w, 36);
  const double first = pairs.front().frames[0] - 0.5,
               last = std::max(pairs.back().frames[0], pairs.front().frames[0]) + 0.5;
  for (QCPAxisRect* panel : {shares, scores}) {
    QCPAxis* axis = panel->axis(QCPAxis::atBottom);
    set_axis(axis, first, last, panel == scores ? "first frame of the pair" : "", 10);
    set_step(axis, std::max(1.0, nice_step(last - first, 12)));
    axis->setTickLabels(panel == scores);
  }
  set_axis(shares->axis(QCPAxis::atLeft), 0, 100, "share of nodes (%)", 5);
  double low = 0;
  for (const PairQuality& q : pairs)
    if (std::isfinite(q.score_low)) low = std::min(low, q.score_low);
  set_axis(scores->axis(QCPAxis::atLeft), low < 0 ? std::floor(low * 5) / 5 : 0, 1, "correlation score", 5);
  pale_grid(scores);

  constexpr Rgb valid = 0xb9cfe4, replaced = orange, rejected = red, failed = 0x4a2545, flagged = 0xffd9d4;
  bool any_flag = false;
  for (const PairQuality& q : pairs) any_flag = any_flag || q.flag != 0;
  sheet->paint(shares, [=](QCPPainter& p) {
    p.setPen(Qt::NoPen);
    for (const PairQuality& q : pairs) {
      const double at = q.frames[0];
      double base = 0;
      auto bar = [&](std::size_t n, Rgb rgb) {
        const double top = base + 100 * q.share(n);
        p.setBrush(colour(rgb));
        p.drawRect(QRectF(QPointF(x_of(shares, at - 0.4), y_of(shares, top)),
                          QPointF(x_of(shares, at + 0.4), y_of(shares, base))));
        base = top;
      };
      if (q.nodes == 0) continue;
      bar(q.valid, valid);
      bar(q.replaced, replaced);
      bar(q.rejected, rejected);
      bar(q.failed, failed);
    }
  });
  if (any_flag) {
    sheet->paint(scores, [=](QCPPainter& p) {
      p.setPen(Qt::NoPen);
      p.setBrush(colour(flagged));
      for (const PairQuality& q : pairs)
        if (q.flag != 0)
          p.drawRect(QRectF(QPointF(x_of(scores, q.frames[0] - 0.5), double(scores->top())),
                            QPointF(x_of(scores, q.frames[0] + 0.5), double(scores->bottom()))));
    });
    sheet->paint_over([=](QCPPainter& p) {
      p.setPen(Qt::NoPen);
      p.setBrush(colour(red));
      for (const PairQuality& q : pairs) {
        if (q.flag == 0) continue;
        const double at = x_of(shares, q.frames[0]), y = shares->top() - 3;
        p.drawPolygon(QPolygonF({{at - 9, y - 16}, {at + 9, y - 16}, {at, y}}));
      }
    });
  }
  std::vector<double> at, median, lower, upper;
  for (const PairQuality& q : pairs) {
    at.push_back(q.frames[0]);
    median.push_back(q.score_median);
    lower.push_back(q.score_low);
    upper.push_back(q.score_high);
  }
  band(*sheet, scores, at, lower, upper, blue, 45);
  QCPGraph* g = curve(*sheet, scores, at, median, pen(blue, 1.2));
  if (pairs.size() <= 60)
    g->setScatterStyle(
        QCPScatterStyle(QCPScatterStyle::ssCircle, pen(blue, 0.8), QBrush(Qt::white), 1.5 * units_per_mm));

  double next = x;
  next = draw_key(*sheet, next, 2.5, Key::tile, valid, "valid");
  next = draw_key(*sheet, next, 2.5, Key::tile, replaced, "replaced");
  next = draw_key(*sheet, next, 2.5, Key::tile, rejected, "rejected");
  next = draw_key(*sheet, next, 2.5, Key::tile, failed, "failed");
  if (any_flag) draw_key(*sheet, next, 2.5, Key::tile, flagged, "flagged step");
  next = draw_key(*sheet, x, 49.5, Key::line, blue, "median");
  draw_key(*sheet, next, 49.5, Key::band, blue, QString::fromUtf8("5th to 95th percentile"));
  sheet->text(x - 15, 6, "(a)", Qt::AlignLeft | Qt::AlignTop, normal_text, true);
  sheet->text(x - 15, 50, "(b)", Qt::AlignLeft | Qt::AlignTop, normal_text, true);
  std::string caption =
      "Quality of the measurement, pair by pair: (a) status of the vectors at the nodes that were not masked; (b) "
      "correlation score of the valid ones.";
  if (any_flag) caption += " Marked steps are flagged as a whole.";
  return Figure{"quality", caption, sheet};
}

}  // namespace pivnp::report

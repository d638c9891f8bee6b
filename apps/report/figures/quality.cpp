// Status and score of the vectors, pair by pair.
#include <algorithm>
#include <cmath>

#include "apps/plot/marks.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr Rgb valid_bar = 0xb9cfe4, replaced_bar = orange, rejected_bar = red, failed_bar = 0x4a2545, flagged_bar = 0xffd9d4;

void draw_shares(Canvas& canvas, const Panel& panel, const std::vector<PairQuality>& pairs) {
  canvas.paint(panel, [=](Painter& p) {
    p.no_pen();
    for (const PairQuality& q : pairs) {
      const double at = q.frames[0];
      double base = 0;
      const auto bar = [&](std::size_t n, Rgb rgb) {
        const double top = base + 100 * q.share(n);
        p.fill({rgb});
        p.rectangle(between(panel.at({at - 0.4, top}), panel.at({at + 0.4, base})));
        base = top;
      };
      if (q.nodes == 0) continue;
      bar(q.valid, valid_bar);
      bar(q.replaced, replaced_bar);
      bar(q.rejected, rejected_bar);
      bar(q.failed, failed_bar);
    }
  });
}

void mark_flags(Canvas& canvas, const Panel& shares, const Panel& scores, const std::vector<PairQuality>& pairs) {
  canvas.paint(scores, [=](Painter& p) {
    p.no_pen();
    p.fill({flagged_bar});
    const Rectangle frame = scores.frame();
    for (const PairQuality& q : pairs)
      if (q.flag != 0)
        p.rectangle(between({scores.x(q.frames[0] - 0.5), frame.top}, {scores.x(q.frames[0] + 0.5), frame.bottom()}));
  });
  canvas.paint_over([=](Painter& p) {
    p.no_pen();
    p.fill({red});
    for (const PairQuality& q : pairs) {
      if (q.flag == 0) continue;
      const double at = shares.x(q.frames[0]), y = shares.frame().top - 3;
      p.polygon({{at - 9, y - 16}, {at + 9, y - 16}, {at, y}});
    }
  });
}

std::vector<Figure> draw_quality(const FigureInput& input) {
  const std::vector<PairQuality>& pairs = input.pairs;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, 62);
  const double x = 17, w = 62;
  Panel shares = canvas->panel(x, 10, w, 14), scores = canvas->panel(x, 35, w, 14);
  const double first = pairs.front().frames[0] - 0.5,
               last = std::max(pairs.back().frames[0], pairs.front().frames[0]) + 0.5;
  shares.axis(Axis::x, first, last, "").numbers(Axis::x, false);
  scores.axis(Axis::x, first, last, "first frame of the pair");
  for (Panel* panel : {&shares, &scores}) panel->step(Axis::x, std::max(1.0, nice_step(last - first, 6)));
  shares.axis(Axis::y, 0, 100, "share (%)", 3);
  double low = 0;
  for (const PairQuality& q : pairs)
    if (std::isfinite(q.score_low)) low = std::min(low, q.score_low);
  scores.axis(Axis::y, low < 0 ? std::floor(low * 5) / 5 : 0, 1, "score", 3).pale_grid();

  const bool any_flag = std::any_of(pairs.begin(), pairs.end(), [](const PairQuality& q) { return q.flag != 0; });
  draw_shares(*canvas, shares, pairs);
  if (any_flag) mark_flags(*canvas, shares, scores, pairs);
  std::vector<double> at, median, lower, upper;
  for (const PairQuality& q : pairs) {
    at.push_back(q.frames[0]);
    median.push_back(q.score_median);
    lower.push_back(q.score_low);
    upper.push_back(q.score_high);
  }
  band(*canvas, scores, at, lower, upper, {blue, 45});
  std::optional<Symbol> symbol;
  if (pairs.size() <= 60) symbol = Symbol{.marker = Marker::circle, .pen = {blue, 0.8}, .size_mm = 1.5};
  canvas->curve(scores, at, median, {blue, 1.2}, symbol);

  legend(*canvas, x, 2.5, Key::tile, valid_bar, "valid");
  legend(*canvas, x + 22, 2.5, Key::tile, replaced_bar, "replaced");
  if (any_flag) legend(*canvas, x + 44, 2.5, Key::tile, flagged_bar, "flagged step");
  legend(*canvas, x, 7, Key::tile, rejected_bar, "rejected");
  legend(*canvas, x + 22, 7, Key::tile, failed_bar, "failed");
  const double next = legend(*canvas, x, 31, Key::line, blue, "median");
  legend(*canvas, next, 31, Key::band, blue, "5th to 95th percentile");
  canvas->text(x - 15, 7, "(a)", Align::top_left, {.bold = true});
  canvas->text(x - 15, 31, "(b)", Align::top_left, {.bold = true});
  std::string caption =
      "Quality of the measurement, pair by pair: (a) status of the vectors at the nodes " +
      std::string(pairs.front().material_known ? "in the material" : "that were not masked") +
      "; (b) correlation score of the valid ones.";
  if (any_flag) caption += " Marked steps are flagged as a whole.";
  const auto shares_of = [&](std::size_t PairQuality::*count) {
    std::vector<double> list;
    for (const PairQuality& q : pairs) list.push_back(q.share(q.*count));
    return list;
  };
  return {{caption, canvas, {}, {},
           {{"first frame", "", at}, {"valid", "", shares_of(&PairQuality::valid)},
            {"replaced", "", shares_of(&PairQuality::replaced)}, {"rejected", "", shares_of(&PairQuality::rejected)},
            {"failed", "", shares_of(&PairQuality::failed)}, {"score, median", "", median},
            {"score, 5th percentile", "", lower}, {"score, 95th percentile", "", upper}}}};
}

}  // namespace

FigureRow quality_row() {
  return {.name = "quality",
          .shows = "status and correlation score of the vectors, pair by pair",
          .section = Section::measurement,
          .applies = [](const FigureInput& i) { return !i.pairs.empty(); },
          .draw = draw_quality};
}

}  // namespace pivnp::report

// A frame under the vectors of one pair.
#include <algorithm>
#include <cmath>

#include "apps/plot/numbers.hpp"
#include "apps/plot/parts.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

namespace {

constexpr Rgb valid_colour = 0x0b3d91, replaced_colour = vermilion, rejected_colour = red, failed_colour = purple;

// An arrow from tail to tip in sheet units; a dot if it is too short to have a head.
void draw_arrow(QCPPainter& p, const QPointF& tail, const QPointF& tip, Rgb rgb) {
  const QPointF d = tip - tail;
  const double length = std::hypot(d.x(), d.y());
  if (!std::isfinite(length)) return;
  if (length < 3) {
    p.setPen(Qt::NoPen);
    p.setBrush(colour(rgb));
    p.drawEllipse((tail + tip) / 2, 1.8, 1.8);
    return;
  }
  const double head = std::min(11.0, 0.45 * length), half = 0.36 * head;
  const QPointF e = d / length, n(-e.y(), e.x()), neck = tip - head * e;
  for (const bool halo : {true, false}) {
    p.setPen(halo ? pen(0xffffff, 1.5) : pen(rgb, 0.75));
    p.drawLine(QLineF(tail, neck));
    p.setPen(halo ? pen(0xffffff, 0.7) : QPen(Qt::NoPen));
    p.setBrush(halo ? QBrush(Qt::white) : QBrush(colour(rgb)));
    p.drawPolygon(QPolygonF({tip, neck + half * n, neck - half * n}));
  }
}

void draw_cross(QCPPainter& p, const QPointF& c, Rgb rgb) {
  const double r = 5.5;
  for (const bool halo : {true, false}) {
    p.setPen(halo ? pen(0xffffff, 1.8) : pen(rgb, 0.9));
    p.drawLine(QLineF(c.x() - r, c.y() - r, c.x() + r, c.y() + r));
    p.drawLine(QLineF(c.x() - r, c.y() + r, c.x() + r, c.y() - r));
  }
}

void draw_ring(QCPPainter& p, const QPointF& c, Rgb rgb) {
  p.setBrush(Qt::NoBrush);
  for (const bool halo : {true, false}) {
    p.setPen(halo ? pen(0xffffff, 1.6) : pen(rgb, 0.8));
    p.drawEllipse(c, 5.0, 5.0);
  }
}

struct Plan {
  int stride = 1;         // every stride-th node in both directions
  double units_each = 0;  // sheet units of arrow to one length unit; 0: nothing moves
  double typical = 0;     // 95th percentile of the usable vectors
};

Plan plan_arrows(const VectorField& field, double units_per_length) {
  Plan plan;
  const double node = std::min(field.grid.spacing.x(), field.grid.spacing.y()) * units_per_length;
  if (node > 0) plan.stride = std::max(1, int(std::ceil(31 / node)));
  std::vector<double> magnitude;
  for (std::size_t n = 0; n < field.status.size(); ++n)
    if (usable(field.status[n]))
      magnitude.push_back(std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1])));
  plan.typical = quantile(magnitude, 0.95);
  if (std::isfinite(plan.typical) && plan.typical > 0)
    plan.units_each = std::clamp(1.6 * plan.stride * node, 40.0, 90.0) / plan.typical;
  return plan;
}

void draw_vectors(Sheet& sheet, QCPAxisRect* panel, const VectorField& field, const Plan& plan) {
  sheet.paint(panel, [=](QCPPainter& p) {
    auto place = [&](int i, int j) {
      const Vec2 x = field.grid.position(i, j);
      return QPointF(x_of(panel, x.x()), y_of(panel, x.y()));
    };
    const int first_i = (field.grid.nx - 1) % plan.stride / 2, first_j = (field.grid.ny - 1) % plan.stride / 2;
    for (const VectorStatus wanted : {VectorStatus::valid, VectorStatus::replaced})
      for (int j = first_j; j < field.grid.ny; j += plan.stride)
        for (int i = first_i; i < field.grid.nx; i += plan.stride) {
          const std::size_t n = field.grid.node(i, j);
          if (field.status[n] != wanted) continue;
          const QPointF at = place(i, j);
          const QPointF d(double(field.displacement[n][0]) * plan.units_each,
                          -double(field.displacement[n][1]) * plan.units_each);
          const QPointF tail = field.anchor == Anchor::central ? at - d / 2 : at;
          draw_arrow(p, tail, tail + d, wanted == VectorStatus::valid ? valid_colour : replaced_colour);
        }
    // What was not measured is rare and matters: no node is left out.
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const VectorStatus s = field.status[field.grid.node(i, j)];
        if (s == VectorStatus::rejected) draw_cross(p, place(i, j), rejected_colour);
        if (s == VectorStatus::failed) draw_ring(p, place(i, j), failed_colour);
      }
  });
}

void draw_legend(Sheet& sheet, double x, double right, const PairQuality& q, const Plan& plan,
                 const std::string& unit) {
  struct Entry {
    const char* words;
    std::size_t n;
    Rgb rgb;
    int form;  // 0 arrow, 1 cross, 2 ring
  };
  for (const Entry& e :
       {Entry{"valid", q.valid, valid_colour, 0}, Entry{"replaced", q.replaced, replaced_colour, 0},
        Entry{"rejected", q.rejected, rejected_colour, 1}, Entry{"failed", q.failed, failed_colour, 2}}) {
    if (e.n == 0) continue;
    const double at = x;
    sheet.paint_over([=](QCPPainter& p) {
      const QPointF c((at + 3) * units_per_mm, 3.2 * units_per_mm);
      if (e.form == 0) draw_arrow(p, c - QPointF(27, 0), c + QPointF(27, 0), e.rgb);
      if (e.form == 1) draw_cross(p, c, e.rgb);
      if (e.form == 2) draw_ring(p, c, e.rgb);
    });
    const QString words = qt(std::string(e.words) + " " + percent(q.share(e.n)));
    sheet.text(at + 7, 3.2, words, Qt::AlignLeft | Qt::AlignVCenter, small_text);
    x = at + 7 + text_width(words, small_text) + 5;
  }
  if (plan.units_each <= 0) {
    sheet.text(right, 3.2, "no motion", Qt::AlignRight | Qt::AlignVCenter, small_text);
    return;
  }
  const double reference = nice_length(plan.typical);
  const DisplayUnit shown = display_unit(unit, reference);
  const QString words = qt(number(reference * shown.factor, 1) + unit_suffix(shown.name));
  sheet.text(right, 3.2, words, Qt::AlignRight | Qt::AlignVCenter, small_text);
  const double tip = right - text_width(words, small_text) - 2;
  sheet.paint_over([=](QCPPainter& p) {
    const QPointF end(tip * units_per_mm, 3.2 * units_per_mm);
    draw_arrow(p, end - QPointF(reference * plan.units_each, 0), end, ink);
  });
}

}  // namespace

std::vector<Figure> vector_figures(const Content& content, const std::vector<PairQuality>& pairs) {
  std::vector<Figure> figures;
  for (const Picture& picture : content.pictures) {
    if (picture.image.empty()) continue;
    std::size_t at = pairs.size();
    for (const std::size_t end : {0u, 1u})
      for (std::size_t k = 0; k < pairs.size() && at == pairs.size(); ++k)
        if (pairs[k].frames[end] == picture.frame) at = k;
    if (at == pairs.size()) continue;
    const VectorField field = content.pair(at);

    const Box box = image_box(picture.image.width(), picture.image.height(), content.world_from_pixel);
    const double left = 15, right = 3, head = 7, foot = 11, aspect = box.height() / box.width();
    const double w = std::min(figure_width_mm - left - right, (124 - head - foot) / aspect), h = w * aspect;
    const double x = left + (figure_width_mm - left - right - w) / 2;
    auto sheet = std::make_shared<Sheet>(figure_width_mm, head + h + foot);
    QCPAxisRect* panel = world_panel(*sheet, x, head, w, h, box, content.length_unit, true, true);
    const int pixels = std::clamp(int(w / 25.4 * 220), 64, 1400);
    raster_in(*sheet, panel,
              to_image(draw_image(picture.image.view(), content.world_from_pixel, box, pixels, 120, 252)));
    const Plan plan = plan_arrows(field, w * units_per_mm / box.width());
    draw_vectors(*sheet, panel, field, plan);
    draw_scale_bar(*sheet, panel, box, content.length_unit);
    draw_legend(*sheet, x, x + w, pairs[at], plan, content.length_unit);

    auto frame_words = [&](int k) {
      const auto n = std::size_t(k);
      return k >= 0 && n < content.frames.size() && !content.frames[n].name.empty() ? content.frames[n].name
                                                                                    : "frame " + std::to_string(k);
    };
    std::string caption =
        "Increments measured from " + frame_words(field.pair[0]) + " to " + frame_words(field.pair[1]);
    if (const auto n = std::size_t(std::max(0, field.pair[0])); n < content.frames.size())
      caption += ", t = " + plain(content.frames[n].time) + unit_suffix(content.time_unit);
    caption += ", on " + frame_words(picture.frame) + " (contrast softened).";
    if (plan.stride > 1)
      caption += " Arrows: every " +
                 std::string(plan.stride == 2   ? "second"
                             : plan.stride == 3 ? "third"
                                                : std::to_string(plan.stride) + "th") +
                 " node in both directions.";
    caption += " Shares in the legend are of all " + count(pairs[at].nodes, "node") + " that were not masked.";
    if (pairs[at].rejected + pairs[at].failed > 0) caption += " Rejected and failed nodes are all marked.";
    if (pairs[at].flag != 0) caption += " This step is flagged; its vectors are not to be trusted.";
    figures.push_back({"vectors_" + std::to_string(figures.size() + 1), caption, sheet});
  }
  return figures;
}

}  // namespace pivnp::report

// A frame under the vectors of one pair.
#include <algorithm>
#include <cmath>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/plot/raster.hpp"
#include "apps/report/content/material.hpp"
#include "apps/report/figures/rows.hpp"
#include "apps/report/figures/vector_layer.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr Rgb valid_colour = 0x0b3d91, replaced_colour = vermilion, rejected_colour = red, failed_colour = purple;

constexpr double cross_size = 5.5;  // half a side, canvas units

void draw_cross(Painter& p, const Vec2& c, Rgb rgb, double half = cross_size) {
  const Vec2 falling(half, half), rising(half, -half);
  for (const bool halo : {true, false}) {
    p.pen(halo ? Pen{0xffffff, 1.8} : Pen{rgb, 0.9});
    p.line(c - falling, c + falling);
    p.line(c - rising, c + rising);
  }
}

void draw_ring(Painter& p, const Vec2& c, Rgb rgb, double half = cross_size) {
  p.no_fill();
  for (const bool halo : {true, false}) {
    p.pen(halo ? Pen{0xffffff, 1.6} : Pen{rgb, 0.8});
    p.ellipse(c, half - 0.5, half - 0.5);
  }
}

struct Plan {
  int stride = 1;         // every stride-th node in both directions
  double units_each = 0;  // canvas units of arrow to one length unit; 0: nothing moves
  double typical = 0;     // 95th percentile of the usable vectors
};

Plan plan_arrows(const VectorField& field, double units_per_length) {
  Plan plan;
  const double node = std::min(field.grid.spacing.x(), field.grid.spacing.y()) * units_per_length;
  if (node > 0) plan.stride = std::max(1, int(std::ceil(23 / node)));
  std::vector<double> magnitude;
  for (std::size_t n = 0; n < field.status.size(); ++n)
    if (usable(field.status[n]))
      magnitude.push_back(std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1])));
  plan.typical = quantile(magnitude, 0.95);
  if (std::isfinite(plan.typical) && plan.typical > 0)
    plan.units_each = std::clamp(1.7 * plan.stride * node, 36.0, 80.0) / plan.typical;
  return plan;
}

// Status as a reader sees it: nodes in front of no material are masked.
VectorField within_material(const Content& content, VectorField field) {
  const std::vector<std::uint8_t> material = nodes_in_material(content, field);
  for (std::size_t n = 0; n < material.size(); ++n)
    if (!material[n]) field.status[n] = VectorStatus::masked;
  return field;
}

void draw_vectors(Canvas& canvas, const Panel& panel, const VectorField& field, const Plan& plan) {
  canvas.paint(panel, [=](Painter& p) {
    const auto place = [&](int i, int j) { return panel.at(field.grid.position(i, j)); };
    const int first_i = (field.grid.nx - 1) % plan.stride / 2, first_j = (field.grid.ny - 1) % plan.stride / 2;
    for (const VectorStatus wanted : {VectorStatus::valid, VectorStatus::replaced})
      for (int j = first_j; j < field.grid.ny; j += plan.stride)
        for (int i = first_i; i < field.grid.nx; i += plan.stride) {
          const std::size_t n = field.grid.node(i, j);
          if (field.status[n] != wanted) continue;
          const Vec2 at = place(i, j);
          const Vec2 d(double(field.displacement[n][0]) * plan.units_each,
                       -double(field.displacement[n][1]) * plan.units_each);
          const Vec2 tail = field.anchor == Anchor::central ? Vec2(at - d / 2) : at;
          arrow(p, tail, tail + d, wanted == VectorStatus::valid ? valid_colour : replaced_colour);
        }
    // What was not measured is rare and matters: no node is left out. Where nodes are close, marks shrink and stay apart.
    const Vec2 next = panel.at(field.grid.position(1, 1)) - panel.at(field.grid.position(0, 0));
    const double half = std::clamp(0.4 * std::min(std::abs(next.x()), std::abs(next.y())), 1.6, cross_size);
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const VectorStatus s = field.status[field.grid.node(i, j)];
        if (s == VectorStatus::rejected) draw_cross(p, place(i, j), rejected_colour, half);
        if (s == VectorStatus::failed) draw_ring(p, place(i, j), failed_colour, half);
      }
  });
}

constexpr double legend_row = 4.4;  // mm

struct LegendEntry {
  std::string words;
  void (*draw)(Painter&, const Vec2&);
  double x = 0, y = 0;  // mm
};

// In as many rows as the width asks for.
std::vector<LegendEntry> legend_of(const PairQuality& q, double left, double right) {
  constexpr double mark = 7, gap = 3;
  struct Kind {
    const char* words;
    std::size_t n;
    void (*draw)(Painter&, const Vec2&);
  };
  const Kind kinds[] = {
      {"valid", q.valid, [](Painter& p, const Vec2& c) { arrow(p, c - Vec2(27, 0), c + Vec2(27, 0), valid_colour); }},
      {"replaced", q.replaced, [](Painter& p, const Vec2& c) { arrow(p, c - Vec2(27, 0), c + Vec2(27, 0), replaced_colour); }},
      {"rejected", q.rejected, [](Painter& p, const Vec2& c) { draw_cross(p, c, rejected_colour); }},
      {"failed", q.failed, [](Painter& p, const Vec2& c) { draw_ring(p, c, failed_colour); }}};
  std::vector<LegendEntry> out;
  double x = left, y = 2.6;
  for (const Kind& kind : kinds) {
    if (kind.n == 0) continue;
    const std::string words = std::string(kind.words) + " " + percent(q.share(kind.n));
    const double wide = mark + text_width(words, small_text);
    if (x + wide > right && x > left) x = left, y += legend_row;
    out.push_back({words, kind.draw, x, y});
    x += wide + gap;
  }
  return out;
}

void draw_legend(Canvas& canvas, double left, const std::vector<LegendEntry>& entries, const Plan& plan, const std::string& unit) {
  const TextStyle small{.points = small_text};
  for (const LegendEntry& e : entries) {
    canvas.paint_over([draw = e.draw, at = Vec2((e.x + 3) * units_per_mm, e.y * units_per_mm)](Painter& p) { draw(p, at); });
    canvas.text(e.x + 7, e.y, e.words, Align::left, small);
  }
  const double below = (entries.empty() ? 2.6 : entries.back().y) + legend_row;
  if (plan.units_each <= 0) {
    canvas.text(left, below, "no motion", Align::left, small);
    return;
  }
  const double reference = nice_length(plan.typical);
  const DisplayUnit shown = display_unit(unit, reference);
  const std::string words = significant(reference * shown.factor, 1) + unit_suffix(shown.name);
  const double from = left * units_per_mm, length = reference * plan.units_each;
  canvas.text(left + length / units_per_mm + 1.5, below, words, Align::left, small);
  canvas.paint_over([=](Painter& p) { arrow(p, {from, below * units_per_mm}, {from + length, below * units_per_mm}, ink); });
}

std::string caption(const Content& content, const VectorField& field, const Picture& picture, const PairQuality& q,
                    const Plan& plan) {
  std::string text =
      "Increments measured from " + frame_words(content, field.pair[0]) + " to " + frame_words(content, field.pair[1]);
  if (const auto n = std::size_t(std::max(0, field.pair[0])); n < content.frames.size())
    text += ", t = " + plain(content.frames[n].time) + unit_suffix(content.time_unit);
  text += picture.image.empty() ? "." : ", on " + frame_words(content, picture.frame) + " (contrast softened).";
  if (plan.stride > 1)
    text += " Arrows: every " +
            std::string(plan.stride == 2   ? "second"
                        : plan.stride == 3 ? "third"
                                           : std::to_string(plan.stride) + "th") +
            " node in both directions.";
  text += " Shares in the legend are of the " + count(q.nodes, "node") +
          (q.material_known ? " in the material; the others are not drawn." : " that were not masked.");
  if (q.rejected + q.failed > 0) text += " Rejected and failed nodes are all marked.";
  if (q.flag & frame_decorrelated)
    text += " This step is flagged, as it lost its correlation: the particles step over it where one longer step can take its place.";
  else if (q.flag & frame_repeated)
    text += " This step is flagged, as the second exposure repeats the first; it is summed as it is.";
  else if (q.flag & frame_jump)
    text += " This step is flagged, as its motion does not agree with the steps beside it; it is summed as it is.";
  return text;
}

// The pair that starts with the frame, else the one that ends with it; the number of pairs if there is none.
std::size_t pair_of(int frame, const std::vector<PairQuality>& pairs) {
  for (const std::size_t end : {0u, 1u})
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (pairs[k].frames[end] == frame) return k;
  return pairs.size();
}

std::vector<Figure> draw_vectors(const FigureInput& input) {
  const Content& content = input.content;
  std::vector<Figure> figures;
  for (const Picture& picture : content.pictures) {
    const bool pictured = !picture.image.empty();
    const std::size_t at = pair_of(picture.frame, input.pairs);
    if (at == input.pairs.size()) continue;
    const VectorField field = within_material(content, content.pair(at));

    const Vec2 beside = field.grid.spacing;  // arrows of the outermost nodes
    const Mat3 world_from_pixel = picture.world_from_pixel.value_or(content.world_from_pixel);
    // The frame, but not far beyond the nodes: an oblique camera sees much else.
    const Vec2 about = Vec2::Constant(0.25 * (field.grid.upper() - field.grid.origin).maxCoeff());
    Box box{field.grid.origin - beside, field.grid.upper() + beside};
    if (pictured) {
      box = image_box(picture.image.width(), picture.image.height(), world_from_pixel);
      box.lower = box.lower.cwiseMax(field.grid.origin - about), box.upper = box.upper.cwiseMin(field.grid.upper() + about);
    }
    const std::vector<LegendEntry> legend = legend_of(input.pairs[at], 12, half_figure_mm - 1);
    const double more = legend.empty() ? 0 : legend.back().y - legend.front().y;  // rows of the legend
    const double left = 12, right = 1, head = 10 + more, foot = 10, aspect = box.height() / box.width();
    const double w = std::min(half_figure_mm - left - right, (110 - head - foot) / aspect), h = w * aspect;
    const double x = left + (half_figure_mm - left - right - w) / 2;
    auto canvas = std::make_shared<Canvas>(half_figure_mm, head + h + foot);
    const Panel panel = world_panel(*canvas, x, head, w, h, box, content.length_unit, true, true);
    const int pixels = std::clamp(int(w / 25.4 * 300), 64, 1400);
    if (pictured)
      canvas->raster(panel, draw_image(picture.image.view(), world_from_pixel, box, pixels, 150, 254));
    const Plan plan = plan_arrows(field, w * units_per_mm / box.width());
    draw_vectors(*canvas, panel, field, plan);
    scale_bar(*canvas, x + w, 7 + more, panel, box, content.length_unit);
    draw_legend(*canvas, left, legend, plan, content.length_unit);
    const std::string& length = content.length_unit;
    std::vector<ComparisonTable::Column> data{{"x", length, {}}, {"y", length, {}}, {"u_x", length, {}}, {"u_y", length, {}}, {"status", "", {}}};
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const std::size_t n = field.grid.node(i, j);
        if (field.status[n] == VectorStatus::masked) continue;
        const Vec2 at_node = field.grid.position(i, j);
        const double row[] = {at_node.x(), at_node.y(), double(field.displacement[n][0]), double(field.displacement[n][1]),
                              double(field.status[n])};
        for (std::size_t c = 0; c < 5; ++c) data[c].values.push_back(row[c]);
      }
    figures.push_back({caption(content, field, picture, input.pairs[at], plan), canvas,
                       "vectors_" + std::to_string(figures.size() + 1),
                       pictured ? "vectors of a pair on " + frame_words(content, picture.frame) : "vectors of a pair", std::move(data)});
  }
  return figures;
}

bool owns_vectors(std::string_view figure) {
  constexpr std::string_view vectors_prefix = "vectors_";
  return figure.starts_with(vectors_prefix) && figure.size() > vectors_prefix.size() &&
         figure.find_first_not_of("0123456789", vectors_prefix.size()) == std::string_view::npos;
}

}  // namespace

void lay_vectors(Canvas& canvas, const Panel& panel, const Content& content, const VectorField& field, double units_per_length) {
  const VectorField inside = within_material(content, field);
  draw_vectors(canvas, panel, inside, plan_arrows(inside, units_per_length));
}

FigureRow vectors_row() {
  return {.name = "vectors",
          .shows = "the vectors of a pair, on its frame where there is one",
          .section = Section::measurement,
          .applies = [](const FigureInput& i) { return !i.pairs.empty() && !i.content.pictures.empty(); },
          .draw = draw_vectors,
          .owns = owns_vectors};
}

}  // namespace pivnp::report

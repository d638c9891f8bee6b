// How the camera moved, which is removed from all vectors.
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

std::vector<Figure> draw_camera_motion(const FigureInput& input) {
  const CameraMotion& motion = input.content.camera_motion;
  std::vector<double> frame, right, down, turn, zoom, residual, agree;
  std::size_t lost = 0;
  for (std::size_t k = 0; k < motion.at.size(); ++k) {
    const CameraPlace& p = motion.at[k];
    const bool known = p.points > 0;
    lost += !known;
    frame.push_back(double(k));
    right.push_back(known ? p.shift.x() : nan_value);
    down.push_back(known ? p.shift.y() : nan_value);
    turn.push_back(known ? p.turn * 180 / std::numbers::pi : nan_value);
    zoom.push_back(known ? 100 * (p.scale - 1) : nan_value);
    residual.push_back(known ? p.residual : nan_value);
    agree.push_back(known ? double(p.agree) / p.points : 0);
  }
  const double x = 17, w = 62, h = 20, gap = 8, head = 7;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, head + 3 * h + 2 * gap + 11);
  const double first = 0, last = std::max(1.0, frame.back());
  const auto panel_at = [&](int k, const std::string& label, std::initializer_list<const std::vector<double>*> curves, double least) {
    double low = 0, high = 0;
    for (const auto* curve : curves)
      for (const double v : *curve)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    const double spare = 0.08 * std::max(high - low, least);
    Panel panel = canvas->panel(x, head + k * (h + gap), w, h);
    panel.pale_grid().axis(Axis::x, first, last, k == 2 ? "frame" : "", 5);
    if (k < 2) panel.numbers(Axis::x, false);
    panel.step(Axis::x, std::max(1.0, nice_step(last - first, 6)));
    panel.axis(Axis::y, low - (low < 0 ? spare : 0), std::max(high + spare, low + least), label, 3);
    return panel;
  };
  Panel shifts = panel_at(0, "shift (px)", {&right, &down}, 0.05);
  Panel turns = panel_at(1, "\u00b0 and %", {&turn, &zoom}, 0.01);
  Panel residuals = panel_at(2, "residual (px)", {&residual}, 0.01);
  canvas->curve(shifts, frame, right, {blue, 1.1});
  canvas->curve(shifts, frame, down, {vermilion, 1.1, Dash::dashed});
  canvas->curve(turns, frame, turn, {green, 1.1});
  canvas->curve(turns, frame, zoom, {purple, 1.1, Dash::dashed});
  canvas->curve(residuals, frame, residual, {ink, 1.1});
  double next = legend(*canvas, x, 2.5, Key::line, blue, "to the right");
  legend(*canvas, next, 2.5, Key::dashed, vermilion, "down");
  const double above = head + h + gap - 3.5;
  next = legend(*canvas, x, above, Key::line, green, "turn (\u00b0)");
  legend(*canvas, next, above, Key::dashed, purple, "scale (%)");
  for (int k = 0; k < 3; ++k) canvas->text(x - 15, head + k * (h + gap) - 5, std::array{"(a)", "(b)", "(c)"}[std::size_t(k)], Align::top_left, {.bold = true});
  std::string caption =
      "Motion of what is at rest in the image, which is that of the camera and is removed from all vectors: (a) shift of the image\u2019s "
      "middle since the first frame; (b) rotation, clockwise, and change of scale; (c) RMS distance of the subsets that agree from "
      "the motion they share.";
  if (lost > 0) caption += " Gaps: frames in which it was not found; the place before was kept there.";
  return {{caption, canvas, {}, {},
           {{"frame", "", frame}, {"to the right", "px", right}, {"down", "px", down}, {"turn", "deg", turn},
            {"scale", "%", zoom}, {"residual", "px", residual}, {"share that agrees", "", agree}}}};
}

}  // namespace

FigureRow camera_motion_row() {
  return {.name = "camera_motion",
          .shows = "shift, rotation and scale of the camera against the frames",
          .section = Section::measurement,
          .applies = [](const FigureInput& i) { return i.content.camera_motion.at.size() >= 2; },
          .draw = draw_camera_motion};
}

}  // namespace pivnp::report

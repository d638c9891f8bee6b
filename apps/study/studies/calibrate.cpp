#include "apps/study/studies/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/plot/files.hpp"
#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/files/frame_files.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;
using namespace plot;

std::vector<fs::path> images_of(const std::string& pattern) {
  const fs::path path(pattern);
  std::vector<fs::path> out;
  const auto all = [&](const image::FrameFiles& files) {
    for (const auto& file : files.files) out.push_back(file.path);
  };
  if (fs::is_directory(path)) all(image::files_in_folder(path, "calibrate"));
  else if (fs::exists(path)) out.push_back(path);
  else if (const auto numbered = image::NumberedName::parse(path.filename().string(), "calibrate"))
    all(image::files_of_pattern(path.parent_path(), *numbered, "calibrate"));
  else all(image::files_of_glob(".", pattern, "calibrate"));
  return out;
}

std::string exact(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", v);
  std::string s = text;
  return s.find_first_of(".e") == std::string::npos ? s + ".0" : s;
}

std::string keys_of(const image::Calibration& c, const image::Board& board) {
  std::string text = "# Found by pivnp calibrate: " + std::to_string(c.used()) + " of " + std::to_string(c.views.size()) +
                     " images of a board of " + std::to_string(board.columns) + " x " + std::to_string(board.rows) +
                     " inner corners" + (board.dictionary.empty() ? "" : " with markers " + board.dictionary) + "; frames of " + std::to_string(c.width) + " x " + std::to_string(c.height) + " px.\n[camera]\n";
  text += "lens = \"" + std::string(name_of(c.model)) + "\"\n";
  text += "focal_px = [" + exact(c.focal.x()) + ", " + exact(c.focal.y()) + "]\n";
  text += "centre_px = [" + exact(c.centre.x()) + ", " + exact(c.centre.y()) + "]\n";
  text += "distortion = [";
  for (std::size_t k = 0; k < c.coefficients.size(); ++k) text += (k ? ", " : "") + exact(c.coefficients[k]);
  return text + "]\nlens_rms_px = " + exact(c.rms_px) + "\n# and a scale: metres_per_pixel (on the lens's axis), or points_px and points_m\n";
}

// Where the corners were, their residuals as arrows, and how far the lens moves what is at a radius.
void draw(const image::Calibration& c, const fs::path& file) {
  const double left = 14, top = 10, w = 92, h = w * c.height / c.width, side = left + w + 22, w2 = 170 - side - 3;
  Canvas canvas(170, top + std::max(h, 60.0) + 14);
  Panel field = canvas.panel(left, top, w, h);
  field.axis(Axis::x, 0, c.width, "column (px)", 5).axis(Axis::y, -double(c.height), 0, "row (px, negative)", 5);
  std::vector<double> radius, size;
  double greatest = 0;
  for (const image::BoardView& v : c.views)
    for (std::size_t k = 0; k < v.residual.size(); ++k) {
      greatest = std::max(greatest, v.residual[k].norm());
      radius.push_back((v.corner[k] - c.centre).norm());
      size.push_back(v.residual[k].norm());
    }
  const double length = nice_length(std::max(greatest, 1e-6));  // px of residual that 8 mm stand for
  const double times = 0.09 * c.width / length;
  canvas.paint(field, [&c, field, times](Painter& p) {
    for (const image::BoardView& v : c.views)
      for (std::size_t k = 0; k < v.residual.size(); ++k) {
        const Vec2 tail(v.corner[k].x(), -v.corner[k].y()), tip = tail + times * Vec2(v.residual[k].x(), -v.residual[k].y());
        arrow(p, field.at(tail), field.at(tip), vermilion);
      }
  });
  canvas.text(left, top - 2, "(a) residuals of the corners; an arrow of " + significant(0.09 * w, 2) + " mm is " + significant(length, 2) + " px",
              Align::bottom_left, {});
  Panel by_radius = canvas.panel(side, top, w2, 60);
  const double most = radius.empty() ? 1 : *std::max_element(radius.begin(), radius.end());
  by_radius.pale_grid().axis(Axis::x, 0, most * 1.03, "distance from centre (px)", 4);
  by_radius.axis(Axis::y, 0, greatest > 0 ? greatest * 1.05 : 1, "residual (px)", 4);
  canvas.points(by_radius, radius, size, {.marker = Marker::circle, .pen = {blue, 0.6}, .size_mm = 0.9});
  canvas.text(side - 8, top - 2, "(b) RMS " + significant(c.rms_px, 2) + " px", Align::bottom_left, {});
  make_folder(file.parent_path());
  write_file(file, canvas.png(300));
}

}  // namespace

CalibrateOutcome calibrate_camera(const std::string& pattern, const image::Board& board, image::LensModel model, bool third,
                                  const fs::path& out) {
  CalibrateOutcome outcome;
  outcome.calibration = image::calibrate(images_of(pattern), board, model, third);
  const image::Calibration& c = outcome.calibration;
  const image::Lens lens(c.model, c.focal, c.centre, c.coefficients, {});
  double bent = 0;
  for (const double column : {0.0, c.width - 1.0})
    for (const double row : {0.0, c.height - 1.0}) {
      const Vec2 ideal = lens.to_ideal({column, row});
      if (!ideal.allFinite())
        throw InputError("calibrate: the fitted model folds over before the image's corners, so that it says nothing of them; "
                         "expected pictures in which the board reaches the corners too");
      bent = std::max(bent, (ideal - Vec2(column, row)).norm());
    }
  outcome.keys = out / "camera.toml";
  outcome.picture = out / "residuals.png";
  make_folder(out);
  write_file(outcome.keys, keys_of(c, board));
  draw(c, outcome.picture);
  outcome.remarks.push_back("The board was found in " + std::to_string(c.used()) + " of " + std::to_string(c.views.size()) +
                            " images; residual " + number(c.rms_px, 2) + " px RMS. The lens moves the image's corners by up to " +
                            number(bent, 3) + " px.");
  if (!board.dictionary.empty()) {
    std::size_t seen = 0;
    for (const image::BoardView& v : c.views) seen += v.corner.size();
    outcome.remarks.push_back("Of the board's " + std::to_string(board.columns * board.rows) + " inner corners, " +
                              number(double(seen) / c.used(), 3) + " were seen in an image on average.");
  }
  const std::string lost = board.dictionary.empty() ? ": the board was not found as a whole; left out."
                                                    : ": fewer than 8 of the board's corners were found; left out.";
  for (const image::BoardView& v : c.views)
    if (v.corner.empty()) outcome.remarks.push_back(v.name + lost);
    else if (v.rms_px > 2.5 * c.rms_px) outcome.remarks.push_back(v.name + ": its residual is " + number(v.rms_px, 2) + " px, far above the others\u2019 (blur, a bent board?).");
  if (c.rms_px > 0.3)
    outcome.remarks.push_back("A residual above 0.3 px is more than corners are found to: the board is not plane, the focus or zoom changed, or the lens needs another model.");
  if (c.covered < 0.8)
    outcome.remarks.push_back("Corners were seen in " + number(100 * c.covered, 2) + " % of the image's fields only; beyond them the lens is extrapolated. Hold the board into the corners too.");
  if (c.used() < 8) outcome.remarks.push_back("Fewer than 8 pictures: ten to twenty, tilted by 20 to 40 degrees to all sides, hold focal length and distortion apart.");
  return outcome;
}

}  // namespace pivnp::app

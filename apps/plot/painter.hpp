// Free painting on a figure canvas: lines, shapes, symbols and words. Canvas units, tenths of a millimetre; x to the
// right, y downward.
#pragma once

#include <string>
#include <vector>

#include "apps/plot/palette.hpp"
#include "pivnp/core/math.hpp"

class QCPPainter;

namespace pivnp::plot {

constexpr double units_per_mm = 10.0;
constexpr double units_per_point = units_per_mm * 25.4 / 72.0;
constexpr double small_text = 7.0, normal_text = 7.5;  // points

enum class Dash { solid, dashed, dotted, dash_dot };

struct Pen {
  Rgb rgb = ink;
  double points = 0.5;  // width
  Dash dash = Dash::solid;
  int alpha = 255;
};

struct Fill {
  Rgb rgb = 0xffffff;
  int alpha = 255;
};

struct Rectangle {
  double left = 0, top = 0, width = 0, height = 0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
  Vec2 centre() const { return {left + width / 2, top + height / 2}; }
};
/// Between two corners, in any order.
Rectangle between(const Vec2& one, const Vec2& other);

enum class Marker { disc, circle, square, diamond, triangle, triangle_down, cross, plus, star, cross_square, plus_circle };

struct Symbol {
  Marker marker = Marker::circle;
  Pen pen = {};
  Fill fill = {};
  double size_mm = 1.5;
};

/// Which point of the words' box lies at the place given.
enum class Align { top_left, top, top_right, left, centre, right, bottom_left, bottom, bottom_right };

struct TextStyle {
  double points = normal_text;
  bool bold = false;
  Rgb rgb = ink;
  double angle_deg = 0;  // clockwise, about the place
};

/// Width of words in mm.
double text_width(const std::string& words, double points, bool bold = false);

/// Draws while a canvas is drawn; never kept.
class Painter {
 public:
  explicit Painter(QCPPainter& qt) : qt_(qt) {}

  /// What outlines and areas look like from here on.
  void pen(const Pen& pen);
  void fill(const Fill& fill);
  void no_pen();
  void no_fill();

  void line(const Vec2& from, const Vec2& to);
  void polyline(const std::vector<Vec2>& points);
  void polygon(const std::vector<Vec2>& points);
  /// Rings that belong together: a ring within a ring is a hole.
  void rings(const std::vector<std::vector<Vec2>>& rings);
  void rectangle(const Rectangle& r);
  void ellipse(const Vec2& centre, double radius_x, double radius_y);
  void symbol(const Symbol& symbol, const Vec2& at);
  /// Words in a rectangle, at its edge or middle that `align` names; one line. The style's angle is not used.
  void text(const Rectangle& r, const std::string& words, Align align, const TextStyle& style = {});

 private:
  QCPPainter& qt_;
};

}  // namespace pivnp::plot

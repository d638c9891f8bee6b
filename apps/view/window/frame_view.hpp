// A frame with the outlines of the case, the tools that draw them, and the vectors of the live pair. Scene units are pixels of the
// frame: the centre of pixel (column, row) lies at (column, row).
#pragma once

#include <optional>
#include <vector>

#include <QImage>

#include "apps/view/model/live_pair.hpp"
#include "apps/view/model/shapes.hpp"
#include "apps/view/window/zoom_view.hpp"

namespace pivnp::view {

enum class Tool { select, region, mask, wall, still_zone, scale, origin, horizontal };
enum class VectorColour { status, score, error };

class FrameView : public ZoomView {
 public:
  explicit FrameView(QWidget* parent = nullptr);

  void set_image(const QImage& image);  // the first one of a sequence is shown whole
  void set_empty_words(const QString& words) { empty_words_ = words; }  // shown without an image
  void set_shapes(const std::vector<Shape>& shapes);
  void set_camera(const image::Camera& camera, bool scaled);
  void set_pair(std::optional<LivePair> pair);
  void set_vector_colour(VectorColour colour);
  void set_tool(Tool tool);
  Tool tool() const { return tool_; }
  int selected() const { return selected_; }  // a shape; -1: none
  void select(int shape);
  PixelBox visible_pixels() const;

  void paint(QPainter& painter) override;

  std::function<void(ShapeKind, std::vector<Vec2>)> drawn;
  std::function<void(int, std::vector<Vec2>)> moved;
  std::function<void(Vec2, Vec2)> scaled, turned;
  std::function<void(Vec2)> origin_set;
  std::function<void(int)> selection_changed;
  std::function<void(int, QPoint)> menu_asked;  // for a shape, at a place of the screen
  std::function<void()> tool_done;              // back to selecting
  std::function<void(QString)> says;            // what comes next

 protected:
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void mouseReleaseEvent(QMouseEvent*) override;
  void mouseDoubleClickEvent(QMouseEvent*) override;
  void keyPressEvent(QKeyEvent*) override;

 private:
  Vec2 snapped(const QPointF& widget) const;
  int point_near(const QPointF& widget) const;  // of the selected shape
  int edge_near(int shape, const QPointF& widget) const;
  int shape_at(const QPointF& widget) const;
  void finish();
  void abandon();
  void remove_point(int point);
  void hint() const;
  void paint_pair(QPainter& painter) const;
  void paint_washes(QPainter& painter) const;
  void paint_axes(QPainter& painter) const;
  void paint_scale_bar(QPainter& painter) const;
  void paint_shape(QPainter& painter, const Shape& shape, bool chosen) const;

  QImage image_;
  QString empty_words_;
  std::vector<Shape> shapes_;
  image::Camera camera_;
  bool scaled_camera_ = false;
  std::optional<LivePair> pair_;
  VectorColour colour_ = VectorColour::status;
  Tool tool_ = Tool::select;
  int selected_ = -1;
  std::vector<Vec2> points_;       // being drawn
  std::optional<Vec2> cursor_;     // snapped
  int dragged_point_ = -1;
  bool dragged_shape_ = false, dragged_far_ = false;
  QPointF drag_start_;
  std::vector<Vec2> before_drag_;
};

/// For the screen: grey values as they are, those of more than 8 bits brought to 0..255 by full scale.
QImage screen_image(const ImageView& image);

}  // namespace pivnp::view

// A picture that is zoomed by the wheel about the cursor and moved by dragging, as in an image viewer.
#pragma once

#include <functional>

#include <QPointF>
#include <QRectF>
#include <QWidget>

class QPainter;

namespace pivnp::view {

class ZoomView : public QWidget {
 public:
  explicit ZoomView(QWidget* parent = nullptr);

  QPointF to_widget(const QPointF& scene) const { return scene * scale_ + shift_; }
  QPointF to_scene(const QPointF& widget) const { return (widget - shift_) / scale_; }
  double scale() const { return scale_; }  // screen units per scene unit
  QRectF visible() const { return QRectF(to_scene({0, 0}), to_scene({double(width()), double(height())})); }

  /// What there is to see; `refit` shows all of it.
  void set_extent(const QRectF& scene, bool refit);
  const QRectF& extent() const { return extent_; }
  void fit();
  void zoom(double factor, const QPointF& about);
  void follow(const ZoomView& other);  // sees the same, without telling

  /// What is seen, painted in screen units.
  virtual void paint(QPainter& painter) = 0;

  std::function<void()> view_changed;          // by the user
  std::function<void(int)> scrub;              // shift and wheel: so many frames on
  std::function<void(const QPointF&)> hovered;  // scene
  std::function<void()> left;

 protected:
  void paintEvent(QPaintEvent*) override;
  void wheelEvent(QWheelEvent*) override;
  void mousePressEvent(QMouseEvent*) override;
  void mouseMoveEvent(QMouseEvent*) override;
  void mouseReleaseEvent(QMouseEvent*) override;
  void leaveEvent(QEvent*) override;
  void resizeEvent(QResizeEvent*) override;
  void keyPressEvent(QKeyEvent*) override;
  void start_pan(const QPointF& at);
  bool panning() const { return panning_; }

 private:
  void changed();
  double least() const;

  QRectF extent_{0, 0, 1, 1};
  double scale_ = 1;
  QPointF shift_, grabbed_;
  bool fitted_ = true, panning_ = false;
};

}  // namespace pivnp::view

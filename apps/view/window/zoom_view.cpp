#include "apps/view/window/zoom_view.hpp"

#include <algorithm>
#include <cmath>

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>

namespace pivnp::view {

ZoomView::ZoomView(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setMinimumSize(160, 120);
}

void ZoomView::set_extent(const QRectF& scene, bool refit) {
  extent_ = scene;
  if (refit || fitted_) fit();
  update();
}

void ZoomView::fit() {
  if (extent_.isEmpty() || width() < 1 || height() < 1) return;
  scale_ = std::min(width() / extent_.width(), height() / extent_.height()) * 0.97;
  shift_ = QPointF(width() / 2.0, height() / 2.0) - extent_.center() * scale_;
  fitted_ = true;
  changed();
}

double ZoomView::least() const { return 0.3 * std::min(width() / extent_.width(), height() / extent_.height()); }

void ZoomView::zoom(double factor, const QPointF& about) {
  const QPointF at = to_scene(about);
  const double most = 400 * least();
  scale_ = std::clamp(scale_ * factor, least(), std::max(most, 64.0 * 1e-9));
  shift_ = about - at * scale_;
  fitted_ = false;
  changed();
}

void ZoomView::follow(const ZoomView& other) {
  scale_ = other.scale_;
  shift_ = other.shift_;
  fitted_ = other.fitted_;
  update();
}

void ZoomView::changed() {
  update();
  if (view_changed) view_changed();
}

void ZoomView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Dark));
  paint(painter);
}

void ZoomView::wheelEvent(QWheelEvent* event) {
  const QPoint turned = event->angleDelta();
  const int steps = turned.y() != 0 ? turned.y() : turned.x();
  if (event->modifiers() & Qt::ShiftModifier) {
    if (scrub && steps != 0) scrub(steps > 0 ? -1 : 1);
  } else if (steps != 0) {
    zoom(std::pow(1.2, steps / 120.0), event->position());
  }
  event->accept();
}

void ZoomView::start_pan(const QPointF& at) {
  panning_ = true;
  grabbed_ = at;
  setCursor(Qt::ClosedHandCursor);
}

void ZoomView::mousePressEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton || event->button() == Qt::MiddleButton) start_pan(event->position());
}

void ZoomView::mouseMoveEvent(QMouseEvent* event) {
  if (panning_) {
    shift_ += event->position() - grabbed_;
    grabbed_ = event->position();
    fitted_ = false;
    changed();
  }
  if (hovered) hovered(to_scene(event->position()));
}

void ZoomView::mouseReleaseEvent(QMouseEvent*) {
  if (panning_) unsetCursor();
  panning_ = false;
}

void ZoomView::leaveEvent(QEvent*) {
  if (left) left();
}

void ZoomView::resizeEvent(QResizeEvent*) {
  if (fitted_) fit();
  else changed();
}

void ZoomView::keyPressEvent(QKeyEvent* event) {
  const QPointF middle(width() / 2.0, height() / 2.0);
  switch (event->key()) {
    case Qt::Key_Plus:
    case Qt::Key_Equal: zoom(1.25, middle); break;
    case Qt::Key_Minus: zoom(0.8, middle); break;
    case Qt::Key_F: fit(); break;
    default: QWidget::keyPressEvent(event);
  }
}

}  // namespace pivnp::view

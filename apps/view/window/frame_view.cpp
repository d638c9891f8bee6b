#include "apps/view/window/frame_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>

#include "apps/plot/canvas.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/plot/palette.hpp"
#include "apps/plot/qt.hpp"

namespace pivnp::view {

namespace {

constexpr double reach = 9;  // of the mouse, screen units

QColor kind_colour(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::region: return QColor(0x2e, 0xc4, 0x7a);
    case ShapeKind::mask: return QColor(0xff, 0x5a, 0x4f);
    case ShapeKind::wall: return QColor(0x56, 0xb4, 0xe9);
    case ShapeKind::still_zone: break;
  }
  return QColor(0xf0, 0xc0, 0x30);
}

std::optional<ShapeKind> kind_of(Tool tool) {
  switch (tool) {
    case Tool::region: return ShapeKind::region;
    case Tool::mask: return ShapeKind::mask;
    case Tool::wall: return ShapeKind::wall;
    case Tool::still_zone: return ShapeKind::still_zone;
    default: return std::nullopt;
  }
}

QColor status_colour(VectorStatus status) {
  return status == VectorStatus::valid      ? QColor(0x5c, 0xe0, 0xff)
         : status == VectorStatus::replaced ? QColor(0xff, 0xa0, 0x30)
         : status == VectorStatus::rejected ? QColor(0xff, 0x40, 0x60)
                                            : QColor(0xa8, 0xa8, 0xa8);
}

QPointF point_of(const Vec2& p) { return {p.x(), p.y()}; }

void outlined_text(QPainter& painter, const QPointF& at, const QString& words, const QColor& colour) {
  QPainterPath path;
  path.addText(at, painter.font(), words);
  painter.strokePath(path, QPen(QColor(0, 0, 0, 200), 3, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  painter.fillPath(path, colour);
}

// A line that is seen on bright and on dark ground.
void haloed(QPainter& painter, const QColor& colour, double width, const std::function<void()>& draw, Qt::PenStyle style = Qt::SolidLine) {
  painter.setPen(QPen(QColor(0, 0, 0, 150), width + 2));
  draw();
  painter.setPen(QPen(colour, width, style));
  draw();
}

double distance_to(const QPointF& p, const QPointF& a, const QPointF& b) {
  const QPointF d = b - a;
  const double along = QPointF::dotProduct(d, d) > 0 ? std::clamp(QPointF::dotProduct(p - a, d) / QPointF::dotProduct(d, d), 0.0, 1.0) : 0;
  const QPointF off = p - (a + along * d);
  return std::hypot(off.x(), off.y());
}

}  // namespace

QImage screen_image(const ImageView& image) {
  QImage out(image.width, image.height, QImage::Format_Grayscale8);
  for (int r = 0; r < image.height; ++r) {
    uchar* to = out.scanLine(r);
    if (image.depth == PixelDepth::u8 && image.white == 255.0f) {
      std::copy_n(image.row<std::uint8_t>(r), image.width, to);
    } else {
      const float factor = 255.0f / image.white;
      for (int c = 0; c < image.width; ++c) to[c] = uchar(std::clamp(float(grey_at(image, c, r)) * factor + 0.5f, 0.0f, 255.0f));
    }
  }
  return out;
}

FrameView::FrameView(QWidget* parent) : ZoomView(parent) {}

void FrameView::set_image(const QImage& image) {
  const bool other = image.size() != image_.size();
  image_ = image;
  if (other) set_extent(QRectF(-0.5, -0.5, std::max(1, image.width()), std::max(1, image.height())), true);
  update();
}

void FrameView::set_shapes(const std::vector<Shape>& shapes) {
  if (dragged_point_ >= 0 || dragged_shape_) return;
  const app::KeyPath chosen = selected_ >= 0 ? shapes_[std::size_t(selected_)].key : app::KeyPath{};
  shapes_ = shapes;
  selected_ = -1;
  for (std::size_t k = 0; k < shapes_.size(); ++k)
    if (shapes_[k].key == chosen) selected_ = int(k);
  update();
}

void FrameView::set_camera(const image::Camera& camera, bool scaled_camera) {
  camera_ = camera;
  scaled_camera_ = scaled_camera;
  update();
}

void FrameView::set_pair(std::optional<LivePair> pair) {
  pair_ = std::move(pair);
  update();
}

void FrameView::set_vector_colour(VectorColour colour) {
  colour_ = colour;
  update();
}

void FrameView::set_tool(Tool tool) {
  tool_ = tool;
  abandon();
  if (tool == Tool::select) unsetCursor();
  else setCursor(Qt::CrossCursor);
  hint();
}

void FrameView::hint() const {
  if (!says) return;
  const bool begun = !points_.empty();
  switch (tool_) {
    case Tool::select: says({}); break;
    case Tool::wall: says(begun ? "Click the wall's other end" : "Click one end of the wall"); break;
    case Tool::scale: says(begun ? "Click the other end of the known length" : "Click one end of a length that you know"); break;
    case Tool::origin: says("Click where the world's (0, 0) is"); break;
    case Tool::horizontal: says(begun ? "Click a second place, to the right on the same level" : "Click a place on the x axis or on any level line"); break;
    default: says(begun ? "Click the next corner; the first corner, a double click or Enter closes; Backspace takes one back, Esc all"
                        : "Click the first corner of the outline; corners snap to the frame's edge");
  }
}

void FrameView::select(int shape) {
  if (shape == selected_) return;
  selected_ = shape >= int(shapes_.size()) ? -1 : shape;
  update();
  if (selection_changed) selection_changed(selected_);
}

PixelBox FrameView::visible_pixels() const {
  const QRectF seen = visible() & extent();
  return {seen.left(), seen.top(), seen.right(), seen.bottom()};
}

Vec2 FrameView::snapped(const QPointF& widget) const {
  const QPointF p = to_scene(widget);
  Vec2 out(p.x(), p.y());
  const double near = reach / scale(), right = image_.width() - 1, low = image_.height() - 1;
  if (std::abs(out.x()) < near || out.x() < 0) out.x() = 0;
  if (std::abs(out.x() - right) < near || out.x() > right) out.x() = right;
  if (std::abs(out.y()) < near || out.y() < 0) out.y() = 0;
  if (std::abs(out.y() - low) < near || out.y() > low) out.y() = low;
  return out;
}

int FrameView::point_near(const QPointF& widget) const {
  if (selected_ < 0 || shapes_[std::size_t(selected_)].circle) return -1;
  int best = -1;
  double nearest = reach;
  const std::vector<Vec2>& points = shapes_[std::size_t(selected_)].points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const QPointF d = to_widget(point_of(points[k])) - widget;
    if (std::hypot(d.x(), d.y()) < nearest) nearest = std::hypot(d.x(), d.y()), best = int(k);
  }
  return best;
}

int FrameView::edge_near(int shape, const QPointF& widget) const {
  const Shape& s = shapes_[std::size_t(shape)];
  const std::size_t edges = s.closed ? s.points.size() : s.points.size() - 1;
  for (std::size_t k = 0; k < edges; ++k)
    if (distance_to(widget, to_widget(point_of(s.points[k])), to_widget(point_of(s.points[(k + 1) % s.points.size()]))) < reach * 0.7) return int(k);
  return -1;
}

int FrameView::shape_at(const QPointF& widget) const {
  for (int k = int(shapes_.size()) - 1; k >= 0; --k)
    if (edge_near(k, widget) >= 0) return k;
  int smallest = -1;
  double least_area = 0;
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    if (!shapes_[k].closed) continue;
    QPolygonF outline;
    for (const Vec2& p : shapes_[k].points) outline << to_widget(point_of(p));
    const QRectF box = outline.boundingRect();
    if (outline.containsPoint(widget, Qt::OddEvenFill) && (smallest < 0 || box.width() * box.height() < least_area))
      smallest = int(k), least_area = box.width() * box.height();
  }
  return smallest;
}

void FrameView::finish() {
  const std::vector<Vec2> points = std::move(points_);
  const Tool tool = tool_;
  points_.clear();
  update();
  if (tool_done) tool_done();  // first: what is said of the result stays
  if (const auto kind = kind_of(tool)) {
    if (drawn) drawn(*kind, points);
  } else if (tool == Tool::scale) {
    if (scaled) scaled(points[0], points[1]);
  } else if (tool == Tool::horizontal) {
    if (turned) turned(points[0], points[1]);
  } else if (tool == Tool::origin) {
    if (origin_set) origin_set(points[0]);
  }
}

void FrameView::abandon() {
  points_.clear();
  cursor_.reset();
  update();
}

void FrameView::mousePressEvent(QMouseEvent* event) {
  setFocus();
  const QPointF at = event->position();
  if (event->button() == Qt::MiddleButton || image_.isNull()) return start_pan(at);
  if (event->button() == Qt::RightButton) {
    if (tool_ != Tool::select) return abandon();
    const int point = point_near(at);
    if (point >= 0) return remove_point(point);
    const int shape = shape_at(at);
    if (shape >= 0) {
      select(shape);
      if (menu_asked) menu_asked(shape, event->globalPosition().toPoint());
    }
    return;
  }
  if (event->button() != Qt::LeftButton) return;
  if (tool_ != Tool::select) {
    const bool line = !(kind_of(tool_) && tool_ != Tool::wall);
    if (!line && points_.size() > 2) {
      const QPointF d = to_widget(point_of(points_[0])) - at;
      if (std::hypot(d.x(), d.y()) < reach) return finish();
    }
    const QPointF raw = to_scene(at);
    points_.push_back(tool_ == Tool::scale || tool_ == Tool::origin || tool_ == Tool::horizontal ? Vec2(raw.x(), raw.y()) : snapped(at));
    if (tool_ == Tool::origin || (line && points_.size() == 2)) return finish();
    hint();
    return update();
  }
  dragged_point_ = point_near(at);
  drag_start_ = at;
  dragged_far_ = false;
  if (dragged_point_ >= 0) {
    before_drag_ = shapes_[std::size_t(selected_)].points;
    return;
  }
  const int shape = shape_at(at);
  if (shape >= 0 && shape == selected_ && !shapes_[std::size_t(shape)].circle) {
    dragged_shape_ = true;
    before_drag_ = shapes_[std::size_t(selected_)].points;
    return;
  }
  if (shape >= 0 && edge_near(shape, at) >= 0) return select(shape);
  select(shape);
  start_pan(at);
}

void FrameView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF at = event->position();
  cursor_ = snapped(at);
  if (dragged_point_ >= 0 || dragged_shape_) {
    const QPointF off = at - drag_start_;
    dragged_far_ |= std::hypot(off.x(), off.y()) > 2;
    std::vector<Vec2>& points = shapes_[std::size_t(selected_)].points;
    if (dragged_far_ && dragged_point_ >= 0) points[std::size_t(dragged_point_)] = *cursor_;
    if (dragged_far_ && dragged_shape_)
      for (std::size_t k = 0; k < points.size(); ++k) points[k] = before_drag_[k] + Vec2(off.x(), off.y()) / scale();
    update();
  } else if (tool_ == Tool::select && !panning()) {
    if (point_near(at) >= 0) setCursor(Qt::SizeAllCursor);
    else if (shape_at(at) >= 0) setCursor(Qt::PointingHandCursor);
    else unsetCursor();
  }
  if (!points_.empty()) update();
  ZoomView::mouseMoveEvent(event);
}

void FrameView::mouseReleaseEvent(QMouseEvent* event) {
  const bool dragged = (dragged_point_ >= 0 || dragged_shape_) && dragged_far_;
  dragged_point_ = -1;
  dragged_shape_ = false;
  if (dragged) {
    const std::vector<Vec2> points = shapes_[std::size_t(selected_)].points;
    shapes_[std::size_t(selected_)].points = before_drag_;  // until the session has taken it
    if (moved) moved(selected_, points);
    update();
  }
  ZoomView::mouseReleaseEvent(event);
}

void FrameView::mouseDoubleClickEvent(QMouseEvent* event) {
  const QPointF at = event->position();
  if (tool_ != Tool::select) {
    if (kind_of(tool_) && points_.size() > 2) finish();
    return;
  }
  // On an edge: a point more.
  const int shape = shape_at(at), edge = shape >= 0 && shapes_[std::size_t(shape)].closed && !shapes_[std::size_t(shape)].circle ? edge_near(shape, at) : -1;
  if (edge < 0 || point_near(at) >= 0) return;
  select(shape);
  std::vector<Vec2> points = shapes_[std::size_t(shape)].points;
  points.insert(points.begin() + edge + 1, snapped(at));
  if (moved) moved(shape, points);
}

void FrameView::remove_point(int point) {
  std::vector<Vec2> points = shapes_[std::size_t(selected_)].points;
  points.erase(points.begin() + point);
  if (moved) moved(selected_, points);
}

void FrameView::keyPressEvent(QKeyEvent* event) {
  switch (event->key()) {
    case Qt::Key_Return:
    case Qt::Key_Enter:
      if (kind_of(tool_) && points_.size() > 2) finish();
      return;
    case Qt::Key_Backspace:
      if (!points_.empty()) points_.pop_back();
      hint();
      return update();
    case Qt::Key_Escape:
      if (!points_.empty()) abandon();
      else if (tool_ != Tool::select && tool_done) tool_done();
      else select(-1);
      return hint();
    default: ZoomView::keyPressEvent(event);
  }
}

void FrameView::paint_shape(QPainter& painter, const Shape& shape, bool chosen) const {
  QPolygonF outline;
  for (const Vec2& p : shape.points) outline << to_widget(point_of(p));
  if (outline.isEmpty()) return;
  const QColor colour = kind_colour(shape.kind);
  painter.setBrush(Qt::NoBrush);
  haloed(painter, colour, chosen ? 2.4 : 1.6, [&] { shape.closed ? painter.drawPolygon(outline) : painter.drawPolyline(outline); },
         shape.kind == ShapeKind::still_zone ? Qt::DashLine : Qt::SolidLine);
  if (chosen) {
    painter.setPen(QPen(QColor(0, 0, 0, 200), 1));
    painter.setBrush(colour.lighter(140));
    for (const QPointF& p : shape.circle ? QPolygonF() : outline) painter.drawRect(QRectF(p - QPointF(4, 4), QSizeF(8, 8)));
    painter.setBrush(Qt::NoBrush);
  }
  // The name inside, at the top left corner of what is seen of it.
  const QRectF box = outline.boundingRect() & QRectF(rect()).adjusted(2, 2, -60, -4);
  if (!box.isEmpty() || !shape.closed)
    outlined_text(painter, shape.closed ? QPointF(box.left() + 6, box.top() + 16) : (outline.front() + outline.back()) / 2 + QPointF(6, -6),
                  plot::qt(shape.name()), colour.lighter(125));
}

// Below the vectors: what is masked is seen to be, and what is chosen.
void FrameView::paint_washes(QPainter& painter) const {
  painter.setPen(Qt::NoPen);
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    if (!shapes_[k].closed) continue;
    QPolygonF outline;
    for (const Vec2& p : shapes_[k].points) outline << to_widget(point_of(p));
    QColor wash = kind_colour(shapes_[k].kind);
    wash.setAlpha(shapes_[k].kind == ShapeKind::mask ? 80 : int(k) == selected_ ? 22 : 0);
    painter.setBrush(wash);
    painter.drawPolygon(outline);
  }
  painter.setBrush(Qt::NoBrush);
}

void FrameView::paint_axes(QPainter& painter) const {
  const Vec2 zero = camera_.to_pixel({0, 0});
  if (!zero.allFinite()) return;
  const Mat2 J = camera_.jacobian(zero);
  if (!(std::abs(J.determinant()) > 0)) return;
  const double unit = std::sqrt(std::abs(J.determinant()));
  const QPointF at = to_widget(point_of(zero));
  for (const auto& [step, name, colour] : {std::tuple{Vec2(1, 0), "x", QColor(0xff, 0x70, 0x60)}, std::tuple{Vec2(0, 1), "y", QColor(0x60, 0xd0, 0x80)}}) {
    const QPointF ahead = to_widget(point_of(camera_.to_pixel(Vec2(step * unit)))) - at;
    const double n = std::hypot(ahead.x(), ahead.y());
    if (!(n > 0)) continue;
    const QPointF e = ahead / n, tip = at + 46 * e, across(-e.y(), e.x());
    const QColor shade = colour;
    haloed(painter, shade, 2, [&] {
      painter.drawLine(at, tip);
      painter.drawLine(tip, tip - 9 * e + 5 * across);
      painter.drawLine(tip, tip - 9 * e - 5 * across);
    });
    outlined_text(painter, tip + 8 * e + QPointF(-3, 4), name, shade);
  }
}

void FrameView::paint_scale_bar(QPainter& painter) const {
  if (image_.isNull()) return;
  const QPointF seen = to_scene({width() / 2.0, height() - 24.0});
  const Vec2 here = camera_.to_world({seen.x(), seen.y()}), there = camera_.to_world({seen.x() + 1, seen.y()});
  const double unit = (there - here).norm();
  if (!std::isfinite(unit) || !(unit > 0)) return;
  const double length = plot::nice_length(130 / scale() * unit), screen = length / unit * scale();
  const plot::DisplayUnit shown = plot::display_unit(camera_.length_unit(), length);
  const QPointF right(width() - 18.0, height() - 18.0), start = right - QPointF(screen, 0);
  haloed(painter, Qt::white, 3, [&] { painter.drawLine(start, right); });
  outlined_text(painter, start + QPointF(0, -8), plot::qt(plot::plain(length * shown.factor) + plot::unit_suffix(shown.name)), Qt::white);
}

void FrameView::paint_pair(QPainter& painter) const {
  const VectorField& field = pair_->field;
  const double node = pair_->spacing_px * scale();
  const int stride = std::max(1, int(std::ceil(13 / std::max(node, 1e-6))));
  std::vector<double> lengths, errors;
  const auto ends = [&](std::size_t n, const Vec2& x, Vec2& tail, Vec2& tip) {
    const Vec2 d(double(field.displacement[n][0]), double(field.displacement[n][1]));
    tail = pair_->camera.to_pixel(Vec2(field.anchor == Anchor::central ? Vec2(x - d / 2) : x));
    tip = pair_->camera.to_pixel(Vec2(field.anchor == Anchor::central ? Vec2(x + d / 2) : Vec2(x + d)));
  };
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::size_t n = field.grid.node(i, j);
      if (!usable(field.status[n])) continue;
      Vec2 tail, tip;
      ends(n, field.grid.position(i, j), tail, tip);
      lengths.push_back((tip - tail).norm());
      errors.push_back(std::sqrt((double(field.cov[n][0]) + double(field.cov[n][1])) / 2));
    }
  const double typical = plot::quantile(lengths, 0.95), most_error = plot::quantile(errors, 0.95);
  const double longer = std::isfinite(typical) && typical > 0 ? std::clamp(1.7 * stride * node, 16.0, 60.0) / typical : 0;  // screen per px
  for (int j = stride / 2; j < field.grid.ny; j += stride)
    for (int i = stride / 2; i < field.grid.nx; i += stride) {
      const std::size_t n = field.grid.node(i, j);
      const VectorStatus status = field.status[n];
      if (status == VectorStatus::masked || status == VectorStatus::outside) continue;
      const Vec2 x = field.grid.position(i, j);
      const QPointF at = to_widget(point_of(pair_->camera.to_pixel(x)));
      if (!rect().adjusted(-60, -60, 60, 60).contains(at.toPoint())) continue;
      QColor colour = status_colour(status);
      if (colour_ != VectorColour::status) {
        const double t = colour_ == VectorColour::score ? double(n < field.score.size() ? field.score[n] : 0.0f)
                                                        : std::sqrt((double(field.cov[n][0]) + double(field.cov[n][1])) / 2) / most_error;
        colour = plot::qt_colour(plot::colour_at(plot::Colours::sequential, t));
      }
      if (!usable(status)) {
        haloed(painter, colour, 1.4, [&] {
          painter.drawLine(at - QPointF(3.5, 3.5), at + QPointF(3.5, 3.5));
          painter.drawLine(at - QPointF(3.5, -3.5), at + QPointF(3.5, -3.5));
        });
        continue;
      }
      Vec2 tail, tip;
      ends(n, x, tail, tip);
      const QPointF d = point_of(Vec2((tip - tail) * longer)), from = field.anchor == Anchor::central ? at - d / 2 : at, to = from + d;
      const double size = std::hypot(d.x(), d.y());
      haloed(painter, colour, 1.3, [&] {
        if (size < 1.5) return painter.drawEllipse(from, 1, 1);
        painter.drawLine(from, to);
        const QPointF e = d / size, across(-e.y(), e.x());
        const double head = std::min(5.0, 0.5 * size);
        painter.drawLine(to, to - head * e + 0.6 * head * across);
        painter.drawLine(to, to - head * e - 0.6 * head * across);
      });
    }
  // What the colours mean.
  painter.save();
  QFont small = painter.font();
  small.setPointSizeF(small.pointSizeF() * 0.92);
  painter.setFont(small);
  QPointF at(14, height() - 16.0);
  if (colour_ == VectorColour::status) {
    for (const auto& [name, status] : {std::pair{"valid", VectorStatus::valid}, std::pair{"replaced", VectorStatus::replaced},
                                       std::pair{"rejected", VectorStatus::rejected}, std::pair{"no texture", VectorStatus::failed}}) {
      painter.fillRect(QRectF(at - QPointF(0, 9), QSizeF(10, 10)), status_colour(status));
      outlined_text(painter, at + QPointF(15, 0), name, Qt::white);
      at += QPointF(28 + painter.fontMetrics().horizontalAdvance(name), 0);
    }
  } else {
    for (int k = 0; k < 120; ++k)
      painter.fillRect(QRectF(at + QPointF(k, -9), QSizeF(1.5, 10)), plot::qt_colour(plot::colour_at(plot::Colours::sequential, k / 119.0)));
    const bool score = colour_ == VectorColour::score;
    const plot::DisplayUnit unit = plot::display_unit(pair_->camera.length_unit(), most_error);
    outlined_text(painter, at + QPointF(128, 0),
                  score ? QString("score 0 to 1") : plot::qt("stated error 0 to " + plot::significant(most_error * unit.factor, 2) + plot::unit_suffix(unit.name)), Qt::white);
  }
  if (longer > 0)
    outlined_text(painter, QPointF(14, height() - 34.0), plot::qt("arrows " + plot::significant(longer / scale(), 2) + " × displacement"), Qt::white);
  painter.restore();
}

void FrameView::paint(QPainter& painter) {
  if (image_.isNull()) {
    painter.setPen(palette().color(QPalette::WindowText));
    return painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, empty_words_);
  }
  painter.setRenderHint(QPainter::SmoothPixmapTransform, scale() < 2);  // pixels are seen as squares from then on
  const QRectF place(to_widget({-0.5, -0.5}), to_widget({image_.width() - 0.5, image_.height() - 0.5}));
  painter.drawImage(place, image_);
  painter.setRenderHint(QPainter::Antialiasing);
  paint_washes(painter);
  if (pair_) paint_pair(painter);
  for (std::size_t k = 0; k < shapes_.size(); ++k)
    if (int(k) != selected_) paint_shape(painter, shapes_[k], false);
  if (selected_ >= 0) paint_shape(painter, shapes_[std::size_t(selected_)], true);
  if (scaled_camera_) paint_axes(painter);
  paint_scale_bar(painter);
  if (points_.empty()) return;
  QPolygonF line;
  for (const Vec2& p : points_) line << to_widget(point_of(p));
  if (cursor_) line << to_widget(point_of(*cursor_));
  const QColor colour = kind_of(tool_) ? kind_colour(*kind_of(tool_)) : QColor(Qt::white);
  painter.setBrush(Qt::NoBrush);
  haloed(painter, colour, 1.8, [&] { painter.drawPolyline(line); });
  painter.setBrush(colour);
  painter.setPen(QPen(Qt::black, 1));
  for (std::size_t k = 0; k < points_.size(); ++k) painter.drawEllipse(line[int(k)], k == 0 ? 5.5 : 3.5, k == 0 ? 5.5 : 3.5);
  if (!kind_of(tool_) && cursor_) {
    const double apart = (*cursor_ - points_[0]).norm();
    outlined_text(painter, line.back() + QPointF(12, -8), plot::qt(plot::plain(apart) + " px"), Qt::white);
  }
}

}  // namespace pivnp::view

#include "apps/view/window/look_page.hpp"

#include <qcustomplot.h>

#include <algorithm>
#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QMouseEvent>
#include <QPainter>
#include <QSplitter>
#include <QVBoxLayout>

#include "apps/plot/canvas.hpp"
#include "apps/plot/files.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/plot/qt.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"

namespace pivnp::view {

namespace {

constexpr const char* nothing = "(none)";
constexpr const char* difference = "difference";

QPointF scene_of(const Vec2& x) { return {x.x(), -x.y()}; }
QRectF scene_of(const plot::Box& box) { return QRectF(box.lower.x(), -box.upper.y(), box.width(), box.height()); }

QImage image_of(const plot::Raster& raster) {
  return QImage(reinterpret_cast<const uchar*>(raster.pixels.data()), raster.width, raster.height, raster.width * 4, QImage::Format_ARGB32).copy();
}

// The part of the record's box that a pane shows, a little more of it, and how wide it is on the screen.
struct Window {
  plot::Box box;
  int width = 0;
};
Window window_of(const RecordPane& pane, const plot::Box& all) {
  const QRectF seen = pane.visible().adjusted(-0.05 * pane.visible().width(), 0, 0.05 * pane.visible().width(), 0) & scene_of(all);
  if (seen.isEmpty()) return {all, 16};
  const plot::Box box{{seen.left(), -seen.bottom()}, {seen.right(), -seen.top()}};
  return {box, std::clamp(int(std::ceil(seen.width() * pane.scale() * pane.devicePixelRatioF())), 16, 6000)};
}

void shadowed(QPainter& painter, const QPointF& at, const QString& words) {
  painter.setPen(QColor(0, 0, 0, 200));
  for (const QPointF off : {QPointF(1, 1), QPointF(-1, 1), QPointF(1, -1), QPointF(-1, -1)}) painter.drawText(at + off, words);
  painter.setPen(Qt::white);
  painter.drawText(at, words);
}

}  // namespace

void RecordPane::paint(QPainter& painter) {
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.setRenderHint(QPainter::Antialiasing);
  if (!picture.isNull()) painter.drawImage(QRectF(to_widget(scene_of(box).topLeft()), to_widget(scene_of(box).bottomRight())), picture);
  if (vectors) {
    const VectorField& f = *vectors;
    const double node = f.grid.spacing.x() * scale();
    const int stride = std::max(1, int(std::ceil(14 / std::max(node, 1e-6))));
    std::vector<double> lengths;
    for (std::size_t n = 0; n < f.status.size(); ++n)
      if (usable(f.status[n])) lengths.push_back(std::hypot(double(f.displacement[n][0]), double(f.displacement[n][1])));
    const double typical = plot::quantile(lengths, 0.95);
    const double longer = std::isfinite(typical) && typical > 0 ? std::clamp(1.7 * stride * node, 16.0, 60.0) / typical : 0;
    for (int j = stride / 2; j < f.grid.ny; j += stride)
      for (int i = stride / 2; i < f.grid.nx; i += stride) {
        const std::size_t n = f.grid.node(i, j);
        if (!usable(f.status[n])) continue;
        const QPointF at = to_widget(scene_of(f.grid.position(i, j))), d(double(f.displacement[n][0]) * longer, -double(f.displacement[n][1]) * longer);
        const QPointF from = f.anchor == Anchor::central ? at - d / 2 : at, to = from + d;
        const double size = std::hypot(d.x(), d.y());
        for (const bool halo : {true, false}) {
          painter.setPen(halo ? QPen(QColor(0, 0, 0, 140), 3) : QPen(f.status[n] == VectorStatus::valid ? QColor(Qt::white) : QColor(0xff, 0xa0, 0x30), 1.2));
          if (size < 1.5) {
            painter.drawEllipse(from, 1, 1);
            continue;
          }
          const QPointF e = d / size, across(-e.y(), e.x());
          const double head = std::min(5.0, 0.5 * size);
          painter.drawLine(from, to);
          painter.drawLine(to, to - head * e + 0.6 * head * across);
          painter.drawLine(to, to - head * e - 0.6 * head * across);
        }
      }
  }
  if (mark) {
    const QPointF at = to_widget(scene_of(*mark));
    painter.setBrush(Qt::NoBrush);
    for (const bool halo : {true, false}) {
      painter.setPen(halo ? QPen(Qt::black, 4) : QPen(Qt::white, 2));
      painter.drawEllipse(at, 7, 7);
      painter.drawLine(at - QPointF(12, 0), at - QPointF(4, 0));
      painter.drawLine(at + QPointF(12, 0), at + QPointF(4, 0));
      painter.drawLine(at - QPointF(0, 12), at - QPointF(0, 4));
      painter.drawLine(at + QPointF(0, 12), at + QPointF(0, 4));
    }
  }
  QFont bold = painter.font();
  bold.setBold(true);
  painter.setFont(bold);
  shadowed(painter, {12, 20}, title);
  if (picture.isNull()) return;
  const double length = plot::nice_length(130 / scale()), screen = length * scale();
  const plot::DisplayUnit shown = plot::display_unit(unit.toStdString(), length);
  const QPointF end(width() - 16.0, height() - 16.0), start = end - QPointF(screen, 0);
  painter.setPen(QPen(QColor(0, 0, 0, 160), 5));
  painter.drawLine(start, end);
  painter.setPen(QPen(Qt::white, 3));
  painter.drawLine(start, end);
  shadowed(painter, start + QPointF(0, -7), plot::qt(plot::plain(length * shown.factor) + plot::unit_suffix(shown.name)));
}

void RecordPane::mousePressEvent(QMouseEvent* event) {
  setFocus();
  pressed_ = event->position();
  ZoomView::mousePressEvent(event);
}

void RecordPane::mouseReleaseEvent(QMouseEvent* event) {
  ZoomView::mouseReleaseEvent(event);
  const QPointF off = event->position() - pressed_;
  if (event->button() != Qt::LeftButton || std::hypot(off.x(), off.y()) > 3 || !clicked) return;
  const QPointF at = to_scene(event->position());
  clicked({at.x(), -at.y()});
}

ColourBar::ColourBar(QWidget* parent) : QWidget(parent) { setFixedHeight(46); }

void ColourBar::show_scale(const plot::Scale& scale, const QString& label, const std::string& unit) {
  scale_ = scale;
  label_ = label;
  unit_ = unit;
  known_ = true;
  update();
}

void ColourBar::paintEvent(QPaintEvent*) {
  if (!known_) return;
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const double wide = std::min(460.0, width() - 40.0 - painter.fontMetrics().horizontalAdvance(label_) - 60), left = 30, top = 7, high = 14;
  const plot::DisplayUnit shown = plot::display_unit(unit_, std::max(std::abs(scale_.lower), std::abs(scale_.upper)));
  for (int k = 0; k < int(wide); ++k)
    painter.fillRect(QRectF(left + k, top, 1.5, high), plot::qt_colour(plot::colour_at(scale_.map, k / (wide - 1))));
  painter.setPen(Qt::NoPen);
  if (scale_.below) {
    painter.setBrush(plot::qt_colour(plot::colour_at(scale_.map, 0)));
    painter.drawPolygon(QPolygonF({{left, top}, {left - 10, top + high / 2}, {left, top + high}}));
  }
  if (scale_.above) {
    painter.setBrush(plot::qt_colour(plot::colour_at(scale_.map, 1)));
    painter.drawPolygon(QPolygonF({{left + wide, top}, {left + wide + 10, top + high / 2}, {left + wide, top + high}}));
  }
  painter.setPen(palette().color(QPalette::WindowText));
  const double range = (scale_.upper - scale_.lower) * shown.factor, step = plot::nice_step(range, 5);
  for (double v = std::ceil(scale_.lower * shown.factor / step - 1e-9) * step; v <= scale_.upper * shown.factor + 1e-9 * range; v += step) {
    const double x = left + (v - scale_.lower * shown.factor) / range * wide;
    painter.drawLine(QPointF(x, top + high), QPointF(x, top + high + 4));
    painter.drawText(QRectF(x - 50, top + high + 4, 100, 18), Qt::AlignHCenter, plot::qt(plot::plain(std::abs(v) < 1e-9 * range ? 0 : v)));
  }
  painter.drawText(QRectF(left + wide + 20, top - 2, width() - left - wide - 20, 20), Qt::AlignVCenter,
                   label_ + (plot::unit_words(shown.name).empty() ? QString() : " (" + plot::qt(shown.name) + ")"));
}

LookPage::LookPage(QWidget* parent) : QWidget(parent), worker_shown_(std::make_shared<Shown>()) {
  auto* whole = new QHBoxLayout(this);
  whole->setContentsMargins(0, 0, 0, 0);
  auto* split = new QSplitter;
  whole->addWidget(split);
  auto *side = new QWidget, *controls = new QWidget;
  split->addWidget(side);
  split->addWidget(controls);
  split->setStretchFactor(0, 1);
  split->setSizes({900, 380});
  auto* column = new QVBoxLayout(side);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  panes_ = new QWidget;
  auto* both = new QVBoxLayout(panes_);
  both->setContentsMargins(0, 0, 0, 0);
  both->setSpacing(2);
  left_ = new RecordPane;
  right_ = new RecordPane;
  bar_ = new ColourBar;
  pair_ = new QBoxLayout(QBoxLayout::TopToBottom);
  pair_->setSpacing(2);
  pair_->addWidget(left_, 1);
  pair_->addWidget(right_, 1);
  both->addLayout(pair_, 1);
  both->addWidget(bar_);
  right_->hide();
  column->addWidget(panes_, 1);
  message_ = new QLabel;
  message_->setObjectName("look_message");
  message_->setWordWrap(true);
  message_->setMargin(6);
  message_->hide();
  column->addWidget(message_);
  time_ = new TimeBar;
  column->addWidget(time_);
  build_right(controls);
  for (const int k : {0, 1}) {
    RecordPane &own = pane(k), &other = pane(1 - k);
    own.view_changed = [this, &own, &other] {
      other.follow(own);
      request();
    };
    own.hovered = [this, k](const QPointF& at) { tell_cursor(k, at); };
    own.left = [this] {
      if (cursor_words) cursor_words({});
    };
    own.scrub = [this](int by) { time_->step(by); };
    own.clicked = [this, k](const Vec2& x) { ask_history(k, x); };
  }
  time_->changed = [this](int) { request(); };
}

LookPage::~LookPage() = default;

void LookPage::build_right(QWidget* side) {
  auto* column = new QVBoxLayout(side);
  column->setContentsMargins(8, 6, 8, 6);
  auto* form = new QFormLayout;
  left_motion_ = new QComboBox;
  left_motion_->setObjectName("left_motion");
  right_motion_ = new QComboBox;
  right_motion_->setObjectName("right_motion");
  field_ = new QComboBox;
  field_->setObjectName("field");
  field_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  form->addRow("Motion", left_motion_);
  form->addRow("Beside it", right_motion_);
  form->addRow("Field", field_);
  frames_ = new QCheckBox("frame");
  particles_ = new QCheckBox("particles");
  arrows_ = new QCheckBox("vectors");
  auto* layers = new QHBoxLayout;
  for (QCheckBox* box : {frames_, particles_, arrows_}) layers->addWidget(box);
  frames_->setChecked(true);
  particles_->setChecked(true);
  form->addRow("Show", layers);
  percentile_ = new QDoubleSpinBox;
  percentile_->setRange(50, 100);
  percentile_->setDecimals(1);
  percentile_->setValue(99);
  percentile_->setSuffix(" % of the values");
  percentile_->setKeyboardTracking(false);
  form->addRow("Colours over", percentile_);
  by_hand_ = new QCheckBox("from");
  lower_ = new QLineEdit;
  upper_ = new QLineEdit;
  auto* range = new QHBoxLayout;
  range->addWidget(by_hand_);
  range->addWidget(lower_);
  range->addWidget(new QLabel("to"));
  range->addWidget(upper_);
  form->addRow("or by hand", range);
  column->addLayout(form);
  point_ = new QLabel("Click a particle: its history");
  point_->setWordWrap(true);
  column->addWidget(point_);
  plot_ = new QCustomPlot;
  plot_->setMinimumHeight(230);
  plot_->setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
  column->addWidget(plot_, 1);
  column->addStretch();
  const auto again = [this] { request(); };
  for (QComboBox* box : {left_motion_, right_motion_, field_})
    connect(box, &QComboBox::activated, this, [this] {
      right_->setVisible(right_motion_->currentText() != nothing && right_motion_->count() > 0);
      show_history();
      request();
    });
  for (QCheckBox* box : {frames_, particles_, arrows_, by_hand_}) connect(box, &QCheckBox::toggled, this, again);
  connect(percentile_, &QDoubleSpinBox::valueChanged, this, again);
  for (QLineEdit* line : {lower_, upper_})
    connect(line, &QLineEdit::editingFinished, this, [this] {
      if (by_hand_->isChecked()) request();
    });
  show_history();
}

void LookPage::say(const QString& words) {
  said_ = words;
  message_->setText(words);
  message_->setStyleSheet("background:#8c1d1d;color:white");
  message_->setVisible(!words.isEmpty());
}

bool LookPage::idle() { return reading_.idle(); }

const ShownField* LookPage::field() const {
  const int at = field_->currentIndex();
  return look_ && at >= 0 && at < int(look_->fields().size()) ? &look_->fields()[std::size_t(at)] : nullptr;
}

void LookPage::open(const std::filesystem::path& record) {
  const int number = ++number_;
  say({});
  time_->set_words("reading " + plot::qt(record.filename().string()) + " ...");
  reading_.post(0, [this, record, number](const Worker::Stop&) {
    std::shared_ptr<RecordLook> look;
    QString fault;
    try {
      look = std::make_shared<RecordLook>(record);
      *worker_shown_ = {};
    } catch (const std::exception& error) {
      fault = plot::qt(error.what());
    }
    Worker::tell(this, [this, look, fault, number, record]() mutable {
      if (number != number_) return retire(std::move(look));
      if (!look) {
        time_->set_words({});
        say(fault);
        if (opened) opened();
        return;
      }
      retire(std::move(look_));
      look_ = std::move(look);
      file_ = record;
      history_.reset();
      left_->mark.reset();
      right_->mark.reset();
      at_left_ = at_right_ = {};
      fill_choices();
      if (!look_->complaint().empty()) say(plot::qt(look_->complaint()));
      {
        const QSignalBlocker quiet(time_->slider());
        time_->set_count(int(look_->times().size()));
        time_->go(int(look_->times().size()) - 1);
      }
      for (RecordPane* p : {left_, right_}) {
        p->unit = plot::qt(look_->length_unit());
        p->set_extent(scene_of(look_->box()), true);
      }
      show_history();
      request();
      if (opened) opened();
    });
  });
}

void LookPage::retire(std::shared_ptr<RecordLook> look) {
  constexpr int after_all = 100;
  if (look) reading_.post(after_all + ++retired_, [look = std::move(look)](const Worker::Stop&) {});
}

void LookPage::fill_choices() {
  const std::vector<std::string>& names = look_->motions();
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  left_motion_->clear();
  right_motion_->clear();
  field_->clear();
  right_motion_->addItem(nothing);
  for (const std::string& name : names) {
    left_motion_->addItem(plot::qt(name));
    right_motion_->addItem(plot::qt(name));
  }
  if (names.size() > 1) right_motion_->addItem(difference);
  if (has("np")) left_motion_->setCurrentText("np");
  if (has("np") && has("mpm")) right_motion_->setCurrentText("mpm");
  pair_->setDirection(look_->box().width() > look_->box().height() ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
  right_->setVisible(right_motion_->currentText() != nothing);
  for (const ShownField& f : look_->fields()) field_->addItem(plot::qt(f.label));
  for (std::size_t k = 0; k < look_->fields().size(); ++k)
    if (look_->fields()[k].name == "displacement_magnitude") field_->setCurrentIndex(int(k));
  const bool particles = !names.empty();
  for (QWidget* w : {static_cast<QWidget*>(left_motion_), static_cast<QWidget*>(right_motion_), static_cast<QWidget*>(field_), static_cast<QWidget*>(particles_)})
    w->setEnabled(particles);
  frames_->setEnabled(look_->has_frames());
  const QSignalBlocker quiet(arrows_);
  arrows_->setChecked(!particles);
}

void LookPage::request() {
  if (!look_ || look_->times().empty()) return;
  const double time = look_->times()[std::size_t(time_->at())];
  time_->set_words(plot::qt(std::to_string(time_->at() + 1) + " of " + std::to_string(look_->times().size()) + "   " + plot::plain(time) + " " + look_->time_unit()));
  const ShownField shown_field = field() ? *field() : ShownField{};
  const std::string left = left_motion_->currentText().toStdString();
  std::string right = right_motion_->currentText().toStdString();
  if (right == nothing) right.clear();
  bool good_lower = false, good_upper = false;
  const double lower = lower_->text().toDouble(&good_lower), upper = upper_->text().toDouble(&good_upper);
  const bool hand = by_hand_->isChecked() && good_lower && good_upper && upper > lower;
  const Window seen = window_of(*left_, look_->box());
  reading_.post(1, [this, look = look_, shown = worker_shown_, time, shown_field, left, right, lower, upper, hand, seen, share = 1 - percentile_->value() / 100,
                    frames = frames_->isChecked(), particles = particles_->isChecked(), arrows = arrows_->isChecked(), number = number_](const Worker::Stop&) {
    QString fault;
    QImage pictures[2];
    plot::Scale scale;
    try {
      // The field that stands at the right may be that of the left's other motion, less the left's.
      const std::string key = std::to_string(time) + "|" + shown_field.name + "|" + left + "|" + right + (arrows ? "|v" : "");
      if (key != shown->key) {
        Shown next;
        if (!left.empty()) next.left = look->picture(left, shown_field.name, time);
        next.has_right = !left.empty() && !right.empty();
        if (next.has_right && right == difference) {
          const std::vector<std::string>& names = look->motions();
          const std::string other = left != "mpm" && std::find(names.begin(), names.end(), "mpm") != names.end() ? "mpm" : names[0] != left ? names[0] : names[1];
          next.right = RecordLook::difference(next.left, look->picture(other, shown_field.name, time), look->motion(left), look->motion(other));
        } else if (next.has_right) {
          next.right = look->picture(right, shown_field.name, time);
        }
        next.frame = look->frame(time);
        if (arrows) next.vectors = look->vectors(time);
        next.key = key;
        *shown = std::move(next);
      }
      std::vector<const ParticlePicture*> all{&shown->left};
      if (shown->has_right) all.push_back(&shown->right);
      scale = scale_of(all, share);
      if (hand) {
        scale.lower = lower;
        scale.upper = upper;
        scale.below = scale.above = true;
        scale.map = lower < 0 && upper > 0 ? plot::Colours::diverging : plot::Colours::sequential;
      }
      QImage ground;
      if (frames && shown->frame) ground = image_of(plot::draw_image(shown->frame->view(), look->world_from_pixel(), seen.box, seen.width, 0, particles && !left.empty() ? 170 : 255));
      for (int k = 0; k < (shown->has_right ? 2 : 1); ++k) {
        QImage& out = pictures[k] = ground;
        if (!particles || left.empty()) continue;
        const QImage tiles = image_of(raster_of(k == 0 ? shown->left : shown->right, scale, seen.box, seen.width));
        if (out.isNull()) {
          out = tiles;
          continue;
        }
        QPainter painter(&out);
        painter.setOpacity(0.8);
        painter.drawImage(QRect(QPoint(0, 0), out.size()), tiles);
      }
      if (pictures[0].isNull()) {
        pictures[0] = QImage(4, 4, QImage::Format_ARGB32);
        pictures[0].fill(Qt::transparent);
      }
    } catch (const std::exception& error) {
      fault = plot::qt(error.what());
    }
    Worker::tell(this, [this, pictures0 = pictures[0], pictures1 = pictures[1], scale, fault, number, box = seen.box, left, right, shown_field, l = shown->left,
                        r = shown->right, vectors = arrows ? shown->vectors : std::nullopt, arrows]() mutable {
      if (number != number_) return;
      time_->shown();
      if (!fault.isEmpty()) return say(fault);
      at_left_ = std::move(l);
      at_right_ = std::move(r);
      const auto title = [&](const std::string& name, const ParticlePicture& p) {
        const QString what = name == "np" ? "measured" : name == "mpm" ? "simulated" : name == difference ? "second less first" : "";
        return plot::qt(name) + (what.isEmpty() ? QString() : ", " + what) + (p.known ? QString() : "   (not at this time)");
      };
      left_->picture = pictures0;
      right_->picture = pictures1;
      for (RecordPane* p : {left_, right_}) {
        p->box = box;
        p->vectors = p == left_ ? vectors : std::nullopt;
        p->update();
      }
      left_->title = left.empty() ? QString("vectors") : title(left, at_left_);
      right_->title = title(right, at_right_);
      bar_->setVisible(!left.empty());
      bar_->show_scale(scale, plot::qt(shown_field.label), shown_field.unit);
      show_history();
    });
  });
}

void LookPage::ask_history(int side, const Vec2& place) {
  if (!look_ || look_->motions().empty()) return;
  const ParticlePicture& shown = side == 0 ? at_left_ : at_right_;
  const std::string left = left_motion_->currentText().toStdString(), right = right_motion_->currentText().toStdString();
  std::vector<std::string> sides{left};
  for (const std::string& name : look_->motions())
    if (name != left && (name == right || ((name == "np" || name == "mpm") && right == difference))) sides.push_back(name);
  reading_.post(2, [this, look = look_, shown, place, sides, number = number_](const Worker::Stop& stop) {
    std::shared_ptr<History> history;
    QString fault;
    try {
      history = std::make_shared<History>(look->history(shown.motion, shown, place, sides));
    } catch (const std::exception& error) {
      fault = plot::qt(error.what());
    }
    if (stop()) return;
    Worker::tell(this, [this, history, fault, number, place] {
      if (number != number_) return;
      if (!history) return point_->setText(fault);
      history_ = *history;
      left_->mark = right_->mark = place;
      left_->update();
      right_->update();
      show_history();
    });
  });
}

void LookPage::show_history() {
  plot_->setVisible(history_.has_value());
  plot_->clearPlottables();
  plot_->clearItems();
  const QPalette colours = palette();
  const QColor ink = colours.color(QPalette::WindowText), ground = colours.color(QPalette::Base);
  plot_->setBackground(ground);
  for (QCPAxis* axis : {plot_->xAxis, plot_->yAxis}) {
    axis->setBasePen(ink);
    axis->setTickPen(ink);
    axis->setSubTickPen(ink);
    axis->setTickLabelColor(ink);
    axis->setLabelColor(ink);
    axis->grid()->setPen(QPen(QColor(128, 128, 128, 70), 1));
  }
  const ShownField* f = field();
  const bool strain = f && f->name.find("strain") != std::string::npos;
  plot_->legend->setVisible(history_.has_value());
  plot_->legend->setBrush(ground);
  plot_->legend->setTextColor(ink);
  plot_->legend->setBorderPen(Qt::NoPen);
  plot_->axisRect()->insetLayout()->setInsetAlignment(0, Qt::AlignTop | Qt::AlignLeft);
  if (history_) {
    double most = 0;
    for (const History::Side& side : history_->sides)
      for (const double v : side.curve.displacement)
        if (std::isfinite(v)) most = std::max(most, v);
    const plot::DisplayUnit shown = strain ? plot::DisplayUnit{} : plot::display_unit(look_->length_unit(), most);
    plot_->xAxis->setLabel(plot::qt("time (" + look_->time_unit() + ")"));
    plot_->yAxis->setLabel(strain ? QString("deviatoric strain") : plot::qt("displacement (" + shown.name + ")"));
    int k = 0;
    for (const History::Side& side : history_->sides) {
      const QColor colour = plot::qt_colour(k++ == 0 ? plot::blue : plot::vermilion);
      const std::vector<double>&value = strain ? side.curve.strain : side.curve.displacement, &sigma = strain ? side.curve.strain_sigma : side.curve.sigma;
      QVector<double> t, mid, low, high;
      for (std::size_t n = 0; n < value.size(); ++n) {
        t << side.curve.time[n];
        mid << value[n] * shown.factor;
        const double s = sigma.empty() || !std::isfinite(sigma[n]) ? 0 : 2 * sigma[n] * shown.factor;
        low << mid.back() - s;
        high << mid.back() + s;
      }
      if (!sigma.empty()) {
        QCPGraph *below = plot_->addGraph(), *above = plot_->addGraph();
        below->setData(t, low, true);
        above->setData(t, high, true);
        QColor wash = colour;
        wash.setAlpha(70);
        for (QCPGraph* g : {below, above}) g->setPen(Qt::NoPen);
        above->setBrush(wash);
        above->setChannelFillGraph(below);
        below->removeFromLegend();
        above->setName(plot::qt(side.motion + " ± 2 stated errors"));
      }
      QCPGraph* line = plot_->addGraph();
      line->setData(t, mid, true);
      line->setPen(QPen(colour.lighter(ground.lightness() < 128 ? 140 : 100), 1.8));
      line->setName(plot::qt(side.motion));
    }
    plot_->rescaleAxes();
    plot_->yAxis->scaleRange(1.15, plot_->yAxis->range().center());
    const double now = look_->times()[std::size_t(time_->at())];
    auto* cursor = new QCPItemStraightLine(plot_);
    cursor->setPen(QPen(ink, 1, Qt::DotLine));
    cursor->point1->setCoords(now, 0);
    cursor->point2->setCoords(now, 1);
    const plot::DisplayUnit at = plot::display_unit(look_->length_unit(), std::max(std::abs(history_->x0.x()), std::abs(history_->x0.y())));
    point_->setText(plot::qt("Material point (" + plot::significant(history_->x0.x() * at.factor) + ", " + plot::significant(history_->x0.y() * at.factor) + ") " + at.name +
                             " at the first frame"));
  } else {
    point_->setText("Click a particle: its history");
  }
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

void LookPage::tell_cursor(int side, const QPointF& scene) {
  if (!cursor_words || !look_) return;
  const Vec2 x(scene.x(), -scene.y());
  const ParticlePicture& shown = side == 0 ? at_left_ : at_right_;
  const std::string& unit = look_->length_unit();
  const plot::DisplayUnit place = plot::display_unit(unit, std::max(std::abs(x.x()), std::abs(x.y())));
  QString words = plot::qt("x " + plot::significant(x.x() * place.factor, 4) + ", y " + plot::significant(x.y() * place.factor, 4) + " " + place.name);
  std::size_t best = shown.field.position.size();
  double nearest = 12 / pane(side).scale();
  for (std::size_t p = 0; p < shown.field.position.size(); ++p)
    if (const double d = (shown.field.position[p] - x).norm(); d < nearest && alive(shown.field.status[p])) nearest = d, best = p;
  if (best < shown.field.position.size() && field()) {
    const double value = shown.field.value[best], sigma = best < shown.sigma.size() ? shown.sigma[best] : nan_value;
    const plot::DisplayUnit own = plot::display_unit(field()->unit, std::abs(value));
    words += "     " + plot::qt(field()->label + " " + plot::value_with_uncertainty(value * own.factor, sigma * own.factor) + plot::unit_suffix(own.name));
  }
  cursor_words(words);
}

void LookPage::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) show_history();
}

void LookPage::fit() {
  left_->fit();
}

void LookPage::write_csv(const std::filesystem::path& file, const std::function<void(QString)>& done) {
  if (!look_ || at_left_.motion.empty() || !field()) return done("There are no particles to write.");
  reading_.post(3, [this, look = look_, picture = at_left_, f = *field(), file, done](const Worker::Stop&) {
    QString words;
    try {
      plot::write_file(file, csv_of(picture, look->motion(picture.motion), f));
    } catch (const std::exception& error) {
      words = plot::qt(error.what());
    }
    Worker::tell(this, [done, words] { done(words); });
  });
}

}  // namespace pivnp::view

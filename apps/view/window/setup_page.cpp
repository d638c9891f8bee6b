#include "apps/view/window/setup_page.hpp"

#include <cmath>

#include <Eigen/LU>
#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QInputDialog>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QPainter>
#include <QPushButton>
#include <QSpinBox>
#include <QSplitter>
#include <QToolButton>
#include <QVBoxLayout>

#include "apps/case/lengths.hpp"
#include "apps/case/values.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/plot/qt.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/piv/methods.hpp"

namespace pivnp::view {

namespace {

struct ToolRow {
  Tool tool;
  const char *name, *help;
  QColor colour;
};

const std::vector<ToolRow>& tool_rows() {
  static const std::vector<ToolRow> rows = {
      {Tool::select, "Select", "Select, drag points and outlines; double click an edge: one point more; right click a point: one less (V)", {}},
      {Tool::region, "Region", "Where material is at the first frame (R)", QColor(0x2e, 0xc4, 0x7a)},
      {Tool::mask, "Mask", "What must not be measured (M)", QColor(0xff, 0x5a, 0x4f)},
      {Tool::wall, "Wall", "A wall of the simulation (W)", QColor(0x56, 0xb4, 0xe9)},
      {Tool::still_zone, "Still zone", "Material at rest, for the noise floor of strain (Z)", QColor(0xf0, 0xc0, 0x30)},
      {Tool::scale, "Scale", "Two clicks a known length apart (S)", {}},
      {Tool::origin, "Origin", "Where the world's (0, 0) is (O)", {}},
      {Tool::horizontal, "Level", "Two clicks along the x axis, where the camera is tilted (H)", {}},
  };
  return rows;
}

QIcon dot(const QColor& colour) {
  QPixmap pixmap(24, 24);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setBrush(colour);
  painter.setPen(QPen(colour.darker(160), 1.5));
  painter.drawRoundedRect(QRectF(5, 5, 14, 14), 3, 3);
  return pixmap;
}

QString of_number(double value, int digits = 4) { return plot::qt(plot::significant(value, digits)); }

}  // namespace

SetupPage::SetupPage(QWidget* parent) : QWidget(parent) {
  auto* whole = new QHBoxLayout(this);
  whole->setContentsMargins(0, 0, 0, 0);
  auto* split = new QSplitter;
  whole->addWidget(split);
  auto *left_side = new QWidget, *right_side = new QWidget;
  build_left(left_side);
  build_right(right_side);
  split->addWidget(left_side);
  split->addWidget(right_side);
  split->setStretchFactor(0, 1);
  split->setStretchFactor(1, 0);
  split->setSizes({860, 420});
  connect_view();
  pair_soon_.setSingleShot(true);
  pair_soon_.setInterval(150);
  connect(&pair_soon_, &QTimer::timeout, this, [this] { request_pair(); });
  frames_soon_.setSingleShot(true);
  frames_soon_.setInterval(400);
  connect(&frames_soon_, &QTimer::timeout, this, [this] { reopen_frames(); });
  refresh();
}

SetupPage::~SetupPage() = default;

void SetupPage::build_left(QWidget* side) {
  auto* column = new QVBoxLayout(side);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  auto* bar = new QWidget;
  auto* row = new QHBoxLayout(bar);
  row->setContentsMargins(6, 4, 6, 4);
  row->setSpacing(2);
  tools_ = new QButtonGroup(this);
  for (const ToolRow& tool : tool_rows()) {
    auto* button = new QToolButton;
    button->setText(tool.name);
    button->setToolTip(tool.help);
    button->setCheckable(true);
    button->setAutoRaise(true);
    button->setFocusPolicy(Qt::NoFocus);
    if (tool.colour.isValid()) {
      button->setIcon(dot(tool.colour));
      button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    }
    tools_->addButton(button, int(tool.tool));
    row->addWidget(button);
  }
  tools_->button(int(Tool::select))->setChecked(true);
  row->addStretch();
  picture_words_ = new QLabel;
  row->addWidget(picture_words_);
  column->addWidget(bar);
  view_ = new FrameView;
  column->addWidget(view_, 1);

  scale_row_ = new QWidget;
  auto* ask = new QHBoxLayout(scale_row_);
  ask->setContentsMargins(8, 4, 8, 4);
  ask->addWidget(new QLabel("Their distance:"));
  length_ = new QLineEdit;
  length_->setObjectName("length");
  length_->setMaximumWidth(120);
  length_unit_ = new QComboBox;
  auto* accept = new QPushButton("Set scale");
  accept->setObjectName("set_scale");
  auto* cancel = new QPushButton("Cancel");
  for (QWidget* w : {static_cast<QWidget*>(length_), static_cast<QWidget*>(length_unit_), static_cast<QWidget*>(accept), static_cast<QWidget*>(cancel)}) ask->addWidget(w);
  ask->addStretch();
  scale_row_->hide();
  column->addWidget(scale_row_);
  connect(length_, &QLineEdit::returnPressed, this, [this] { apply_scale(); });
  connect(accept, &QPushButton::clicked, this, [this] { apply_scale(); });
  connect(cancel, &QPushButton::clicked, this, [this] {
    scale_ends_.reset();
    scale_row_->hide();
  });

  message_ = new QLabel;
  message_->setObjectName("message");
  message_->setWordWrap(true);
  message_->setMargin(6);
  message_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  message_->hide();
  column->addWidget(message_);
  time_ = new TimeBar;
  column->addWidget(time_);
}

void SetupPage::build_right(QWidget* side) {
  auto* column = new QVBoxLayout(side);
  column->setContentsMargins(8, 6, 8, 6);
  auto* form = new QFormLayout;
  form->setVerticalSpacing(5);
  scale_words_ = new QLabel;
  form->addRow("Scale", scale_words_);
  rate_ = new QLineEdit;
  rate_->setObjectName("rate");
  form->addRow("Frames a second", rate_);
  method_ = new QComboBox;
  method_->setObjectName("method");
  for (const auto& row : piv::piv_methods()) {
    method_->addItem(plot::qt(row.name));
    method_->setItemData(method_->count() - 1, plot::qt(row.text), Qt::ToolTipRole);
  }
  form->addRow("Method", method_);
  window_ = new QSpinBox;
  window_->setObjectName("window");
  window_->setRange(8, 256);
  window_->setSuffix(" px");
  window_->setKeyboardTracking(false);
  form->addRow("Window", window_);
  spacing_ = new QDoubleSpinBox;
  spacing_->setObjectName("spacing");
  spacing_->setKeyboardTracking(false);
  spacing_->setSpecialValueText("a quarter of the window");
  spacing_label_ = new QLabel("Node spacing");
  form->addRow(spacing_label_, spacing_);
  auto* live_row = new QHBoxLayout;
  live_ = new QCheckBox("of the pair shown");
  live_->setObjectName("live");
  colour_ = new QComboBox;
  colour_->addItems({"by status", "by score", "by stated error"});
  live_row->addWidget(live_);
  live_row->addWidget(colour_, 1);
  form->addRow("Vectors", live_row);
  pair_words_ = new QLabel;
  pair_words_->setWordWrap(true);
  form->addRow(QString(), pair_words_);
  column->addLayout(form);

  column->addWidget(new QLabel("Outlines"));
  shapes_ = new QListWidget;
  shapes_->setObjectName("shapes");
  shapes_->setMaximumHeight(104);
  shapes_->setContextMenuPolicy(Qt::CustomContextMenu);
  column->addWidget(shapes_);
  column->addWidget(new QLabel("The case, as it is saved"));
  editor_ = new TomlEditor;
  column->addWidget(editor_, 1);
  faults_ = new QListWidget;
  faults_->setObjectName("faults");
  faults_->setWordWrap(true);
  faults_->setMaximumHeight(120);
  faults_->hide();
  column->addWidget(faults_);

  connect(rate_, &QLineEdit::editingFinished, this, [this] {
    bool good = false;
    const double value = rate_->text().toDouble(&good);
    if (rate_->text().isEmpty()) attempt([&] { session_.set_key({"frames", "rate_hz"}, ""); });
    else if (good && value > 0) attempt([&] { session_.set_key({"frames", "rate_hz"}, app::toml_text(value)); });
    else say("frames.rate_hz: expected a number above 0", true);
  });
  connect(method_, &QComboBox::activated, this, [this] { attempt([&] { session_.set_key({"piv", "method"}, app::toml_text(method_->currentText().toStdString())); }); });
  connect(window_, &QSpinBox::valueChanged, this, [this](int value) { attempt([&] { session_.set_key({"piv", "window_px"}, std::to_string(value)); }); });
  connect(spacing_, &QDoubleSpinBox::valueChanged, this, [this](double value) {
    const bool world = session_.seen().grid.spacing_m.has_value();
    attempt([&] { session_.set_key({"grid", world ? "spacing_m" : "spacing_px"}, value <= spacing_->minimum() ? "" : app::toml_text(value)); });
  });
  connect(live_, &QCheckBox::toggled, this, [this](bool on) {
    pair_.reset();
    view_->set_pair({});
    pair_words_->clear();
    if (on) request_pair();
  });
  connect(colour_, &QComboBox::activated, this, [this](int index) { view_->set_vector_colour(VectorColour(index)); });
  connect(shapes_, &QListWidget::currentRowChanged, this, [this](int row) {
    if (!refreshing_) view_->select(row);
  });
  connect(shapes_, &QListWidget::customContextMenuRequested, this, [this](const QPoint& at) {
    if (const QListWidgetItem* item = shapes_->itemAt(at)) shape_menu(shapes_->row(item), shapes_->mapToGlobal(at));
  });
  connect(faults_, &QListWidget::itemActivated, this, [this](QListWidgetItem* item) { editor_->go_to(item->data(Qt::UserRole).toInt()); });
  connect(faults_, &QListWidget::itemClicked, this, [this](QListWidgetItem* item) { editor_->go_to(item->data(Qt::UserRole).toInt()); });
}

void SetupPage::connect_view() {
  connect(tools_, &QButtonGroup::idClicked, this, [this](int id) { set_tool(Tool(id)); });
  view_->drawn = [this](ShapeKind kind, const std::vector<Vec2>& points) { attempt([&] { session_.add_shape(kind, points); }); };
  view_->moved = [this](int shape, const std::vector<Vec2>& points) { attempt([&] { session_.set_points(std::size_t(shape), points); }); };
  view_->origin_set = [this](const Vec2& p) { attempt([&] { session_.set_origin(p); }); };
  view_->turned = [this](const Vec2& a, const Vec2& b) { attempt([&] { session_.set_horizontal(a, b); }); };
  view_->scaled = [this](const Vec2& a, const Vec2& b) {
    scale_ends_ = {a, b};
    const std::string unit = session_.seen().camera.length_unit;
    const QString before = length_unit_->currentText();
    length_unit_->clear();
    if (app::is_length_unit(unit)) length_unit_->addItems({"mm", "cm", "m"});
    else length_unit_->addItem(plot::qt(unit));
    if (length_unit_->findText(before) >= 0) length_unit_->setCurrentText(before);
    length_->clear();
    scale_row_->show();
    length_->setFocus();
  };
  view_->tool_done = [this] { set_tool(Tool::select); };
  view_->says = [this](const QString& words) { say(words, false); };
  view_->selection_changed = [this](int shape) {
    refreshing_ = true;
    shapes_->setCurrentRow(shape);
    refreshing_ = false;
  };
  view_->menu_asked = [this](int shape, const QPoint& at) { shape_menu(shape, at); };
  view_->hovered = [this](const QPointF& px) { tell_cursor(px); };
  view_->left = [this] {
    if (cursor_words) cursor_words({});
  };
  view_->scrub = [this](int by) { time_->step(by); };
  time_->changed = [this](int) {
    pair_.reset();
    view_->set_pair({});
    request_frame();
    pair_soon_.start();
  };
  editor_->typed = [this](const std::string& text) {
    session_.set_text(text, true);
    refresh();
  };
}

template <class F>
void SetupPage::attempt(F&& change) {
  if (refreshing_) return;
  try {
    change();
    say({}, false);
  } catch (const InputError& error) {
    say(plot::qt(error.what()), true);
  }
  refresh();
}

void SetupPage::say(const QString& words, bool fault) {
  message_->setText(words);
  message_->setStyleSheet(fault ? "background:#8c1d1d;color:white" : "background:palette(alternate-base)");
  message_->setVisible(!words.isEmpty());
}

void SetupPage::take(Opened opened) {
  ++opened_;
  session_.take(std::move(opened));
  image_.reset();
  pair_.reset();
  view_->set_pair({});
  view_->select(-1);
  view_->set_shapes({});
  view_->set_image({});
  scale_row_->hide();
  const QSignalBlocker quiet(time_->slider());
  time_->set_count(session_.frames() ? int(session_.frames()->frames().size()) : 0);
  time_->go(0);
  say(plot::qt(session_.complaint()), !session_.complaint().empty());
  refresh();
  request_frame();
}

void SetupPage::set_tool(Tool tool) {
  tools_->button(int(tool))->setChecked(true);
  view_->set_tool(tool);
  if (tool != Tool::select) view_->setFocus();
}

void SetupPage::undo() {
  session_.undo();
  say({}, false);
  refresh();
}

void SetupPage::redo() {
  session_.redo();
  refresh();
}

void SetupPage::remove_selected() {
  if (view_->selected() >= 0) attempt([&] { session_.remove_shape(std::size_t(view_->selected())); });
}

void SetupPage::save(const std::filesystem::path& file) {
  session_.save(file);
  refresh();
}

bool SetupPage::idle() { return !pair_soon_.isActive() && !frames_soon_.isActive() && reading_.idle() && measuring_.idle(); }

void SetupPage::refresh() {
  editor_->show_text(session_.text());
  editor_->show_faults(session_.faults());
  faults_->clear();
  for (const Fault& fault : session_.faults()) {
    auto* item = new QListWidgetItem(plot::qt(fault.text), faults_);
    item->setData(Qt::UserRole, fault.line);
  }
  faults_->setVisible(!session_.faults().empty() && !session_.empty());
  view_->set_empty_words(session_.empty() ? "Drop a video, a folder of frames, a case or a record here, or use File > Open" : "No frames are open");
  view_->set_camera(session_.camera(), session_.camera().length_unit() != "px");
  view_->set_shapes(session_.shapes());
  refresh_controls();
  refresh_shapes();
  if (session_.frames_stale()) frames_soon_.start();
  if (live_->isChecked()) pair_soon_.start();
  if (changed) changed();
}

void SetupPage::refresh_controls() {
  refreshing_ = true;
  const app::Case& c = session_.seen();
  const piv::PivOptions p = c.piv.value_or(piv::PivOptions{});
  const std::string unit = session_.camera().length_unit();
  QString scale = "none: lengths are in px";
  if (unit != "px") {
    const double each = session_.frames() ? std::sqrt(std::abs(session_.camera().jacobian({session_.frames()->width() / 2.0, session_.frames()->height() / 2.0}).determinant())) : 0;
    const plot::DisplayUnit shown = plot::display_unit(unit, each);
    scale = of_number(each * shown.factor) + " " + plot::qt(shown.name) + "/px";
    if (!c.camera.points_px.empty()) scale += ", by " + QString::number(c.camera.points_px.size()) + " targets";
    if (session_.camera().residual() > 0 && !c.camera.points_px.empty()) scale += ", RMS " + of_number(session_.camera().residual(), 2) + " " + plot::qt(unit);
  }
  scale_words_->setText(scale);
  rate_->setPlaceholderText(session_.frames() && session_.frames()->has_rate() ? "default: as the video states" : "default: times are counted in frames");
  if (!rate_->hasFocus()) rate_->setText(c.frames && c.frames->rate_hz ? plot::qt(app::toml_text(*c.frames->rate_hz)) : QString());
  if (const int at = method_->findText(plot::qt(p.method)); at >= 0) method_->setCurrentIndex(at);
  window_->setValue(p.window_px);
  const bool world = c.grid.spacing_m.has_value();
  spacing_label_->setText(world ? plot::qt("Node spacing (" + unit + ")") : QString("Node spacing"));
  spacing_->setSuffix(world ? QString() : QString(" px"));
  spacing_->setDecimals(world ? 6 : 1);
  spacing_->setRange(0, world ? 1e6 : 500);
  spacing_->setSingleStep(world ? *c.grid.spacing_m / 10 : 1);
  spacing_->setValue(world ? *c.grid.spacing_m : c.grid.spacing_px.value_or(0));
  for (QWidget* w : {static_cast<QWidget*>(rate_), static_cast<QWidget*>(method_), static_cast<QWidget*>(window_), static_cast<QWidget*>(spacing_),
                     static_cast<QWidget*>(live_), static_cast<QWidget*>(colour_)})
    w->setEnabled(session_.frames() != nullptr);
  const auto& frames = session_.frames();
  picture_words_->setText(frames ? QString("%1 frames, %2 × %3 px").arg(frames->frames().size()).arg(frames->width()).arg(frames->height()) : QString());
  refreshing_ = false;
}

void SetupPage::refresh_shapes() {
  refreshing_ = true;
  shapes_->clear();
  for (const Shape& shape : session_.shapes()) {
    const QIcon icon = dot(tool_rows()[std::size_t(shape.kind) + 1].colour);
    const QString name = shape.kind == ShapeKind::still_zone ? QString("Still zone") : plot::qt(std::string(name_of(shape.kind)) + " " + shape.name());
    shapes_->addItem(new QListWidgetItem(icon, name + (shape.circle ? QString("   circle") : QString("   %1 points%2").arg(shape.points.size()).arg(shape.world ? ", in the world" : ""))));
  }
  shapes_->setCurrentRow(view_->selected());
  refreshing_ = false;
}

void SetupPage::request_frame() {
  const auto frames = session_.frames();
  if (!frames) return;
  const int index = time_->at();
  const Frame& frame = frames->frames()[std::size_t(index)];
  const std::string time = plot::plain(frame.time) + (frames->has_rate() ? " s" : " frames");
  time_->set_words(plot::qt(std::to_string(index + 1) + " of " + std::to_string(frames->frames().size()) + "   " + time + "   " + frame.name));
  reading_.post(0, [this, frames, index, number = opened_](const Worker::Stop&) {
    std::shared_ptr<const Image> image;
    QImage screen;
    QString fault;
    try {
      image = frames->shared(index);
      screen = screen_image(image->view());
    } catch (const std::exception& error) {
      fault = plot::qt(error.what());
    }
    Worker::tell(this, [this, image, screen, fault, number] {
      if (number != opened_) return;
      if (fault.isEmpty()) {
        image_ = image;
        view_->set_image(screen);
      } else {
        say(fault, true);
      }
      time_->shown();
    });
  });
}

void SetupPage::request_pair() {
  const auto frames = session_.frames();
  const app::Case* valid = session_.valid();
  if (!live_->isChecked() || !frames) return;
  if (!valid) return pair_words_->setText("the case has faults");
  if (frames->frames().size() < 2) return pair_words_->setText("there is one frame only");
  pair_words_->setText("measuring ...");
  const int index = time_->at();
  measuring_.post(0, [this, frames, c = *valid, index, seen = view_->visible_pixels(), number = opened_](const Worker::Stop& stop) {
    const auto show = [&](LivePair pair) {
      if (stop()) return;
      Worker::tell(this, [this, pair = std::move(pair), index, number]() mutable {
        if (number != opened_ || index != time_->at() || !live_->isChecked()) return;
        std::size_t asked = 0, valid_count = 0;
        for (const VectorStatus s : pair.field.status) asked += s != VectorStatus::masked, valid_count += s == VectorStatus::valid;
        pair_words_->setText(plot::qt(std::to_string(asked) + " vectors, " + plot::percent(asked ? double(valid_count) / double(asked) : 0) + " valid, " +
                                      plot::significant(pair.seconds, 2) + " s" + (pair.part ? ", of what is seen" : "")));
        pair_ = std::move(pair);
        view_->set_pair(pair_);
      });
    };
    try {
      measure_live(c, *frames, index, seen, 0, stop, show);
    } catch (const std::exception& error) {
      Worker::tell(this, [this, words = plot::qt(error.what()), number] {
        if (number != opened_) return;
        pair_.reset();
        view_->set_pair({});
        pair_words_->setText(words);
      });
    }
  });
}

void SetupPage::reopen_frames() {
  if (!session_.frames_stale()) return;
  reading_.post(1, [this, open = session_.reopening(), number = opened_](const Worker::Stop& stop) {
    auto opened = std::make_shared<Opened>(open());
    if (stop()) return;
    Worker::tell(this, [this, opened, number] {
      if (number != opened_) return;
      session_.take_frames(std::move(*opened));
      image_.reset();
      if (!session_.frames()) view_->set_image({});
      const int before = time_->at();
      {
        const QSignalBlocker quiet(time_->slider());
        time_->set_count(session_.frames() ? int(session_.frames()->frames().size()) : 0);
        time_->go(before);
      }
      say(plot::qt(session_.complaint()), !session_.complaint().empty());
      refresh();
      request_frame();
    });
  });
}

void SetupPage::apply_scale() {
  if (!scale_ends_) return;
  bool good = false;
  const double value = length_->text().replace(',', '.').toDouble(&good);
  if (!good) return say("Their distance: expected a number", true);
  const std::string unit = session_.seen().camera.length_unit, given = length_unit_->currentText().toStdString();
  const double length = unit == given ? value : app::in_metres(value, given) / (app::is_length_unit(unit) ? app::in_metres(1, unit) : 1);
  const auto ends = *scale_ends_;
  scale_ends_.reset();
  scale_row_->hide();
  attempt([&] { session_.set_scale(ends.first, ends.second, length); });
  view_->setFocus();
}

void SetupPage::tell_cursor(const QPointF& px) {
  if (!cursor_words) return;
  const int column = int(std::lround(px.x())), row = int(std::lround(px.y()));
  if (!image_ || column < 0 || row < 0 || column >= image_->width() || row >= image_->height()) return cursor_words({});
  const Vec2 x = session_.camera().to_world({px.x(), px.y()});
  const std::string& unit = session_.camera().length_unit();
  const plot::DisplayUnit shown = plot::display_unit(unit, std::max(std::abs(x.x()), std::abs(x.y())));
  cursor_words(QString("column %1, row %2     x %3, y %4 %5     grey %6")
                   .arg(px.x(), 0, 'f', 1).arg(px.y(), 0, 'f', 1)
                   .arg(of_number(x.x() * shown.factor), of_number(x.y() * shown.factor), plot::qt(shown.name),
                        plot::qt(plot::plain(grey_at(image_->view(), column, row)))));
}

void SetupPage::shape_menu(int shape, const QPoint& at) {
  QMenu menu(this);
  const Shape& chosen = session_.shapes()[std::size_t(shape)];
  QAction* rename = chosen.key.size() == 3 ? menu.addAction("Rename ...") : nullptr;
  std::vector<std::pair<QAction*, ShapeKind>> copies;
  if (chosen.closed)
    for (const auto& kind : shape_kind_names) copies.emplace_back(menu.addAction("Copy as " + plot::qt(std::string(kind.name)).toLower()), kind.value);
  QAction* remove = menu.addAction("Remove");
  QAction* picked = menu.exec(at);
  if (picked == nullptr) return;
  if (picked == remove) return attempt([&] { session_.remove_shape(std::size_t(shape)); });
  if (picked == rename) {
    bool good = false;
    const QString name = QInputDialog::getText(this, "Rename", "Name", QLineEdit::Normal, plot::qt(chosen.name()), &good);
    if (good) attempt([&] { session_.rename_shape(std::size_t(shape), name.toStdString()); });
    return;
  }
  for (const auto& [action, kind] : copies)
    if (picked == action) attempt([&] { session_.copy_shape(std::size_t(shape), kind); });
}

}  // namespace pivnp::view

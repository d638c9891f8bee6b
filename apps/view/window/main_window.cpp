#include "apps/view/window/main_window.hpp"

#include <QApplication>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileDialog>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QPainter>
#include <QSettings>
#include <QShortcut>
#include <QStatusBar>
#include <QStyle>
#include <QStyleFactory>
#include <QSvgGenerator>
#include <QTabWidget>

#include "apps/plot/files.hpp"
#include "apps/plot/qt.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::view {

namespace fs = std::filesystem;

namespace {

constexpr int most_recent = 10;

QString file_text(const fs::path& file) { return QString::fromStdString(file.string()); }

}  // namespace

void use_theme(bool dark) {
  QApplication::setStyle(QStyleFactory::create("Fusion"));
  QPalette p;
  const auto set = [&](QPalette::ColorRole role, const QColor& colour) { p.setColor(role, colour); };
  const QColor window = dark ? QColor(0x2a, 0x2c, 0x30) : QColor(0xf2, 0xf2, 0xf0), base = dark ? QColor(0x1e, 0x20, 0x23) : QColor(Qt::white);
  const QColor text = dark ? QColor(0xe4, 0xe4, 0xe2) : QColor(0x1c, 0x1c, 0x1c), faint = dark ? QColor(0x86, 0x88, 0x8c) : QColor(0x8c, 0x8c, 0x8c);
  set(QPalette::Window, window);
  set(QPalette::Base, base);
  set(QPalette::AlternateBase, dark ? QColor(0x34, 0x37, 0x3c) : QColor(0xe6, 0xe8, 0xea));
  set(QPalette::Button, dark ? QColor(0x36, 0x39, 0x3e) : QColor(0xea, 0xea, 0xe8));
  set(QPalette::Dark, dark ? QColor(0x17, 0x18, 0x1a) : QColor(0xc2, 0xc5, 0xc9));
  set(QPalette::Mid, dark ? QColor(0x3c, 0x3f, 0x44) : QColor(0xb8, 0xb8, 0xb8));
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText}) set(role, text);
  set(QPalette::ToolTipBase, dark ? QColor(0x3a, 0x3d, 0x42) : QColor(0xff, 0xff, 0xe8));
  set(QPalette::PlaceholderText, faint);
  set(QPalette::Highlight, dark ? QColor(0x3d, 0x7e, 0xb8) : QColor(0x2f, 0x78, 0xb8));
  set(QPalette::HighlightedText, Qt::white);
  set(QPalette::Link, dark ? QColor(0x7a, 0xb8, 0xf0) : QColor(0x0b, 0x5c, 0xa8));
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText}) p.setColor(QPalette::Disabled, role, faint);
  QApplication::setPalette(p);
}

MainWindow::MainWindow(bool remember) : remember_(remember) {
  setWindowTitle("pivnp");
  setAcceptDrops(true);
  tabs_ = new QTabWidget;
  tabs_->setDocumentMode(true);
  setup_ = new SetupPage;
  look_ = new LookPage;
  tabs_->addTab(setup_, "Set up");
  tabs_->addTab(look_, "Look at a record");
  tabs_->setTabEnabled(1, false);
  setCentralWidget(tabs_);
  run_ = new RunPanel;
  dock_ = new QDockWidget("Run");
  dock_->setObjectName("run_dock");
  dock_->setWidget(run_);
  addDockWidget(Qt::BottomDockWidgetArea, dock_);
  dock_->hide();
  cursor_ = new QLabel;
  busy_ = new QLabel;
  statusBar()->addWidget(cursor_, 1);
  statusBar()->addPermanentWidget(busy_);
  build_menus();
  const auto words = [this](const QString& text) { cursor_->setText(text); };
  setup_->cursor_words = words;
  look_->cursor_words = words;
  setup_->changed = [this] { refresh(); };
  look_->opened = [this] {
    busy_->clear();
    tabs_->setTabEnabled(1, true);
    show_look();
    refresh();
  };
  run_->before = [this] { return save(false); };
  run_->finished = [this](const fs::path& record, bool good) {
    if (good && fs::exists(record)) look_->open(record);
  };
  connect(tabs_, &QTabWidget::currentChanged, this, [this](int) { refresh(); });
  resize(1280, 800);
  bool dark = false;
  if (remember_) {
    const QSettings settings;
    restoreGeometry(settings.value("geometry").toByteArray());
    dark = settings.value("dark", QApplication::palette().color(QPalette::Window).lightness() < 128).toBool();
  }
  set_dark(dark);
  refresh();
}

void MainWindow::build_menus() {
  QMenu* file = menuBar()->addMenu("&File");
  file->addAction("&Open a video, case or record ...", QKeySequence::Open, this, [this] {
    const QString chosen = QFileDialog::getOpenFileName(this, "Open", file_text(opened_.parent_path()),
                                                        "Videos, images, cases, records (*.mp4 *.avi *.mov *.mkv *.png *.jpg *.jpeg *.tif *.tiff *.bmp *.pgm *.toml *.h5);;All files (*)");
    if (!chosen.isEmpty()) open(chosen.toStdString());
  });
  file->addAction("Open a &folder of frames ...", QKeySequence("Ctrl+Shift+O"), this, [this] {
    const QString chosen = QFileDialog::getExistingDirectory(this, "Open a folder", file_text(opened_));
    if (!chosen.isEmpty()) open(chosen.toStdString());
  });
  recent_ = file->addMenu("Open &recent");
  fill_recent();
  file->addSeparator();
  save_ = file->addAction("&Save the case", QKeySequence::Save, this, [this] { save(false); });
  file->addAction("Save the case &as ...", QKeySequence("Ctrl+Shift+S"), this, [this] { save(true); });
  file->addSeparator();
  file->addAction("Save the &picture (PNG, SVG) ...", QKeySequence("Ctrl+P"), this, [this] {
    const QString chosen = QFileDialog::getSaveFileName(this, "Save what is seen", file_text(setup_->session().folder() / "view.png"), "PNG (*.png);;SVG (*.svg)");
    if (!chosen.isEmpty()) tell(save_picture(chosen.toStdString()));
  });
  values_ = file->addAction("Save the &values (CSV) ...", QKeySequence("Ctrl+E"), this, [this] {
    const QString chosen = QFileDialog::getSaveFileName(this, "Save the values", file_text(setup_->session().folder() / "values.csv"), "CSV (*.csv)");
    if (!chosen.isEmpty()) save_values(chosen.toStdString());
  });
  file->addSeparator();
  file->addAction("&Quit", QKeySequence("Ctrl+Q"), this, [this] { close(); });

  QMenu* edit = menuBar()->addMenu("&Edit");
  undo_ = edit->addAction("&Undo", QKeySequence::Undo, this, [this] { setup_->undo(); });
  redo_ = edit->addAction("&Redo", QKeySequence("Ctrl+Shift+Z"), this, [this] { setup_->redo(); });
  edit->addSeparator();
  QAction* remove = edit->addAction("Remove the outline", QKeySequence(Qt::Key_Delete), &setup_->view(), [this] { setup_->remove_selected(); });
  remove->setShortcutContext(Qt::WidgetShortcut);
  setup_->view().addAction(remove);
  edit->addSeparator();
  for (const auto& [words, key, tool] : {std::tuple{"Select", Qt::Key_V, Tool::select}, std::tuple{"Draw a region", Qt::Key_R, Tool::region},
                                         std::tuple{"Draw a mask", Qt::Key_M, Tool::mask}, std::tuple{"Draw a wall", Qt::Key_W, Tool::wall},
                                         std::tuple{"Draw the still zone", Qt::Key_Z, Tool::still_zone}, std::tuple{"Set the scale", Qt::Key_S, Tool::scale},
                                         std::tuple{"Set the origin", Qt::Key_O, Tool::origin}, std::tuple{"Set the level", Qt::Key_H, Tool::horizontal}}) {
    QAction* action = edit->addAction(words, QKeySequence(key), this, [this, t = tool] {
      if (setup_->session().frames()) setup_->set_tool(t);
    });
    action->setShortcutContext(Qt::WidgetShortcut);  // letters are typed elsewhere
    setup_->view().addAction(action);
  }

  QMenu* view = menuBar()->addMenu("&View");
  view->addAction("&Fit", QKeySequence("Ctrl+0"), this, [this] { looking() ? look_->fit() : setup_->view().fit(); });
  for (QWidget* w : {static_cast<QWidget*>(&setup_->view()), static_cast<QWidget*>(&look_->pane(0)), static_cast<QWidget*>(&look_->pane(1))})
    for (const auto& [key, step] : {std::pair{Qt::Key_Left, -1}, std::pair{Qt::Key_Right, 1}, std::pair{Qt::Key_PageUp, -10}, std::pair{Qt::Key_PageDown, 10},
                                    std::pair{Qt::Key_Home, -1000000}, std::pair{Qt::Key_End, 1000000}, std::pair{Qt::Key_Space, 0}}) {
      auto* shortcut = new QShortcut(QKeySequence(key), w, nullptr, nullptr, Qt::WidgetShortcut);
      connect(shortcut, &QShortcut::activated, this, [this, by = step] { by == 0 ? bar().toggle_play() : bar().step(by); });
    }
  theme_ = view->addAction("&Dark", this, [this] { set_dark(theme_->isChecked()); });
  theme_->setCheckable(true);
  view->addAction(dock_->toggleViewAction());

  QMenu* run = menuBar()->addMenu("&Run");
  run->addAction("&Run the case", QKeySequence("Ctrl+R"), this, [this] {
    dock_->show();
    run_->start(false);
  });
  run->addAction("Re&sume a run", this, [this] {
    dock_->show();
    run_->start(true);
  });
}

bool MainWindow::looking() const { return tabs_->currentWidget() == look_; }
TimeBar& MainWindow::bar() { return looking() ? look_->time() : setup_->time(); }

void MainWindow::set_dark(bool dark) {
  dark_ = dark;
  theme_->setChecked(dark);
  use_theme(dark);
}

void MainWindow::tell(const QString& words) {
  if (!words.isEmpty()) QMessageBox::warning(this, "pivnp", words);
}

bool MainWindow::idle() { return opening_ == 0 && worker_.idle() && setup_->idle() && look_->idle(); }

void MainWindow::refresh() {
  const Session& session = setup_->session();
  const std::string name = looking() && look_->has_record() ? look_->file().string()
                           : session.empty()                ? std::string()
                           : session.file().empty()         ? std::string("a case that is not saved yet")
                                                            : session.file().string();
  setWindowTitle(name.empty() ? QString("pivnp") : plot::qt(name) + (session.modified() && !looking() ? " *" : "") + " — pivnp");
  undo_->setEnabled(session.can_undo());
  redo_->setEnabled(session.can_redo());
  save_->setEnabled(!session.empty());
  values_->setEnabled(true);
  run_->set_case(session.file());
}

void MainWindow::show_look() { tabs_->setCurrentWidget(look_); }

void MainWindow::open(const fs::path& path) {
  const int number = ++number_;
  busy_->setText("opening " + plot::qt(path.filename().string()) + " ...");
  ++opening_;
  worker_.post(0, [this, path, number](const Worker::Stop&) {
    auto opened = std::make_shared<Opened>();
    QString fault;
    try {
      *opened = open_path(path);
    } catch (const std::exception& error) {
      fault = plot::qt(error.what());
    }
    Worker::tell(this, [this, opened, fault, path, number] {
      --opening_;
      if (number != number_) return;
      busy_->clear();
      if (!fault.isEmpty()) return tell(fault);
      if (opened->record.empty()) {
        if (!may_leave()) return;
        setup_->take(std::move(*opened));
        tabs_->setCurrentWidget(setup_);
        setup_->view().setFocus();
      } else {
        look_->open(opened->record);
      }
      opened_ = path;
      remember_file(path);
      refresh();
    });
  });
}

bool MainWindow::save_to(const fs::path& file) {
  try {
    setup_->save(file);
  } catch (const std::exception& error) {
    tell(plot::qt(error.what()));
    return false;
  }
  remember_file(file);
  refresh();
  return true;
}

bool MainWindow::save(bool as) {
  const Session& session = setup_->session();
  if (session.empty()) return false;
  fs::path file = session.file();
  if (as || file.empty()) {
    const QString chosen = QFileDialog::getSaveFileName(this, "Save the case", file_text(session.folder() / "case.toml"), "Cases (*.toml)");
    if (chosen.isEmpty()) return false;
    file = chosen.toStdString();
  }
  return save_to(file);
}

bool MainWindow::may_leave() {
  const Session& session = setup_->session();
  if (!session.modified() || !session.can_undo() || !remember_) return true;  // what was only opened is not lost
  const auto answer = QMessageBox::question(this, "pivnp", "Save the changes to the case?", QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel);
  return answer == QMessageBox::Discard || (answer == QMessageBox::Save && save(false));
}

QString MainWindow::save_picture(const fs::path& file) {
  QWidget& shown = looking() ? look_->panes() : static_cast<QWidget&>(setup_->view());
  if (file.extension() == ".svg") {
    QSvgGenerator svg;
    svg.setFileName(file_text(file));
    svg.setSize(shown.size());
    svg.setViewBox(shown.rect());
    svg.setTitle("pivnp");
    QPainter painter;
    if (!painter.begin(&svg)) return plot::qt(file.string() + ": cannot be written");
    shown.render(&painter);
    return painter.end() ? QString() : plot::qt(file.string() + ": cannot be written");
  }
  constexpr int finer = 2;
  QImage image(shown.size() * finer, QImage::Format_RGB32);
  image.setDevicePixelRatio(finer);
  image.fill(shown.palette().color(QPalette::Window));
  shown.render(&image);
  return image.save(file_text(file), "PNG") ? QString() : plot::qt(file.string() + ": cannot be written");
}

void MainWindow::save_values(const fs::path& file) {
  if (looking()) return look_->write_csv(file, [this](const QString& words) { tell(words); });
  if (!setup_->pair()) return tell("There are no vectors to write: tick \"Vectors of the pair shown\".");
  try {
    plot::write_file(file, csv_of(*setup_->pair()));
  } catch (const std::exception& error) {
    tell(plot::qt(error.what()));
  }
}

void MainWindow::remember_file(const fs::path& file) {
  if (!remember_) return;
  QSettings settings;
  QStringList files = settings.value("recent").toStringList();
  const QString name = file_text(fs::absolute(file).lexically_normal());
  files.removeAll(name);
  files.prepend(name);
  settings.setValue("recent", files.mid(0, most_recent));
  fill_recent();
}

void MainWindow::fill_recent() {
  recent_->clear();
  const QStringList files = remember_ ? QSettings().value("recent").toStringList() : QStringList();
  for (const QString& name : files) recent_->addAction(name, this, [this, name] { open(name.toStdString()); });
  recent_->setEnabled(!files.isEmpty());
}

void MainWindow::closeEvent(QCloseEvent* event) {
  if (!may_leave()) return event->ignore();
  if (remember_) {
    QSettings settings;
    settings.setValue("geometry", saveGeometry());
    settings.setValue("dark", dark_);
  }
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  for (const QUrl& url : event->mimeData()->urls())
    if (url.isLocalFile()) return open(url.toLocalFile().toStdString());
}

}  // namespace pivnp::view

// The window: opens, saves, runs, and shows one page for setting up and one for looking at a record.
#pragma once

#include <filesystem>

#include <QMainWindow>

#include "apps/view/window/look_page.hpp"
#include "apps/view/window/run_panel.hpp"
#include "apps/view/window/setup_page.hpp"

class QAction;
class QDockWidget;
class QLabel;
class QMenu;
class QTabWidget;

namespace pivnp::view {

/// Colours of the whole program.
void use_theme(bool dark);

class MainWindow : public QMainWindow {
 public:
  /// `remember`: place of the window, theme and recent files, by the user's settings.
  explicit MainWindow(bool remember);

  void open(const std::filesystem::path& path);
  SetupPage& setup() { return *setup_; }
  LookPage& look() { return *look_; }
  RunPanel& run() { return *run_; }
  void show_look();
  /// Of the case; false: refused or given up.
  bool save_to(const std::filesystem::path& file);
  /// What is seen, by the file's ending .png or .svg. Returns why not; empty: written.
  QString save_picture(const std::filesystem::path& file);
  void save_values(const std::filesystem::path& file);
  void set_dark(bool dark);
  bool idle();

 protected:
  void closeEvent(QCloseEvent*) override;
  void dragEnterEvent(QDragEnterEvent*) override;
  void dropEvent(QDropEvent*) override;

 private:
  void build_menus();
  void refresh();
  bool save(bool as);
  bool may_leave();
  void remember_file(const std::filesystem::path& file);
  void fill_recent();
  void tell(const QString& words);
  TimeBar& bar();
  bool looking() const;

  bool remember_, dark_ = false;
  QTabWidget* tabs_;
  SetupPage* setup_;
  LookPage* look_;
  RunPanel* run_;
  QDockWidget* dock_;
  QMenu* recent_;
  QLabel *cursor_, *busy_;
  QAction *undo_, *redo_, *save_, *theme_, *values_;
  std::filesystem::path opened_;
  int number_ = 0, opening_ = 0;
  Worker worker_;
};

}  // namespace pivnp::view

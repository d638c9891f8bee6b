// Setting a case up: frames with outlines, scale and the live pair; controls and the text beside them.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <QTimer>
#include <QWidget>

#include "apps/view/model/session.hpp"
#include "apps/view/window/frame_view.hpp"
#include "apps/view/window/time_bar.hpp"
#include "apps/view/window/toml_editor.hpp"
#include "apps/view/window/worker.hpp"

class QButtonGroup;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QLineEdit;
class QListWidget;
class QSpinBox;

namespace pivnp::view {

class SetupPage : public QWidget {
 public:
  explicit SetupPage(QWidget* parent = nullptr);
  ~SetupPage() override;

  void take(Opened opened);
  Session& session() { return session_; }
  FrameView& view() { return *view_; }
  TimeBar& time() { return *time_; }
  TomlEditor& editor() { return *editor_; }
  void set_tool(Tool tool);
  void undo();
  void redo();
  void remove_selected();
  /// Throws as Session::save does.
  void save(const std::filesystem::path& file);
  const std::optional<LivePair>& pair() const { return pair_; }
  /// Nothing is being read or measured.
  bool idle();

  std::function<void()> changed;                // the text
  std::function<void(QString)> cursor_words;    // for the status bar

 private:
  void build_left(QWidget* left);
  void build_right(QWidget* right);
  void connect_view();
  /// Does a change of the session, or says why not.
  template <class F>
  void attempt(F&& change);
  void refresh();
  void refresh_controls();
  void refresh_shapes();
  void say(const QString& words, bool fault);
  void request_frame();
  void request_pair();
  void reopen_frames();
  void apply_scale();
  void tell_cursor(const QPointF& px);
  void shape_menu(int shape, const QPoint& at);

  Session session_;
  FrameView* view_;
  TimeBar* time_;
  TomlEditor* editor_;
  QButtonGroup* tools_;
  QLabel *message_, *picture_words_, *scale_words_, *pair_words_, *spacing_label_;
  QWidget* scale_row_;
  QLineEdit *length_, *rate_;
  QComboBox *length_unit_, *method_, *colour_;
  QSpinBox* window_;
  QDoubleSpinBox* spacing_;
  QCheckBox* live_;
  QListWidget *shapes_, *faults_;
  QTimer pair_soon_, frames_soon_;
  std::optional<std::pair<Vec2, Vec2>> scale_ends_;
  std::shared_ptr<const Image> image_;
  std::optional<LivePair> pair_;
  bool refreshing_ = false;
  int opened_ = 0;  // counts what was opened: answers of before are dropped
  Worker reading_, measuring_;  // last: they end first
};

}  // namespace pivnp::view

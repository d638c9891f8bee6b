// Looking at a record: particles coloured by a field over its frames, side by side, and the history of a point.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include <QImage>
#include <QTimer>
#include <QWidget>

#include "apps/view/model/record_look.hpp"
#include "apps/view/window/time_bar.hpp"
#include "apps/view/window/worker.hpp"
#include "apps/view/window/zoom_view.hpp"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QCustomPlot;
class QDoubleSpinBox;
class QLabel;
class QLineEdit;

namespace pivnp::view {

/// Particles, frame and vectors in the world, y up: scene (x, -y).
class RecordPane : public ZoomView {
 public:
  explicit RecordPane(QWidget* parent = nullptr) : ZoomView(parent) {}
  void paint(QPainter& painter) override;

  QString title, unit;
  QImage picture;      // over `box`
  plot::Box box;
  std::optional<VectorField> vectors;
  std::optional<Vec2> mark;
  std::function<void(Vec2)> clicked;

 protected:
  void mousePressEvent(QMouseEvent*) override;
  void mouseReleaseEvent(QMouseEvent*) override;

 private:
  QPointF pressed_;
};

class ColourBar : public QWidget {
 public:
  explicit ColourBar(QWidget* parent = nullptr);
  void show_scale(const plot::Scale& scale, const QString& label, const std::string& unit);

 protected:
  void paintEvent(QPaintEvent*) override;

 private:
  plot::Scale scale_;
  QString label_;
  std::string unit_;
  bool known_ = false;
};

class LookPage : public QWidget {
 public:
  explicit LookPage(QWidget* parent = nullptr);
  ~LookPage() override;

  void open(const std::filesystem::path& record);
  const std::filesystem::path& file() const { return file_; }
  bool has_record() const { return look_ != nullptr; }
  TimeBar& time() { return *time_; }
  RecordPane& pane(int side) { return side == 0 ? *left_ : *right_; }
  QWidget& panes() { return *panes_; }
  const QString& words() const { return said_; }
  void fit();
  /// Values of what is shown at the left, as CSV; handed over once written, or why not.
  void write_csv(const std::filesystem::path& file, const std::function<void(QString)>& done);
  bool idle();

  std::function<void(QString)> cursor_words;
  std::function<void()> opened;

 protected:
  void changeEvent(QEvent*) override;

 private:
  // What the thread that reads holds of the pictures shown last.
  struct Shown {
    std::string key;
    ParticlePicture left, right;
    bool has_right = false;
    std::shared_ptr<const Image> frame;
    std::optional<VectorField> vectors;
  };
  void build_right(QWidget* right);
  void retire(std::shared_ptr<RecordLook> look);  // records are closed by the thread that reads them
  void fill_choices();
  void request();
  void ask_history(int side, const Vec2& place);
  void show_history();
  void tell_cursor(int side, const QPointF& scene);
  void say(const QString& words);
  const ShownField* field() const;

  std::filesystem::path file_;
  std::shared_ptr<RecordLook> look_;  // read by the worker alone; what is fixed from the start by all
  QWidget* panes_;
  QBoxLayout* pair_;
  RecordPane *left_, *right_;
  ColourBar* bar_;
  TimeBar* time_;
  QLabel *message_, *point_;
  QComboBox *left_motion_, *right_motion_, *field_;
  QCheckBox *frames_, *particles_, *arrows_, *by_hand_;
  QDoubleSpinBox* percentile_;
  QLineEdit *lower_, *upper_;
  QCustomPlot* plot_;
  std::optional<History> history_;
  std::shared_ptr<Shown> worker_shown_;  // of the worker
  ParticlePicture at_left_, at_right_;
  QString said_;
  int number_ = 0, retired_ = 0;
  Worker reading_;
};

}  // namespace pivnp::view

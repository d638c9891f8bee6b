// A run of the case as a program of its own: `pivnp run`, its lines, cancel and resume.
#pragma once

#include <filesystem>
#include <functional>

#include <QProcess>
#include <QWidget>

class QLabel;
class QPlainTextEdit;
class QProgressBar;
class QPushButton;

namespace pivnp::view {

/// The command-line program: beside this one, else on the path; empty: not found.
QString command_line_program();

class RunPanel : public QWidget {
 public:
  explicit RunPanel(QWidget* parent = nullptr);
  ~RunPanel() override;

  /// What to run; an empty path: nothing can be run.
  void set_case(const std::filesystem::path& file);
  void start(bool resume);
  void cancel();
  bool running() const { return process_.state() != QProcess::NotRunning; }
  std::filesystem::path out() const;

  std::function<bool()> before;                               // saves; false: not to be run
  std::function<void(std::filesystem::path, bool)> finished;  // the record, and whether all went well

 private:
  void read_lines();
  void ended(int code);
  void refresh();

  std::filesystem::path file_;
  QProcess process_;
  QByteArray rest_;
  QLabel* stage_;
  QProgressBar* bar_;
  QPlainTextEdit* log_;
  QPushButton *run_, *resume_, *cancel_, *report_;
};

}  // namespace pivnp::view

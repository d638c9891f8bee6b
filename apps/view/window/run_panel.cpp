#include "apps/view/window/run_panel.hpp"

#include <csignal>

#include <QCoreApplication>
#include <QDesktopServices>
#include <QDir>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QRegularExpression>
#include <QStandardPaths>
#include <QUrl>
#include <QVBoxLayout>

namespace pivnp::view {

QString command_line_program() {
  const QString beside = QDir(QCoreApplication::applicationDirPath()).filePath("pivnp");
  return QFileInfo(beside).isExecutable() ? beside : QStandardPaths::findExecutable("pivnp");
}

RunPanel::RunPanel(QWidget* parent) : QWidget(parent) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(8, 4, 8, 6);
  auto* row = new QHBoxLayout;
  run_ = new QPushButton("Run");
  resume_ = new QPushButton("Resume");
  cancel_ = new QPushButton("Cancel");
  report_ = new QPushButton("Open report");
  run_->setObjectName("run");
  resume_->setToolTip("Goes on from what a run that was stopped has left");
  bar_ = new QProgressBar;
  stage_ = new QLabel;
  stage_->setMinimumWidth(220);
  for (QWidget* w : {static_cast<QWidget*>(run_), static_cast<QWidget*>(resume_), static_cast<QWidget*>(cancel_), static_cast<QWidget*>(report_)}) row->addWidget(w);
  row->addWidget(bar_, 1);
  row->addWidget(stage_);
  column->addLayout(row);
  log_ = new QPlainTextEdit;
  log_->setObjectName("log");
  log_->setReadOnly(true);
  log_->setMaximumBlockCount(2000);
  column->addWidget(log_);
  connect(run_, &QPushButton::clicked, this, [this] { start(false); });
  connect(resume_, &QPushButton::clicked, this, [this] { start(true); });
  connect(cancel_, &QPushButton::clicked, this, [this] { cancel(); });
  connect(report_, &QPushButton::clicked, this, [this] { QDesktopServices::openUrl(QUrl::fromLocalFile(QString::fromStdString((out() / "report.html").string()))); });
  process_.setProcessChannelMode(QProcess::MergedChannels);
  connect(&process_, &QProcess::readyReadStandardOutput, this, [this] { read_lines(); });
  connect(&process_, &QProcess::finished, this, [this](int code, QProcess::ExitStatus status) { ended(status == QProcess::NormalExit ? code : -1); });
  connect(&process_, &QProcess::errorOccurred, this, [this](QProcess::ProcessError error) {
    if (error == QProcess::FailedToStart) ended(-1);
  });
  refresh();
}

RunPanel::~RunPanel() {
  process_.disconnect();
  if (!running()) return;
  cancel();
  if (!process_.waitForFinished(5000)) process_.kill();
  process_.waitForFinished(1000);
}

std::filesystem::path RunPanel::out() const {
  return file_.parent_path() / "out" / (file_.filename() == "case.toml" ? std::filesystem::absolute(file_).parent_path().filename() : file_.stem());
}

void RunPanel::set_case(const std::filesystem::path& file) {
  file_ = file;
  refresh();
}

void RunPanel::refresh() {
  const bool known = !file_.empty();
  std::error_code ignored;
  run_->setEnabled(!running());
  resume_->setEnabled(!running() && known && std::filesystem::exists(out() / "parts", ignored));
  cancel_->setEnabled(running());
  report_->setEnabled(!running() && known && std::filesystem::exists(out() / "report.html", ignored));
  bar_->setVisible(running());
}

void RunPanel::start(bool resume) {
  if (running() || (before && !before()) || file_.empty()) return;
  const QString program = command_line_program();
  if (program.isEmpty()) {
    stage_->setText("the program pivnp was not found");
    return;
  }
  std::error_code ignored;
  if (!resume && std::filesystem::exists(out() / "record.h5", ignored) &&
      QMessageBox::question(this, "Run", "There is a record of an earlier run in " + QString::fromStdString(out().string()) + ". Replace it?") != QMessageBox::Yes)
    return;
  const QStringList words{"run", QString::fromStdString(file_.string()), "--out", QString::fromStdString(out().string()), resume ? "--resume" : "--force"};
  log_->clear();
  log_->appendPlainText("pivnp " + words.join(' '));
  rest_.clear();
  bar_->setRange(0, 0);
  stage_->setText("starting");
  process_.start(program, words);
  refresh();
}

void RunPanel::cancel() {
  if (process_.processId() > 0) ::kill(pid_t(process_.processId()), SIGINT);  // as Ctrl-C: what is closed stays intact
}

void RunPanel::read_lines() {
  rest_ += process_.readAllStandardOutput();
  static const QRegularExpression progress("^(.+) (\\d+)/(\\d+)(?:, (.*))?$");
  for (qsizetype end; (end = rest_.indexOf('\n')) >= 0; rest_.remove(0, end + 1)) {
    const QString line = QString::fromUtf8(rest_.left(end));
    log_->appendPlainText(line);
    const QRegularExpressionMatch match = progress.match(line);
    if (!match.hasMatch()) continue;
    bar_->setRange(0, match.captured(3).toInt());
    bar_->setValue(match.captured(2).toInt());
    stage_->setText(match.captured(1) + (match.captured(4).isEmpty() ? QString() : ": " + match.captured(4)));
  }
}

void RunPanel::ended(int code) {
  read_lines();
  const bool good = code == 0 || code == 3;
  stage_->setText(code == 0 ? "done" : code == 3 ? "done; a limit is exceeded" : code == 130 ? "stopped; Resume goes on from there" : "failed: see the last line");
  refresh();
  const std::filesystem::path record = out() / "record.h5";
  if (good && std::filesystem::exists(out() / "report.html") && QCoreApplication::instance()->property("open_reports").toBool())
    QDesktopServices::openUrl(QUrl::fromLocalFile(QString::fromStdString((out() / "report.html").string())));
  if (finished) finished(record, good);
}

}  // namespace pivnp::view

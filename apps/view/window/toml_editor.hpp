// The case's text, coloured, with its faults underlined.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <QPlainTextEdit>

#include "apps/view/model/session.hpp"

class QSyntaxHighlighter;

namespace pivnp::view {

class TomlEditor : public QPlainTextEdit {
 public:
  explicit TomlEditor(QWidget* parent = nullptr);

  /// Puts in what differs, so that cursor and place stay.
  void show_text(const std::string& text);
  void show_faults(const std::vector<Fault>& faults);
  void go_to(int line);

  std::function<void(std::string)> typed;

 protected:
  bool event(QEvent* event) override;  // undo and redo are the window's
  void changeEvent(QEvent* event) override;

 private:
  QSyntaxHighlighter* colours_;
  bool showing_ = false;
};

}  // namespace pivnp::view

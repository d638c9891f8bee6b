#include "apps/view/window/toml_editor.hpp"

#include <algorithm>

#include <QFontDatabase>
#include <QKeyEvent>
#include <QRegularExpression>
#include <QSyntaxHighlighter>
#include <QTextBlock>

namespace pivnp::view {

namespace {

class TomlColours : public QSyntaxHighlighter {
 public:
  explicit TomlColours(QPlainTextEdit* editor) : QSyntaxHighlighter(editor->document()), editor_(editor) {}

 protected:
  void highlightBlock(const QString& line) override {
    const bool dark = editor_->palette().color(QPalette::Base).lightness() < 128;
    const auto paint = [&](const char* pattern, const QColor& colour, bool bold = false) {
      QTextCharFormat format;
      format.setForeground(colour);
      if (bold) format.setFontWeight(QFont::Bold);
      for (auto it = QRegularExpression(pattern).globalMatch(line); it.hasNext();) {
        const QRegularExpressionMatch match = it.next();
        setFormat(int(match.capturedStart()), int(match.capturedLength()), format);
      }
    };
    paint("^\\s*[\\w.\"-]+(?=\\s*=)", dark ? QColor(0x8c, 0xc8, 0xff) : QColor(0x0b, 0x4f, 0x9c));
    paint("^\\s*\\[[^\\]]*\\]", dark ? QColor(0xff, 0xc0, 0x70) : QColor(0x9a, 0x4a, 0x00), true);
    paint("(?<==)\\s*\"[^\"]*\"", dark ? QColor(0x9c, 0xe0, 0x9c) : QColor(0x1a, 0x6e, 0x2a));
    paint("#(?=([^\"]*\"[^\"]*\")*[^\"]*$).*$", dark ? QColor(0x98, 0x98, 0x98) : QColor(0x75, 0x75, 0x75));
  }

 private:
  QPlainTextEdit* editor_;
};

}  // namespace

TomlEditor::TomlEditor(QWidget* parent) : QPlainTextEdit(parent) {
  setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
  setLineWrapMode(QPlainTextEdit::NoWrap);
  setUndoRedoEnabled(false);
  setTabChangesFocus(true);
  setPlaceholderText("The case as TOML");
  colours_ = new TomlColours(this);
  connect(this, &QPlainTextEdit::textChanged, this, [this] {
    if (!showing_ && typed) typed(toPlainText().toStdString());
  });
}

void TomlEditor::show_text(const std::string& text) {
  const QString now = QString::fromStdString(text), before = toPlainText();
  if (now == before) return;
  qsizetype head = 0, tail = 0;
  const qsizetype most = std::min(now.size(), before.size());
  while (head < most && now[head] == before[head]) ++head;
  while (tail < most - head && now[now.size() - 1 - tail] == before[before.size() - 1 - tail]) ++tail;
  showing_ = true;
  QTextCursor cursor(document());
  cursor.setPosition(int(head));
  cursor.setPosition(int(before.size() - tail), QTextCursor::KeepAnchor);
  cursor.insertText(now.mid(head, now.size() - tail - head));
  showing_ = false;
  if (before.isEmpty()) return moveCursor(QTextCursor::Start);
  if (hasFocus()) return;
  cursor.movePosition(QTextCursor::StartOfLine);  // what changed is seen
  setTextCursor(cursor);
  ensureCursorVisible();
}

void TomlEditor::show_faults(const std::vector<Fault>& faults) {
  QList<QTextEdit::ExtraSelection> marks;
  for (const Fault& fault : faults) {
    if (fault.line < 1) continue;
    QTextEdit::ExtraSelection mark;
    mark.cursor = QTextCursor(document()->findBlockByNumber(fault.line - 1));
    mark.format.setBackground(QColor(0xe0, 0x40, 0x40, 60));
    mark.format.setProperty(QTextFormat::FullWidthSelection, true);
    marks << mark;
  }
  setExtraSelections(marks);
}

void TomlEditor::go_to(int line) {
  if (line < 1) return;
  setTextCursor(QTextCursor(document()->findBlockByNumber(line - 1)));
  centerCursor();
  setFocus();
}

void TomlEditor::changeEvent(QEvent* event) {
  QPlainTextEdit::changeEvent(event);
  if (event->type() != QEvent::PaletteChange) return;
  showing_ = true;
  colours_->rehighlight();
  showing_ = false;
}

bool TomlEditor::event(QEvent* event) {
  if (event->type() == QEvent::ShortcutOverride) {
    auto* key = static_cast<QKeyEvent*>(event);
    if (key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo)) {
      event->ignore();
      return false;
    }
  }
  return QPlainTextEdit::event(event);
}

}  // namespace pivnp::view

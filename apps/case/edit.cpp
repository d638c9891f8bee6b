#include "apps/case/edit.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cstddef>

#include "apps/case/document.hpp"
#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

std::string dotted(const KeyPath& key) {
  std::string all;
  for (const std::string& part : key) all += (all.empty() ? "" : ".") + toml_key(part);
  return all;
}

class Editor {
 public:
  Editor(const std::string& text, const std::string& name) : text_(text), name_(name) {
    parse_document(text, name);  // throws with the words of the reader
    root_ = toml::parse(text);
    for (std::size_t at = 0; at != std::string::npos; at = text.find('\n', at), at += at != std::string::npos)
      lines_.push_back(at);
  }

  const toml::node* find(const KeyPath& key, std::size_t parts) const {
    const toml::node* node = &root_;
    for (std::size_t k = 0; k < parts && node; ++k) {
      const toml::table* table = node->as_table();
      if (!table)
        throw InputError(name_ + ":" + std::to_string(node->source().begin.line) + ": " +
                         dotted({key.begin(), key.begin() + std::ptrdiff_t(k)}) + ": found a value, expected a section");
      node = table->get(key[k]);
    }
    return node;
  }

  // Columns count characters, and the text has bytes.
  std::size_t offset(const toml::source_position& p) const {
    std::size_t at = lines_.at(p.line - 1);
    for (std::size_t column = 1; column < p.column && at < text_.size(); ++column) {
      ++at;
      while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xC0) == 0x80) ++at;
    }
    return at;
  }
  std::size_t start_of(std::size_t line) const { return line - 1 < lines_.size() ? lines_[line - 1] : text_.size(); }

  static bool holds_lines(const toml::node& node) {  // keys of its own below a header
    const toml::table* table = node.as_table();
    return table && !table->is_inline();
  }

  // The entry of a section that stands last, but for sections under it; nullptr: none.
  const toml::node* last_value(const toml::table& section, const toml::key*& key) const {
    const toml::node* last = nullptr;
    for (auto&& [k, value] : section)
      if (!holds_lines(value) && (!last || value.source().begin.line > last->source().begin.line)) {
        last = &value;
        key = &k;
      }
    return last;
  }

  // Line of the section's own header; 0: it has none.
  std::size_t header(const KeyPath& section) const {
    const std::string wanted = dotted(section);
    for (std::size_t line = 1; line <= lines_.size(); ++line) {
      const std::string row = text_.substr(start_of(line), start_of(line + 1) - start_of(line));
      const std::size_t open = row.find_first_not_of(" \t");
      if (open == std::string::npos || row[open] != '[' || inside_value(line)) continue;
      try {
        if (path_of(parse_document(row, name_)) == wanted) return line;
      } catch (const InputError&) {
      }
    }
    return 0;
  }

  // A line that goes on with a list or a text of several lines.
  bool inside_value(std::size_t line) const { return inside(root_, line); }

  const toml::table& root() const { return root_; }
  std::size_t line_count() const { return lines_.size(); }
  std::string row(std::size_t line) const { return text_.substr(start_of(line), start_of(line + 1) - start_of(line)); }

 private:
  static std::string path_of(const Node& node) {
    std::string all;
    for (const Node* at = &node; !at->entries.empty(); at = &at->entries.front().value)
      all += (all.empty() ? "" : ".") + toml_key(at->entries.front().key);
    return all;
  }
  static bool inside(const toml::table& table, std::size_t line) {
    for (auto&& [k, value] : table) {
      if (holds_lines(value)) {
        if (inside(*value.as_table(), line)) return true;
      } else if (line > value.source().begin.line && line <= value.source().end.line) {
        return true;
      }
    }
    return false;
  }

  const std::string& text_;
  const std::string& name_;
  toml::table root_;
  std::vector<std::size_t> lines_;
};

// What a change made must be a case's text as before.
std::string sound(std::string text, const std::string& name, const KeyPath& key) {
  try {
    parse_document(text, name);
  } catch (const InputError& error) {
    throw InputError(name + ": " + dotted(key) + ": cannot be put into this text, expected it to be edited by hand (" +
                     error.what() + ")");
  }
  return text;
}

std::string ending(const std::string& text) { return text.empty() || text.back() == '\n' ? "" : "\n"; }

}  // namespace

std::string with_key(const std::string& text, const std::string& name, const KeyPath& key, const std::string& value) {
  const Editor editor(text, name);
  const KeyPath section(key.begin(), key.end() - 1);
  std::string out = text;
  if (const toml::node* there = editor.find(key, key.size())) {
    if (there->is_table()) throw InputError(name + ": " + dotted(key) + ": found a section, expected a key");
    const std::size_t begin = editor.offset(there->source().begin), end = editor.offset(there->source().end);
    return sound(out.replace(begin, end - begin, value), name, key);
  }
  const std::string line = toml_key(key.back()) + " = " + value;
  const toml::node* found = editor.find(key, section.size());
  const toml::table* table = found ? found->as_table() : nullptr;
  if (found && !table) throw InputError(name + ": " + dotted(section) + ": found a value, expected a section");
  if (table && table->is_inline()) {
    const std::size_t brace = editor.offset(table->source().end) - 1;
    return sound(out.insert(brace, (table->empty() ? " " : ", ") + line + " "), name, key);
  }
  const toml::key* last_key = nullptr;
  if (const toml::node* last = table ? editor.last_value(*table, last_key) : nullptr) {
    const std::size_t first = editor.start_of(last_key->source().begin.line);
    const std::string before = text.substr(first, editor.offset(last_key->source().begin) - first);
    const std::size_t at = editor.start_of(last->source().end.line + 1);
    return sound(out.insert(at, (at == text.size() ? ending(text) : "") + before + line + "\n"), name, key);
  }
  if (section.empty()) return sound(line + "\n" + out, name, key);
  if (const std::size_t header = table ? editor.header(section) : 0) {
    const std::size_t at = editor.start_of(header + 1);
    return sound(out.insert(at, (at == text.size() ? ending(text) : "") + line + "\n"), name, key);
  }
  return sound(out + ending(text) + (text.empty() ? "" : "\n") + "[" + dotted(section) + "]\n" + line + "\n", name, key);
}

std::string without_key(const std::string& text, const std::string& name, const KeyPath& key) {
  const Editor editor(text, name);
  const toml::node* there = editor.find(key, key.size());
  if (!there) return text;
  std::string out = text;
  const KeyPath section(key.begin(), key.end() - 1);
  const toml::table* holder = editor.find(key, section.size())->as_table();
  if (!section.empty() && holder->is_inline())
    throw InputError(name + ": " + dotted(key) + ": stands in braces, expected it to be removed by hand");
  if (!Editor::holds_lines(*there)) {
    const std::size_t begin = editor.start_of(there->source().begin.line);
    return sound(out.erase(begin, editor.start_of(there->source().end.line + 1) - begin), name, key);
  }
  // Sections under it first, the last one first; what is left has neither header nor keys.
  KeyPath inner = key;
  for (auto&& [k, value] : *there->as_table()) {
    inner.resize(key.size());
    inner.emplace_back(k.str());
    if (Editor::holds_lines(value)) return without_key(without_key(text, name, inner), name, key);
  }
  const std::size_t header = editor.header(key);
  if (header == 0) {  // dotted keys
    if (there->as_table()->empty()) return text;
    inner.resize(key.size());
    inner.emplace_back(there->as_table()->begin()->first.str());
    return without_key(without_key(text, name, inner), name, key);
  }
  std::size_t next = header + 1;
  const auto starts = [&](std::size_t line) {
    const std::string row = editor.row(line);
    const std::size_t open = row.find_first_not_of(" \t");
    return open != std::string::npos && row[open] == '[' && !editor.inside_value(line);
  };
  while (next <= editor.line_count() && !starts(next)) ++next;
  if (next <= editor.line_count())  // comments right before a section are about that section
    while (next > header + 1 && editor.row(next - 1).starts_with("#")) --next;
  const std::size_t begin = editor.start_of(header);
  return sound(out.erase(begin, editor.start_of(next) - begin), name, key);
}

std::string with_name(const std::string& text, const std::string& name, const KeyPath& section, const std::string& last) {
  const Editor editor(text, name);
  KeyPath renamed = section;
  renamed.back() = last;
  if (editor.find(renamed, renamed.size())) throw InputError(name + ": [" + dotted(renamed) + "]: is there already, expected another name");
  const std::size_t header = editor.header(section);
  if (header == 0) throw InputError(name + ": [" + dotted(section) + "]: has no line of its own, expected it to be renamed by hand");
  const std::size_t begin = editor.start_of(header), open = text.find('[', begin), close = text.find(']', begin);
  std::string out = text;
  return sound(out.replace(open, close + 1 - open, "[" + dotted(renamed) + "]"), name, renamed);
}

}  // namespace pivnp::app

#include "apps/case/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

int line_of(const toml::source_region& region) { return int(region.begin.line); }

Node converted(const toml::node& from);

void convert_table(const toml::table& from, Node& to) {
  std::vector<std::pair<toml::source_position, Entry>> sorted;  // the library sorts by name
  for (const auto& [key, value] : from) {
    Entry entry{std::string(key.str()), line_of(key.source()), converted(value)};
    sorted.emplace_back(key.source().begin, std::move(entry));
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& item : sorted) to.entries.push_back(std::move(item.second));
}

Node converted(const toml::node& from) {
  Node to;
  to.line = line_of(from.source());
  if (const auto* boolean = from.as_boolean()) {
    to.kind = Node::Kind::boolean;
    to.boolean = boolean->get();
  } else if (const auto* integer = from.as_integer()) {
    to.kind = Node::Kind::integer;
    to.integer = integer->get();
  } else if (const auto* number = from.as_floating_point()) {
    to.kind = Node::Kind::number;
    to.number = number->get();
  } else if (const auto* text = from.as_string()) {
    to.kind = Node::Kind::string;
    to.text = text->get();
  } else if (const auto* list = from.as_array()) {
    to.kind = Node::Kind::list;
    for (const toml::node& item : *list) to.list.push_back(converted(item));
  } else if (const auto* table = from.as_table()) {
    to.kind = Node::Kind::table;
    convert_table(*table, to);
  } else {
    to.kind = Node::Kind::date;
  }
  return to;
}

// The TOML library goes one level deeper for every part of a key, and has no bound (of brackets it has one).
constexpr std::size_t most_parts = 100;

void refuse_deep(const std::string& text, const std::string& name) {
  std::size_t line = 1, dots = 0;
  std::string_view quote;  // what ends the string that the place lies in
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    line += c == '\n';
    const std::string_view rest = std::string_view(text).substr(k);
    if (!quote.empty()) {
      if (c == '\\' && quote[0] == '"') {
        ++k;
        line += k < text.size() && text[k] == '\n';
      } else if (rest.starts_with(quote) || (c == '\n' && quote.size() == 1)) {
        k += quote.size() - 1;
        quote = {};
      }
    } else if (c == '#') {
      k = std::min(text.find('\n', k), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      quote = rest.substr(0, rest.size() > 2 && rest[1] == c && rest[2] == c ? 3 : 1);
      k += quote.size() - 1;
    } else if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') {
      dots = 0;  // of one key
    } else if (c == '.' && ++dots > most_parts) {
      throw InputError(name + ":" + std::to_string(line) + ": found a key of more than " + std::to_string(most_parts) +
                       " parts, expected fewer");
    }
  }
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  return text;
}

void forget_lines(Node& node) {
  node.line = 0;
  for (Node& item : node.list) forget_lines(item);
}

}  // namespace

std::string shortened(const std::string& text) {
  std::size_t end = 60;
  if (text.size() <= end) return text;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // UTF-8 continuation bytes
  return text.substr(0, end) + "...";
}

const Entry* Node::find(std::string_view key) const {
  for (const Entry& entry : entries)
    if (entry.key == key) return &entry;
  return nullptr;
}

Source::Source(std::string file, const Node& root) : file_(std::move(file)) { collect(root, ""); }

void Source::collect(const Node& table, const std::string& prefix) {
  for (const Entry& entry : table.entries) {
    const std::string key = joined_key(prefix, entry.key);
    lines_.emplace(key, entry.line);
    if (entry.value.kind == Node::Kind::table) collect(entry.value, key);
  }
}

std::string Source::place(const std::string& key) const {
  for (std::string k = key; !k.empty();) {
    if (const auto found = lines_.find(k); found != lines_.end() && found->second > 0) return file_ + ":" + std::to_string(found->second);
    const std::size_t dot = k.rfind('.');
    k = dot == std::string::npos ? "" : k.substr(0, dot);
  }
  return file_;
}

Node parse_document(const std::string& text, const std::string& name) {
  refuse_deep(text, name);
  try {
    return converted(toml::parse(text));
  } catch (const toml::parse_error& error) {
    throw InputError(name + ":" + std::to_string(line_of(error.source())) + ": " +
                     one_line(std::string(error.description())));
  }
}

Node parse_value(const std::string& text) {
  Node plain;
  plain.kind = Node::Kind::string;
  plain.text = text;
  if (text.find_first_of("\n#") != std::string::npos) return plain;  // would end the value and begin something else
  try {
    Node value = parse_document("x = " + text, "").entries.front().value;
    forget_lines(value);
    return value;
  } catch (const InputError&) {
    return plain;
  }
}

std::string describe(const Node& value) {
  switch (value.kind) {
    case Node::Kind::boolean: return value.boolean ? "true" : "false";
    case Node::Kind::integer: return std::to_string(value.integer);
    case Node::Kind::number: return toml_text(value.number);
    case Node::Kind::string: return "a string " + toml_text(shortened(value.text));
    case Node::Kind::date: return "a date or time";
    case Node::Kind::list:
      return value.list.empty() ? "an empty list" : "a list of " + std::to_string(value.list.size());
    case Node::Kind::table: break;
  }
  return "a section";
}

std::string joined_key(const std::string& prefix, std::string_view key) {
  return prefix.empty() ? std::string(key) : prefix + "." + std::string(key);
}

}  // namespace pivnp::app

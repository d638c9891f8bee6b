// A TOML text as a tree that keeps line numbers and the file's order. The TOML library stays behind it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pivnp::app {

struct Entry;

/// One value of the file.
struct Node {
  enum class Kind { boolean, integer, number, string, date, list, table };
  Kind kind = Kind::table;
  int line = 0;  // counted from 1
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0;
  std::string text;  // strings; dates as written
  std::vector<Node> list;
  std::vector<Entry> entries;  // tables: in the file's order

  const Entry* find(std::string_view key) const;  // nullptr: none
};

struct Entry {
  std::string key;
  int line = 0;
  Node value;
};

/// Where the keys of a case stand, for messages.
class Source {
 public:
  Source(std::string file, const Node& root);
  const std::string& file() const { return file_; }
  bool given(const std::string& key) const { return lines_.count(key) > 0; }
  /// "FILE:LINE"; the line of the nearest section around a key that is not there; "FILE" if there is none.
  std::string place(const std::string& key) const;
  /// "FILE:LINE: key".
  std::string at(const std::string& key) const { return place(key) + ": " + key; }

 private:
  void collect(const Node& table, const std::string& prefix);
  std::string file_;
  std::map<std::string, int> lines_;  // dotted key -> line
};

/// Throws InputError "NAME:LINE: ..." on a syntax error or a key given twice.
Node parse_document(const std::string& text, const std::string& name);

/// One value as a command line gives it, without lines: TOML where it is TOML, else the text itself as a string.
Node parse_value(const std::string& text);

/// A text as messages quote it: at most 60 bytes of it.
std::string shortened(const std::string& text);

/// What was found, in words: `a string "32"`, `2.5`, `true`, `a list`, `a section`.
std::string describe(const Node& value);

/// A dotted key: "piv" + "window_px" -> "piv.window_px"; an empty prefix adds nothing.
std::string joined_key(const std::string& prefix, std::string_view key);

}  // namespace pivnp::app

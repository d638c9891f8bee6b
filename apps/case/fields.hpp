// The visitors that read one section's options from a table and write them back.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/case/document.hpp"
#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

/// Refuses keys of `table` that are neither in `known` nor in `children` (sections under this one): all in one line, ten at most.
void refuse_unknown_keys(const std::string& file, const std::string& path, const Node& table,
                         std::vector<std::string> known, const std::vector<std::string>& children);

/// What the user should know of a case that reads all the same: one line each.
using Notes = std::vector<std::string>;

/// What becomes of keys and sections that are not known, and of values that do not fit: refused, or noted and left out (the
/// case of a record that a later version wrote).
enum class Reading { strict, tolerant };

/// What is wrong with a case, all of it: what `work` throws as InputError, "FILE:LINE: ...", is kept for raise().
class Faults {
 public:
  template <class Work>
  void gather(const Work& work) {
    try {
      work();
    } catch (const InputError& error) {
      found_.emplace_back(error.what());
    }
  }
  /// Throws InputError if there is anything, in one line; `file` is said once.
  void raise(const std::string& file) const;

 private:
  std::vector<std::string> found_;
};

/// What reading has found: notes, and faults of a strict reading.
struct Findings {
  Notes& notes;
  Faults faults = {};
};

/// Does `read`; what it throws as InputError is a fault, of a tolerant reading a note.
template <class Read>
void read_as(Reading reading, Findings& found, const Read& read) {
  if (reading == Reading::strict) return found.faults.gather(read);
  try {
    read();
  } catch (const InputError& error) {
    found.notes.push_back(error.what() + std::string(" (left out)"));
  }
}

/// Notes that a key has a new name. Throws InputError if the new one is given too.
void use_alias(const std::string& file, const std::string& path, const Node& table, std::string_view name,
               const Entry& old, Notes& notes);

/// Reads the options of section `path` from `table`. Keys that are not there keep their value; a key's former name
/// (OptionInfo::alias) is read too, and noted.
template <class T>
void read_fields(const std::string& file, const std::string& path, const Node& table,
                 const std::vector<std::string>& children, T& options, Findings& found,
                 Reading reading = Reading::strict) {
  std::vector<std::string> known;
  T::fields(options, [&](std::string_view name, auto&, const OptionInfo& info) {
    known.emplace_back(name);
    if (!info.alias.empty() && table.find(info.alias)) known.emplace_back(info.alias);
  });
  read_as(reading, found, [&] { refuse_unknown_keys(file, path, table, known, children); });
  T::fields(options, [&](std::string_view name, auto& value, const OptionInfo& info) {
    read_as(reading, found, [&] {
      const Entry* entry = table.find(name);
      if (const Entry* old = info.alias.empty() ? nullptr : table.find(info.alias)) {
        use_alias(file, path, table, name, *old, found.notes);
        entry = old;
      }
      if (!entry) return;
      auto given = value;
      read_value(Place{file, joined_key(path, entry->key), entry->line}, entry->value, info, given);
      value = std::move(given);
    });
  });
}

/// A line of write_fields. `text`: the value; empty: it cannot be written.
std::string field_line(std::string_view name, const OptionInfo& info, const std::string& text,
                       const std::string& default_text);

/// The options as lines "key = value". What is not given (an optional without value, an empty list or text that is
/// empty by default, a number outside its own range) stands as a comment that says what it would be.
template <class T>
std::string write_fields(const T& options) {
  std::vector<std::string> defaults;
  const T fallback{};
  T::fields(fallback,
            [&](std::string_view, const auto& value, const OptionInfo&) { defaults.push_back(toml_text(value)); });
  std::string lines;
  std::size_t k = 0;
  T::fields(options, [&](std::string_view name, const auto& value, const OptionInfo& info) {
    lines += field_line(name, info, writable(info, value) ? toml_text(value) : "", defaults[k++]);
  });
  return lines;
}

}  // namespace pivnp::app

// Reading a case: sections and keys here, what only the whole case shows in checks.cpp.
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "apps/case/checks.hpp"
#include "apps/case/fields.hpp"
#include "apps/case/given_keys.hpp"
#include "apps/case/lengths.hpp"
#include "apps/case/listing.hpp"
#include "apps/case/sections.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

void refuse_unknown_keys(const std::string& file, const std::string& path, const Node& table,
                         std::vector<std::string> known, const std::vector<std::string>& children) {
  constexpr std::size_t most = 10;
  known.insert(known.end(), children.begin(), children.end());
  std::string all;
  std::size_t count = 0;
  for (const Entry& entry : table.entries) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end() || ++count > most) continue;
    const std::string key = joined_key(path, shortened(entry.key));
    const bool section = entry.value.kind == Node::Kind::table;
    std::string hint = did_you_mean(entry.key, known);
    const bool near = hint.starts_with("; did");
    if (const auto homes = sections_with_key(entry.key); !homes.empty() && !near && !section) {
      hint = "; it belongs to ";
      for (std::size_t k = 0; k < homes.size(); ++k) hint += (k ? " or " : "") + homes[k];
    } else if (count > 1 && !near) {
      hint.clear();  // what is known is said once
    }
    all += (count == 1 ? file + ":" : "; line ") + std::to_string(entry.line) + ": unknown " +
           (section ? "section [" + key + "]" : "key '" + key + "'") + hint;
  }
  if (count > most) all += "; and " + std::to_string(count - most) + " more";
  if (count > 0) throw InputError(all);
}

void Faults::raise(const std::string& file) const {
  constexpr std::size_t most = 10;
  const auto line = [&](const std::string& fault) { return fault.starts_with(file + ":") ? std::atoi(fault.c_str() + file.size() + 1) : 0; };
  std::vector<std::string> faults = found_;
  std::stable_sort(faults.begin(), faults.end(), [&](const std::string& a, const std::string& b) { return line(a) < line(b); });
  std::string all;
  for (std::size_t k = 0; k < std::min(faults.size(), most); ++k) {
    const bool same_file = k > 0 && line(faults[k]) > 0;
    all += (k == 0 ? "" : "; ") + (same_file ? "line " + faults[k].substr(file.size() + 1) : faults[k]);
  }
  if (faults.size() > most) all += "; and " + std::to_string(faults.size() - most) + " more";
  if (!found_.empty()) throw InputError(all);
}

void use_alias(const std::string& file, const std::string& path, const Node& table, std::string_view name,
               const Entry& old, Notes& notes) {
  const std::string at = file + ":" + std::to_string(old.line) + ": ";
  const std::string now = joined_key(path, name), before = joined_key(path, old.key);
  if (table.find(name)) throw InputError(at + before + ": given together with " + now + ", its new name; expected one of them");
  notes.push_back(at + before + " is now called " + now + "; the old name will not be read for long");
}

namespace {

struct ReadSections {
  const std::string& file;
  const Node& root;
  Findings& found;
  Reading reading;

  // The table of a section; nullptr if the file has none.
  const Node* table(const std::string& path, const std::string& shown) const {
    const Node* node = &root;
    for (std::size_t begin = 0; begin <= path.size();) {
      const std::size_t end = std::min(path.find('.', begin), path.size());
      const Entry* entry = node->find(path.substr(begin, end - begin));
      if (!entry) return nullptr;
      demand_table(*entry, path.substr(0, end), shown);
      node = &entry->value;
      begin = end + 1;
    }
    return node;
  }

  void demand_table(const Entry& entry, const std::string& path, const std::string& shown) const {
    if (entry.value.kind != Node::Kind::table)
      throw InputError(file + ":" + std::to_string(entry.line) + ": " + path + ": found " + describe(entry.value) +
                       ", expected a section " + shown);
  }

  template <class T>
  void always(const std::string& path, T& options, const char*) const {
    read_as(reading, found, [&] {
      if (const Node* node = table(path, "[" + path + "]")) read_fields(file, path, *node, child_sections(path), options, found, reading);
    });
  }
  template <class T>
  void optional(const std::string& path, std::optional<T>& options, const char*) const {
    read_as(reading, found, [&] {
      if (const Node* node = table(path, "[" + path + "]"))
        read_fields(file, path, *node, child_sections(path), options.emplace(), found, reading);
    });
  }
  template <class T>
  void named(const std::string& path, Named<T>& list, const char*) const {
    const std::string shown = "[" + path + ".NAME] with a name of your choice";
    read_as(reading, found, [&] {
      const Node* node = table(path, shown);
      if (!node) return;
      for (const Entry& entry : node->entries)
        read_as(reading, found, [&] {
          const std::string key = joined_key(path, entry.key);
          demand_table(entry, key, shown);
          if (entry.key.empty())
            throw InputError(file + ":" + std::to_string(entry.line) + ": [" + path + ".\"\"]: the name is empty");
          if (!prints(entry.key))
            throw InputError(file + ":" + std::to_string(entry.line) + ": [" + path + "." + toml_key(entry.key) +
                             "]: the name holds control characters, expected one that prints");
          list.emplace_back(entry.key, T{});
          read_fields(file, key, entry.value, {}, list.back().second, found, reading);
        });
    });
  }
};

Case parsed(const Node& root, const std::string& name, const std::filesystem::path& folder, Reading reading) {
  Case c;
  c.folder = folder;
  std::vector<std::string> top = child_sections("");
  top.insert(top.begin(), "name");
  Findings found{c.notes};
  read_as(reading, found, [&] { refuse_unknown_keys(name, "", root, top, {}); });
  read_as(reading, found, [&] {
    if (const Entry* entry = root.find("name")) read_value(Place{name, "name", entry->line}, entry->value, {}, c.name);
  });
  for_each_section(c, ReadSections{name, root, found, reading});
  found.faults.raise(name);
  return c;
}

}  // namespace

Case parse_recorded_case(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  return parsed(parse_document(text, name), name, folder, Reading::tolerant);
}

Case parse_case(const std::string& text, const std::string& name, const std::filesystem::path& folder,
                const std::vector<std::string>& given, bool frames_follow) {
  Node root = parse_document(text, name);
  if (frames_follow && !root.find("frames") && !root.find("vectors") && !root.find("synth")) root.entries.push_back({"frames", 1, Node{}});
  for (std::size_t k = 0; k < given.size(); ++k) {
    const GivenKey key = parse_given_key(given[k], int(k) + 1);
    parsed(alone(key), "--set", folder, Reading::strict);  // tells what is wrong with it
    put(key, root, name);
  }
  Case c = parsed(root, name, folder, Reading::strict);
  c.source = Source(name, root);
  take_lengths_in_metres(c, *c.source);
  check_given(c, *c.source);
  if ((c.frames || c.synth) && !c.vectors && !c.piv) c.piv.emplace();
  if ((c.frames || c.synth || c.vectors) && !c.np) c.np.emplace();
  return c;
}

Case read_case(const std::filesystem::path& path, const std::vector<std::string>& given, bool frames_follow) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path file = path;
  if (fs::is_directory(file, ignored)) {
    file /= "case.toml";
    if (!fs::exists(file, ignored)) throw InputError(path.string() + ": the folder has no case.toml");
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  Case c = parse_case(text_of_file(file), file.string(), folder, given, frames_follow);
  c.file = file;
  if (c.name.empty()) c.name = short_name(c);
  return c;
}

std::string with_place(const Case& c, const std::string& message) {
  if (!c.source) return message;
  std::string text = message;
  for (const std::string& before : {c.file.string(), c.name, c.source->file()})
    if (!before.empty() && text.starts_with(before + ": ")) text.erase(0, before.size() + 2);
  const std::string key = text.substr(0, text.find(':'));
  const std::vector<std::string> top = child_sections("");
  const bool of_case = std::find(top.begin(), top.end(), key.substr(0, key.find('.'))) != top.end();
  return of_case ? c.source->place(key) + ": " + text : message;
}

std::string short_name(const Case& c) {
  if (c.file.empty()) return "gate_slope";  // the embedded case
  const auto file = std::filesystem::absolute(c.file).lexically_normal();
  return (file.filename() == "case.toml" ? file.parent_path().filename() : file.stem()).string();
}

}  // namespace pivnp::app

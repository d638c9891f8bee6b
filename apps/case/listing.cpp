#include "apps/case/listing.hpp"

#include "apps/case/sections.hpp"
#include "apps/case/values.hpp"
#include "mpm/material/model.hpp"

namespace pivnp::app {

namespace {

template <class T>
std::string allowed_text(const T& value, const OptionInfo& info) {
  std::string text;
  for (const std::string& choice : choices_of(value, info)) text += (text.empty() ? "" : ", ") + choice;
  return text.empty() ? range_text(info) : text;
}

// What else is known of a section's key.
template <class T>
std::string note_on(const T&, std::string_view) {
  return "";
}
std::string note_on(const mpm::MaterialOptions&, std::string_view key) {
  std::string laws;
  for (const std::string& model : mpm::models_with_key(key)) laws += (laws.empty() ? "; taken by " : ", ") + model;
  return laws;
}

template <class Section>
struct ListKeys {
  const Section& section;
  std::vector<KeyRow>& rows;

  template <class T>
  void operator()(std::string_view name, const T& value, const OptionInfo& info) {
    std::string fallback = writable(info, value) ? toml_text(value) : "";
    if (fallback == "[]" || fallback == "\"\"") fallback.clear();
    rows.push_back({std::string(name), type_text(value), std::string(info.unit), fallback, allowed_text(value, info),
                    std::string(info.text) + note_on(section, name)});
  }
};

struct ListSections {
  std::vector<SectionRow>& rows;

  template <class T>
  void add(const char* path, SectionRow::Kind kind, const char* text, const T& defaults) {
    rows.push_back({path, kind, text, {}});
    T::fields(defaults, ListKeys<T>{defaults, rows.back().keys});
  }
  template <class T>
  void always(const char* path, const T&, const char* text) {
    add(path, SectionRow::Kind::always, text, T{});
  }
  template <class T>
  void optional(const char* path, const std::optional<T>&, const char* text) {
    add(path, SectionRow::Kind::optional, text, T{});
  }
  template <class T>
  void named(const char* path, const Named<T>&, const char* text) {
    add(path, SectionRow::Kind::named, text, T{});
  }
};

}  // namespace

std::vector<SectionRow> case_sections() {
  std::vector<SectionRow> rows;
  const Case defaults;
  for_each_section(defaults, ListSections{rows});
  return rows;
}

std::vector<std::string> child_sections(const std::string& path) {
  const std::string prefix = path.empty() ? "" : path + ".";
  std::vector<std::string> names;
  for (const SectionRow& section : case_sections())
    if (section.path.starts_with(prefix) && section.path.find('.', prefix.size()) == std::string::npos)
      names.push_back(section.path.substr(prefix.size()));
  return names;
}

std::vector<std::string> sections_with_key(const std::string& key) {
  std::vector<std::string> names;
  for (const SectionRow& section : case_sections())
    for (const KeyRow& row : section.keys)
      if (row.key == key)
        names.push_back("[" + section.path + (section.kind == SectionRow::Kind::named ? ".NAME]" : "]"));
  return names;
}

}  // namespace pivnp::app

#include "apps/case/listing.hpp"

#include <cmath>

#include "apps/case/sections.hpp"
#include "apps/case/values.hpp"
#include "mpm/material/model.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

template <class T>
std::string allowed_text(const T& value, const OptionInfo& info) {
  std::string text;
  for (const std::string& choice : choices_of(value, info)) text += (text.empty() ? "" : ", ") + choice;
  return text.empty() ? range_text(info) : text;
}

std::string quoted_list(const std::vector<std::string>& choices) {
  std::string text;
  for (const std::string& choice : choices) text += (text.empty() ? "" : ", ") + toml_text(choice);
  return "[" + text + "]";
}

// A bound of the range; a case's numbers are finite.
std::string bounds(const OptionInfo& info) {
  std::string text;
  if (std::isfinite(info.min))
    text += std::string(info.above_min ? ", \"exclusiveMinimum\": " : ", \"minimum\": ") + number(info.min, 15);
  if (std::isfinite(info.max))
    text += (excludes_max(info) ? ", \"exclusiveMaximum\": " : ", \"maximum\": ") + number(info.max, 15);
  return text;
}

const char* const json_pair =
    "\"type\": \"array\", \"items\": {\"type\": \"number\"}, \"minItems\": 2, \"maxItems\": 2";

std::string value_schema(const bool&, const OptionInfo&) { return "\"type\": \"boolean\""; }
std::string value_schema(const int&, const OptionInfo& info) { return "\"type\": \"integer\"" + bounds(info); }
std::string value_schema(const double&, const OptionInfo& info) { return "\"type\": \"number\"" + bounds(info); }
std::string value_schema(const std::string&, const OptionInfo& info) {
  const std::vector<std::string> choices = choices_of(info);
  return choices.empty() ? "\"type\": \"string\"" : "\"enum\": " + quoted_list(choices);
}
std::string value_schema(const Pair&, const OptionInfo&) { return json_pair; }
std::string value_schema(const Points&, const OptionInfo&) {
  return std::string("\"type\": \"array\", \"items\": {") + json_pair + "}";
}
std::string value_schema(const std::vector<double>&, const OptionInfo& info) {
  return "\"type\": \"array\", \"items\": {\"type\": \"number\"" + bounds(info) + "}";
}
std::string value_schema(const std::vector<std::string>&, const OptionInfo&) {
  return "\"type\": \"array\", \"items\": {\"type\": \"string\"}";
}
template <Choice E>
std::string value_schema(const E&, const OptionInfo&) {
  return "\"enum\": " + quoted_list(choice_names<E>());
}
template <class T>
std::string value_schema(const std::optional<T>&, const OptionInfo& info) {
  return value_schema(T{}, info);
}

// What else is known of a section's key.
template <class T>
std::string note_on(const T&, std::string_view) {
  return "";
}
std::string note_on(const mpm::MaterialOptions&, std::string_view key) {
  const std::vector<std::string> users = mpm::models_with_key(key);
  if (users.size() + 1 == mpm::material_model_names().size()) return " (all but water)";
  std::string laws;
  for (const std::string& model : users) laws += (laws.empty() ? " (" : ", ") + model;
  return laws.empty() ? "" : laws + ")";
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
                    std::string(info.text) + note_on(section, name), value_schema(value, info)});
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

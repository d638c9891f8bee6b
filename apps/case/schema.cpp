// The JSON schema of a case, for editors that complete and check TOML by one.
#include "apps/case/case.hpp"
#include "apps/case/listing.hpp"
#include "apps/case/values.hpp"

namespace pivnp::app {

namespace {

// As in JSON: a TOML string that escapes no more than JSON does.
std::string quoted(const std::string& text) { return toml_text(text); }

std::string key_schema(const KeyRow& key) {
  const std::string unit = key.unit.empty() ? "" : " (" + key.unit + ")";
  std::string text = quoted(key.key) + ": {" + key.schema + ", \"description\": " + quoted(key.text + unit);
  if (!key.fallback.empty()) text += ", \"default\": " + key.fallback;
  return text + "}";
}

// The object of a section: its keys, and the sections under it.
std::string object_schema(const std::string& path, const SectionRow* row, const std::vector<SectionRow>& sections,
                          const std::string& indent) {
  const std::string inner = indent + "    ";
  std::string members;
  const auto add = [&](const std::string& member) { members += (members.empty() ? "\n" : ",\n") + inner + member; };
  if (path.empty()) add("\"name\": {\"type\": \"string\", \"description\": \"name of the case\"}");
  if (row)
    for (const KeyRow& key : row->keys) add(key_schema(key));
  const bool many = row && row->kind == SectionRow::Kind::named;
  if (!many)
    for (const std::string& child : child_sections(path))
      for (const SectionRow& section : sections)
        if (section.path == joined_key(path, child))
          add(quoted(child) + ": " + object_schema(section.path, &section, sections, inner));
  std::string text = "{";
  if (row) text += "\n" + indent + "  \"description\": " + quoted(row->text) + ",";
  text += "\n" + indent + "  \"type\": \"object\",";
  const std::string own = "\n" + indent + "  \"properties\": {" + members + "\n" + indent + "  },\n" + indent +
                          "  \"additionalProperties\": false\n" + indent + "}";
  if (!many) return text + own;
  return text + "\n" + indent + "  \"additionalProperties\": {\"type\": \"object\"," + own + "\n" + indent + "}";
}

}  // namespace

std::string case_schema() {
  const std::string body = object_schema("", nullptr, case_sections(), "");
  return "{\n  \"$schema\": \"http://json-schema.org/draft-07/schema#\",\n  \"title\": \"A case of pivnp\"," + body.substr(1) + "\n";
}

}  // namespace pivnp::app

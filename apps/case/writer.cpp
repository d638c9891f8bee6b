// Writing a case with every default filled in.
#include "apps/case/fields.hpp"
#include "apps/case/sections.hpp"

namespace pivnp::app {

namespace {

struct WriteSections {
  std::string& text;
  std::string absent = {};  // a section that is not there: those under it cannot be written

  bool under_absent(const std::string& path) const { return !absent.empty() && path.starts_with(absent + "."); }

  template <class T>
  void write(const std::string& path, const T& options) {
    text += "\n[" + path + "]\n" + write_fields(options);
  }
  template <class T>
  void always(const std::string& path, const T& options, const char*) {
    if (under_absent(path)) return;
    write(path, options);
  }
  // An empty [verify] would ask for a threshold.
  void always(const std::string& path, const VerifyOptions& options, const char*) {
    if (demands_anything(options)) write(path, options);
  }
  template <class T>
  void optional(const std::string& path, const std::optional<T>& options, const char*) {
    if (under_absent(path)) return;
    if (options)
      write(path, *options);
    else
      absent = path;
  }
  template <class T>
  void named(const std::string& path, const Named<T>& list, const char*) {
    if (under_absent(path)) return;
    for (const auto& [name, options] : list) write(path + "." + toml_key(name), options);
  }
};

}  // namespace

std::string field_line(std::string_view name, const OptionInfo& info, const std::string& text,
                       const std::string& default_text) {
  const bool empty_by_default = (text == "[]" || text == "\"\"") && text == default_text;
  if (!text.empty() && !empty_by_default) return std::string(name) + " = " + text + "\n";
  const std::string unit = info.unit.empty() ? "" : " (" + std::string(info.unit) + ")";
  return "# " + std::string(name) + " is not given" + unit + ": " + std::string(info.text) + "\n";
}

std::string write_case(const Case& c) {
  std::string text = "name = " + toml_text(c.name) + "\n";
  for_each_section(c, WriteSections{text});
  return text;
}

}  // namespace pivnp::app

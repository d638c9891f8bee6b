// Writing a case with every default filled in.
#include "apps/case/fields.hpp"
#include "apps/case/sections.hpp"

namespace pivnp::app {

namespace {

bool only_comments(const std::string& lines) {
  for (std::size_t begin = 0; begin < lines.size(); begin = lines.find('\n', begin) + 1)
    if (lines[begin] != '#') return false;
  return true;
}

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
    const std::string lines = write_fields(options);
    // A section of which nothing is given is a comment as a whole: an empty [verify] would ask for a threshold.
    text += (only_comments(lines) ? "\n# [" : "\n[") + path + "]\n" + lines;
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

std::string write_case(const Case& c) {
  std::string text = "name = " + toml_text(c.name) + "\n";
  for_each_section(c, WriteSections{text});
  return text;
}

}  // namespace pivnp::app

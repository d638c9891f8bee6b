// Legacy VTK, ASCII or BINARY, as Anura3D writes it (<project>_MPVector_NNN.vtk with its siblings _MPScalar_, which
// hold the ids), and VTK XML of unstructured grids in ASCII, as MPM-Geomechanics does (particles_N.vtu).
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/read_number.hpp"

namespace pivnp::io {

namespace {

struct Array {
  std::size_t components = 1;
  std::vector<double> values;
};
using Arrays = std::map<std::string, Array>;

bool blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

// Walks through a file: words, lines, raw numbers.
class Cursor {
 public:
  /// `text` begins in line `line` of the file; `what`: the part of the file it is, for messages.
  Cursor(std::string_view text, std::string file, std::size_t line = 1, std::string what = "")
      : text_(text), name_(std::move(file)), what_(std::move(what)), first_line_(line) {}

  bool end() {
    skip_blanks();
    return at_ >= text_.size();
  }
  std::string_view word() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !blank(text_[at_])) ++at_;
    if (begin == at_) fail("ends too early");
    return text_.substr(begin, at_ - begin);
  }
  std::string_view line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view out = text_.substr(at_, end - at_);
    at_ = std::min(text_.size(), end + 1);
    if (out.ends_with('\r')) out.remove_suffix(1);
    return out;
  }
  std::size_t count() {
    const std::string_view w = word();
    std::size_t n = 0;
    const auto [stop, error] = std::from_chars(w.data(), w.data() + w.size(), n);
    if (error != std::errc() || stop != w.data() + w.size()) wrong(w, "a count");
    return n;
  }
  double number() {
    const std::string_view w = word();
    const std::optional<double> v = read_number(w);
    if (!v) wrong(w, "a number");
    if (std::isinf(*v)) wrong(w, "a finite number, or nan");
    return *v;
  }
  std::string_view bytes(std::size_t n) {
    if (text_.size() - at_ < n) fail("ends too early");
    const std::string_view out = text_.substr(at_, n);
    at_ += n;
    return out;
  }
  /// Bytes that are still to come: no more numbers can follow, whatever a count says.
  std::size_t left() const { return text_.size() - at_; }
  [[noreturn]] void wrong(std::string_view found, const std::string& expected) const {
    fail("found '" + shown(found) + "', expected " + expected);
  }
  [[noreturn]] void fail(const std::string& what) const {
    const auto lines = std::count(text_.begin(), text_.begin() + std::ptrdiff_t(std::min(at_, text_.size())), '\n');
    throw InputError(name_ + ":" + std::to_string(first_line_ + std::size_t(lines)) + ": " + what_ + what);
  }
  std::size_t place() const { return at_; }
  void go(std::size_t at) { at_ = at; }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && blank(text_[at_])) ++at_;
  }
  std::string_view text_;
  std::string name_, what_;
  std::size_t first_line_, at_ = 0;
};

std::size_t bytes_of(std::string_view type, const Cursor& in) {
  if (type == "double" || type == "long" || type == "unsigned_long" || type == "vtktypeint64") return 8;
  if (type == "float" || type == "int" || type == "unsigned_int" || type == "vtkidtype") return 4;
  if (type == "short" || type == "unsigned_short") return 2;
  if (type == "char" || type == "unsigned_char") return 1;
  in.wrong(type, "a type of numbers");
}

template <class Bits>
Bits big_endian(const char* raw) {
  Bits bits = 0;
  for (std::size_t k = 0; k < sizeof(Bits); ++k) bits = Bits(bits << 8) | Bits(static_cast<unsigned char>(raw[k]));
  return bits;
}

double value_of(const char* raw, std::string_view type) {
  if (type == "double") return std::bit_cast<double>(big_endian<std::uint64_t>(raw));
  if (type == "float") return double(std::bit_cast<float>(big_endian<std::uint32_t>(raw)));
  if (type == "long" || type == "unsigned_long" || type == "vtktypeint64")
    return double(std::int64_t(big_endian<std::uint64_t>(raw)));
  if (type == "unsigned_int") return double(big_endian<std::uint32_t>(raw));
  if (type == "int" || type == "vtkidtype") return double(std::int32_t(big_endian<std::uint32_t>(raw)));
  if (type == "short") return double(std::int16_t(std::uint16_t((static_cast<unsigned char>(raw[0]) << 8) |
                                                                static_cast<unsigned char>(raw[1]))));
  return double(static_cast<unsigned char>(raw[0]));
}

// Numbers after a keyword's line, `tuples` times `components` of them.
std::vector<double> values(Cursor& in, std::size_t components, std::size_t tuples, std::string type, bool binary) {
  for (char& c : type) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (components > 0 && tuples > in.left() / components)
    in.fail("says that " + std::to_string(tuples) + " times " + std::to_string(components) +
            " numbers follow, but the file has only " + std::to_string(in.left()) + " bytes more");
  const std::size_t count = components * tuples;
  std::vector<double> out(count);
  if (!binary) {
    for (double& v : out) v = in.number();
    return out;
  }
  const std::size_t size = bytes_of(type, in);
  const std::string_view raw = in.bytes(count * size);
  for (std::size_t k = 0; k < count; ++k) out[k] = value_of(raw.data() + k * size, type);
  return out;
}

Arrays parse_legacy(const std::string& text, const std::string& name) {
  Cursor in(text, name);
  if (!in.line().starts_with("# vtk DataFile")) throw InputError(name + ": not a legacy VTK file");
  in.line();  // title
  std::string_view format = in.line();
  while (!format.empty() && blank(format.back())) format.remove_suffix(1);
  if (format != "ASCII" && format != "BINARY") in.wrong(format, "ASCII or BINARY");
  const bool binary = format == "BINARY";
  Arrays arrays;
  std::size_t points = 0, data = 0;
  // After a keyword's last word the raw numbers of a binary file begin on the next line.
  const auto rest_of_line = [&] { in.line(); };
  while (!in.end()) {
    const std::string key(in.word());
    if (key == "DATASET") {
      if (const std::string_view kind = in.word(); kind != "UNSTRUCTURED_GRID" && kind != "POLYDATA")
        in.wrong(kind, "UNSTRUCTURED_GRID");
    } else if (key == "POINTS") {
      points = in.count();
      const std::string type(in.word());
      rest_of_line();
      arrays["points"] = {3, values(in, 3, points, type, binary)};
    } else if (key == "CELLS" || key == "VERTICES") {
      in.count();
      const std::size_t numbers = in.count();
      rest_of_line();
      values(in, 1, numbers, "int", binary);
    } else if (key == "CELL_TYPES") {
      const std::size_t numbers = in.count();
      rest_of_line();
      values(in, 1, numbers, "int", binary);
    } else if (key == "POINT_DATA" || key == "CELL_DATA") {
      data = in.count();
      rest_of_line();
    } else if (key == "SCALARS") {
      const std::string array(in.word()), type(in.word());
      std::string_view rest = in.line();
      while (!rest.empty() && blank(rest.front())) rest.remove_prefix(1);
      std::size_t components = 1;
      if (!rest.empty()) std::from_chars(rest.data(), rest.data() + rest.size(), components);
      const std::size_t before = in.place();
      if (!in.end() && in.word() == "LOOKUP_TABLE") rest_of_line();
      else in.go(before);
      arrays[array] = {components, values(in, components, data, type, binary)};
    } else if (key == "VECTORS" || key == "NORMALS") {
      const std::string array(in.word()), type(in.word());
      rest_of_line();
      arrays[array] = {3, values(in, 3, data, type, binary)};
    } else if (key == "TENSORS") {
      const std::string array(in.word()), type(in.word());
      rest_of_line();
      arrays[array] = {9, values(in, 9, data, type, binary)};
    } else if (key == "FIELD") {
      in.word();
      const std::size_t count = in.count();
      for (std::size_t k = 0; k < count; ++k) {
        const std::string array(in.word());
        const std::size_t components = in.count(), tuples = in.count();
        const std::string type(in.word());
        rest_of_line();
        arrays[array] = {components, values(in, components, tuples, type, binary)};
      }
    } else {
      in.wrong(key, "a keyword of the legacy VTK format");
    }
  }
  if (!arrays.contains("points")) throw InputError(name + ": no POINTS");
  return arrays;
}

const Array* find(const Arrays& arrays, const std::string& name, std::size_t points, std::size_t components) {
  const auto it = arrays.find(name);
  const bool fits = it != arrays.end() && it->second.components >= components &&
                    it->second.values.size() == points * it->second.components;
  return fits ? &it->second : nullptr;
}

std::vector<std::array<double, 2>> pairs(const Array& a) {
  std::vector<std::array<double, 2>> out;
  for (std::size_t k = 0; k + a.components <= a.values.size(); k += a.components)
    out.push_back({a.values[k], a.values[k + 1]});
  return out;
}

void take_ids(const Array* a, const std::string& file, ImportedState& s) {
  if (a == nullptr) return;
  for (std::size_t k = 0; k < a->values.size(); k += a->components) {
    const double v = a->values[k];
    if (!(std::abs(v) < 9e15))
      throw InputError(file + ": the id of particle " + std::to_string(k / a->components) + " is " + std::to_string(v) +
                       ", expected a whole number");
    s.id.push_back(std::int64_t(std::llround(v)));
  }
}

std::size_t line_of(std::string_view text, std::size_t at) {
  return 1 + std::size_t(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
}

// Text of an attribute whatever the case of its name ("Format" for "format").
std::string attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = 0; at + name.size() + 2 < tag.size(); ++at) {
    bool same = at == 0 || blank(tag[at - 1]);
    for (std::size_t k = 0; same && k < name.size(); ++k)
      same = std::tolower(static_cast<unsigned char>(tag[at + k])) == name[k];
    if (!same || tag[at + name.size()] != '=') continue;
    const char quote = tag[at + name.size() + 1];
    const std::size_t begin = at + name.size() + 2, end = tag.find(quote, begin);
    return end == tag.npos ? "" : std::string(tag.substr(begin, end - begin));
  }
  return "";
}

// What stands between `begin` and `end` of a VTK XML file.
Arrays arrays_of_piece(std::string_view all, std::size_t begin, std::size_t end_of_piece, const std::string& file) {
  const std::size_t points_begin = all.find("<Points", begin), points_end = all.find("</Points>", begin);
  Arrays arrays;
  for (std::size_t at = all.find("<DataArray", begin); at < end_of_piece; at = all.find("<DataArray", at + 1)) {
    const std::size_t close = all.find('>', at);
    if (close == all.npos) throw InputError(file + ": ends too early");
    const std::string_view tag = all.substr(at, close - at);
    if (tag.ends_with('/')) continue;
    const std::size_t end = all.find("</DataArray>", close);
    if (end == all.npos) throw InputError(file + ": ends too early");
    const std::string format = attribute(tag, "format");
    const bool points = at > points_begin && at < points_end;
    const std::string name = points ? "points" : attribute(tag, "name");
    if (name == "connectivity" || name == "offsets" || name == "types") continue;
    if (!format.empty() && format != "ascii")
      throw InputError(file + ": array '" + shown(name) + "': format '" + shown(format) + "', expected ascii");
    Array array;
    if (const std::string c = attribute(tag, "numberofcomponents"); !c.empty())
      array.components = std::size_t(std::clamp(std::atoi(c.c_str()), 1, 1000));
    Cursor in(all.substr(close + 1, end - close - 1), file, line_of(all, close), "array '" + shown(name) + "': ");
    while (!in.end()) array.values.push_back(in.number());
    arrays[name] = std::move(array);
  }
  return arrays;
}

}  // namespace

ImportedState read_legacy_vtk(const std::vector<std::filesystem::path>& files) {
  const std::filesystem::path& file = files.at(0);
  Arrays arrays = parse_legacy(text_of_file(file), file.string());
  const std::string name = file.filename().string();
  // Scalars and vectors of one step stand in files of their own.
  for (const auto& [kind, other] : {std::pair{"_MPVector_", "_MPScalar_"}, {"_MPScalar_", "_MPVector_"},
                                    {"_MPTensor_", "_MPVector_"}, {"_MPTensor_", "_MPScalar_"}}) {
    const std::size_t at = name.find(kind);
    if (at == std::string::npos) continue;
    std::string sibling = name;
    sibling.replace(at, std::string(kind).size(), other);
    const std::filesystem::path path = file.parent_path() / sibling;
    if (!std::filesystem::exists(path)) continue;
    for (auto& [key, array] : parse_legacy(text_of_file(path), path.string())) arrays.emplace(key, std::move(array));
  }
  ImportedState s;
  s.x = pairs(arrays.at("points"));
  const std::size_t n = s.x.size();
  if (const Array* u = find(arrays, "displacement_solid", n, 2)) s.u = pairs(*u);
  else if (const Array* other = find(arrays, "displacement", n, 2)) s.u = pairs(*other);
  if (const Array* v = find(arrays, "velocity_solid", n, 2)) s.v = pairs(*v);
  take_ids(find(arrays, "material_point_id", n, 1), file.string(), s);
  return s;
}

ImportedState read_vtu(const std::vector<std::filesystem::path>& files) {
  const std::filesystem::path& file = files.at(0);
  const std::string text = text_of_file(file);
  const std::string_view all = text;
  if (all.find("<VTKFile") == all.npos) throw InputError(file.string() + ": not a VTK XML file");
  // Of several pieces (one a process, say) the arrays follow one another.
  Arrays arrays;
  const std::size_t piece = all.find("<Piece"), first = piece == all.npos ? 0 : piece;
  for (std::size_t begin = first; begin < all.size();) {
    const std::size_t end = std::min(all.find("<Piece", begin + 1), all.size());
    Arrays own = arrays_of_piece(all, begin, end, file.string());
    for (auto& [name, array] : own) {
      if (begin == first) {
        arrays[name] = std::move(array);
      } else if (const auto there = arrays.find(name); there != arrays.end() && there->second.components == array.components) {
        there->second.values.insert(there->second.values.end(), array.values.begin(), array.values.end());
      } else {
        throw InputError(file.string() + ": array '" + shown(name) + "' is not the same in every piece of the file");
      }
    }
    for (const auto& [name, array] : arrays)
      if (!own.contains(name)) throw InputError(file.string() + ": array '" + shown(name) + "' is missing in a piece of the file");
    begin = end;
  }
  if (!arrays.contains("points") || arrays["points"].components < 2)
    throw InputError(file.string() + ": no points of two or three coordinates");
  ImportedState s;
  s.x = pairs(arrays["points"]);
  const std::size_t n = s.x.size();
  if (const Array* u = find(arrays, "Displacement", n, 2)) s.u = pairs(*u);
  if (const Array* v = find(arrays, "Velocity", n, 2)) s.v = pairs(*v);
  take_ids(find(arrays, "Particle Id", n, 1), file.string(), s);
  const Array *xx = find(arrays, "Stress_XX", n, 1), *yy = find(arrays, "Stress_YY", n, 1),
              *zz = find(arrays, "Stress_ZZ", n, 1), *xy = find(arrays, "Stress_XY", n, 1);
  if (xx && yy && zz && xy && n > 0) {
    s.fields.push_back({"stress", {}});
    for (std::size_t k = 0; k < n; ++k)
      s.fields[0].values.insert(s.fields[0].values.end(), {xx->values[k], yy->values[k], zz->values[k], xy->values[k]});
  }
  return s;
}

}  // namespace pivnp::io

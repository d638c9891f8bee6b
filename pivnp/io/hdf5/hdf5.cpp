#include "pivnp/io/hdf5/hdf5.hpp"

#include <unistd.h>

#include <algorithm>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/hdf5/hdf5_internal.hpp"

namespace pivnp::io::h5 {

hid_t memory_type(Type type) {
  switch (type) {
    case Type::f32: return H5T_NATIVE_FLOAT;
    case Type::f64: return H5T_NATIVE_DOUBLE;
    case Type::u8: return H5T_NATIVE_UINT8;
    case Type::i32: return H5T_NATIVE_INT32;
    case Type::i64: return H5T_NATIVE_INT64;
  }
  return -1;
}

std::size_t size_of(Type type) {
  switch (type) {
    case Type::u8: return 1;
    case Type::f32:
    case Type::i32: return 4;
    case Type::f64:
    case Type::i64: return 8;
  }
  return 0;
}

std::size_t product(const Shape& shape, std::size_t from) {
  std::size_t n = 1;
  for (std::size_t k = from; k < shape.size(); ++k) n *= shape[k];
  return n;
}

void silence() {
  static const bool done = [] { return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0; }();
  (void)done;
}

bool reads(hid_t type) {
  const auto is_one_of = [&](std::initializer_list<hid_t> kinds) {
    return std::any_of(kinds.begin(), kinds.end(), [&](hid_t kind) { return H5Tequal(type, kind) > 0; });
  };
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return is_one_of({H5T_STD_I8LE, H5T_STD_U8LE, H5T_STD_I16LE, H5T_STD_U16LE, H5T_STD_I32LE, H5T_STD_U32LE, H5T_STD_I64LE,
                        H5T_STD_U64LE, H5T_STD_I8BE, H5T_STD_U8BE, H5T_STD_I16BE, H5T_STD_U16BE, H5T_STD_I32BE, H5T_STD_U32BE,
                        H5T_STD_I64BE, H5T_STD_U64BE});
    case H5T_FLOAT: return is_one_of({H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_IEEE_F32BE, H5T_IEEE_F64BE});
    case H5T_STRING: return true;
    case H5T_ENUM: {
      const Handle base(H5Tget_super(type), H5Tclose);
      return base && reads(base.get());
    }
    case H5T_COMPOUND:
      for (unsigned k = 0; k < unsigned(std::max(0, H5Tget_nmembers(type))); ++k) {
        const Handle member(H5Tget_member_type(type, k), H5Tclose);
        const H5T_class_t kind = H5Tget_class(member.get());
        if (kind == H5T_STRING || kind == H5T_COMPOUND || !reads(member.get())) return false;
      }
      return true;
    default: return false;
  }
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

std::string last_cause() {
  std::string text;
  // Upward: the first entry is the innermost, which knows the cause.
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD,
           [](unsigned n, const H5E_error2_t* e, void* out) -> herr_t {
             if (n == 0 && e->desc) *static_cast<std::string*>(out) = e->desc;
             return 0;
           },
           &text);
  return text.empty() ? "unknown cause" : text;
}

namespace {

[[noreturn]] void unreadable(const std::string& label) {
  throw InputError(label + ": cannot be read (" + last_cause() + ")");
}

constexpr double most_values = 1e15;

std::string shape_text(const Shape& shape) {
  std::string text = "[";
  for (std::size_t k = 0; k < shape.size(); ++k) text += (k ? ", " : "") + std::to_string(shape[k]);
  return text + "]";
}

Shape shape_of(hid_t space) {
  Shape shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

// Strings of an attribute or a dataset, variable-length or fixed, by the reading function given.
std::vector<std::string> read_texts(hid_t space, hid_t file_type, const std::string& label, const auto& read) {
  if (H5Tget_class(file_type) != H5T_STRING) throw InputError(label + ": is not text");
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  std::vector<std::string> out(count);
  if (count == 0) return out;
  if (H5Tis_variable_str(file_type) > 0) {
    const Handle type = text_type();
    H5Tset_cset(type.get(), H5Tget_cset(file_type));
    std::vector<char*> raw(count, nullptr);
    if (read(type.get(), raw.data()) < 0) unreadable(label);
    for (std::size_t k = 0; k < count; ++k) out[k] = raw[k] ? raw[k] : "";
    H5Dvlen_reclaim(type.get(), space, H5P_DEFAULT, raw.data());
    return out;
  }
  const std::size_t width = H5Tget_size(file_type);
  std::vector<char> raw(count * width);
  if (read(file_type, raw.data()) < 0) unreadable(label);
  for (std::size_t k = 0; k < count; ++k) {
    out[k].assign(raw.data() + k * width, width);
    out[k].erase(std::find(out[k].begin(), out[k].end(), '\0'), out[k].end());
  }
  return out;
}

}  // namespace

void Dataset::expect(const Shape& expected) const {
  if (shape_ != expected)
    throw InputError(label_ + ": has shape " + shape_text(shape_) + ", expected " + shape_text(expected));
}

void Dataset::expect_room(std::size_t value_bytes) const {
  const double bytes = double(product(shape_)) * double(value_bytes),
               memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  if (bytes > memory)
    throw InputError(label_ + ": has shape " + shape_text(shape_) + ", more than this machine's memory holds");
}

void Dataset::expect_values() const {
  const Handle type(H5Dget_type(id_.get()), H5Tclose), properties(H5Dget_create_plist(id_.get()), H5Pclose);
  if (!type || !properties) unreadable(label_);
  if (!reads(type.get())) throw InputError(label_ + ": of a kind that is not read, expected numbers or text");
  if (H5Pget_layout(properties.get()) == H5D_VIRTUAL || H5Pget_external_count(properties.get()) != 0)
    throw InputError(label_ + ": its values stand elsewhere, expected them in the dataset itself");
}

void Dataset::read(Type type, std::size_t first, std::size_t count, void* out) const {
  expect_values();
  if (shape_.empty()) {
    if (H5Dread(id_.get(), memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0) unreadable(label_);
    return;
  }
  if (first + count > shape_[0])
    throw InputError(label_ + ": has " + std::to_string(shape_[0]) + " items, item " +
                     std::to_string(first + count - 1) + " was asked for");
  if (count == 0 || product(shape_) == 0) return;
  Shape start(shape_.size(), 0), extent = shape_;
  start[0] = first;
  extent[0] = count;
  const Handle space(H5Dget_space(id_.get()), H5Sclose);
  const Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr) < 0 ||
      H5Dread(id_.get(), memory_type(type), memory.get(), space.get(), H5P_DEFAULT, out) < 0)
    unreadable(label_);
}

Source::Source(const std::filesystem::path& path) : name_(path.string()) {
  silence();
  open_regular_file(path, name_);  // HDF5 does not tell what it is short of from what is damaged
  if (H5Fis_hdf5(name_.c_str()) <= 0) throw InputError(name_ + ": not an HDF5 file, expected a record of pivnp");
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(access.get(), false, true);  // records are only ever replaced whole
#endif
  own_ = Handle(H5Fopen(name_.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!own_) throw InputError(name_ + ": a truncated or damaged HDF5 file (" + last_cause() + ")");
  id_ = own_.get();
}

bool Source::has(const std::string& path) const {
  // Every group on the way must be there, or HDF5 calls the question an error.
  for (std::size_t at = path.find('/', 1);; at = path.find('/', at + 1)) {
    const std::string part = path.substr(0, at);
    if (part != "/" && H5Lexists(id_, part.c_str(), H5P_DEFAULT) <= 0) return false;
    if (at == std::string::npos) return true;
  }
}

bool Source::has_attribute(const std::string& object, const std::string& name) const {
  return has(object) && H5Aexists_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

Dataset Source::dataset(const std::string& path) const {
  const std::string label = name_ + ": " + path;
  if (!has(path)) throw InputError(label + ": is missing");
  Handle id(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!id) unreadable(label);
  const Handle space(H5Dget_space(id.get()), H5Sclose);
  Shape shape = shape_of(space.get());
  double values = 1;
  for (const hsize_t n : shape) values *= double(n);
  if (!(values < most_values)) throw InputError(label + ": has shape " + shape_text(shape) + ", more than can be read");
  return Dataset(std::move(id), std::move(shape), label);
}

namespace {

Handle open_attribute(const Source& source, const std::string& object, const std::string& name, std::string& label) {
  label = source.name() + ": " + object + ": attribute '" + name + "'";
  if (!source.has_attribute(object, name)) throw InputError(label + " is missing");
  Handle id(H5Aopen_by_name(source.id(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!id) unreadable(label);
  const Handle type(H5Aget_type(id.get()), H5Tclose);
  if (!reads(type.get())) throw InputError(label + " is of a kind that is not read, expected numbers or text");
  return id;
}

}  // namespace

std::string Source::attribute_text(const std::string& object, const std::string& name, bool lines) const {
  std::string label;
  const Handle id = open_attribute(*this, object, name, label);
  const Handle space(H5Aget_space(id.get()), H5Sclose), type(H5Aget_type(id.get()), H5Tclose);
  const auto texts =
      read_texts(space.get(), type.get(), label, [&](hid_t t, void* out) { return H5Aread(id.get(), t, out); });
  const std::string text = texts.empty() ? "" : texts[0];
  if (printable(text, lines) != text) throw InputError(label + " holds control characters, expected text that prints");
  return text;
}

std::vector<double> Source::attribute_numbers(const std::string& object, const std::string& name) const {
  std::string label;
  const Handle id = open_attribute(*this, object, name, label);
  const Handle space(H5Aget_space(id.get()), H5Sclose);
  std::vector<double> out(static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get()))));
  if (!out.empty() && H5Aread(id.get(), H5T_NATIVE_DOUBLE, out.data()) < 0) unreadable(label);
  return out;
}

double Source::attribute_number(const std::string& object, const std::string& name) const {
  const std::vector<double> values = attribute_numbers(object, name);
  if (values.size() != 1) throw InputError(name_ + ": " + object + ": attribute '" + name + "' is not one number");
  return values[0];
}

std::vector<std::string> Source::texts(const std::string& path) const {
  const Dataset d = dataset(path);
  d.expect_values();
  const Handle space(H5Dget_space(d.id()), H5Sclose), type(H5Dget_type(d.id()), H5Tclose);
  return read_texts(space.get(), type.get(), d.label(),
                    [&](hid_t t, void* out) { return H5Dread(d.id(), t, H5S_ALL, H5S_ALL, H5P_DEFAULT, out); });
}

std::vector<std::string> Source::children(const std::string& group) const {
  std::vector<std::string> names;
  if (!has(group)) return names;
  const Handle id(H5Gopen2(id_, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (!id) unreadable(name_ + ": " + group);
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  // Groups of other writers may know no order of creation.
  if (H5Literate(id.get(), H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, add, &names) < 0) {
    names.clear();
    if (H5Literate(id.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0) unreadable(name_ + ": " + group);
  }
  for (const std::string& name : names)
    if (!prints(name))
      throw InputError(name_ + ": " + group + ": holds '" + shown(name) + "', expected a name that prints");
  return names;
}

}  // namespace pivnp::io::h5

// The little of HDF5 that the record needs, behind handles that close themselves. Private to this folder's sources.
// HDF5 is not thread-safe as Debian builds it: one thread at a time.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pivnp/io/files/files.hpp"

namespace pivnp::io::h5 {

/// Owns an HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = other.id_;
      close_ = other.close_;
      other.id_ = -1;
    }
    return *this;
  }
  ~Handle() { reset(); }
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = -1;
  }
  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

using Shape = std::vector<hsize_t>;

enum class Type { f32, f64, u8, i32, i64 };
std::size_t size_of(Type type);

template <class T> struct TypeOf;
template <> struct TypeOf<float> { static constexpr Type value = Type::f32; };
template <> struct TypeOf<double> { static constexpr Type value = Type::f64; };
template <> struct TypeOf<std::uint8_t> { static constexpr Type value = Type::u8; };
template <> struct TypeOf<std::byte> { static constexpr Type value = Type::u8; };
template <> struct TypeOf<std::int32_t> { static constexpr Type value = Type::i32; };
template <> struct TypeOf<std::int64_t> { static constexpr Type value = Type::i64; };

std::size_t product(const Shape& shape, std::size_t from = 0);

/// A dataset open for reading or writing. Errors name file and path.
class Dataset {
 public:
  Dataset() = default;
  Dataset(Handle id, Shape shape, std::string label)
      : id_(std::move(id)), shape_(std::move(shape)), label_(std::move(label)) {}
  explicit operator bool() const { return bool(id_); }
  hid_t id() const { return id_.get(); }
  const Shape& shape() const { return shape_; }
  const std::string& label() const { return label_; }
  /// Throws InputError unless the shape is `expected`.
  void expect(const Shape& expected) const;
  /// Throws InputError unless the dataset itself holds values, of a kind that is read (hdf5_internal.hpp): what a child process
  /// has not read (probe.hpp) nobody reads.
  void expect_values() const;
  /// Reads `count` items along the first dimension (all of a scalar if the rank is 0). Throws InputError.
  void read(Type type, std::size_t first, std::size_t count, void* out) const;
  template <class T> std::vector<T> all() const {
    expect_room(sizeof(T));
    std::vector<T> out(product(shape_));
    if (!out.empty()) read(TypeOf<T>::value, 0, shape_.empty() ? 1 : shape_[0], out.data());
    return out;
  }

 private:
  friend class OutputFile;
  void expect_room(std::size_t value_bytes) const;
  Handle id_;
  Shape shape_;
  std::string label_;
};

/// A file open for reading, or a view on an OutputFile for reading back.
class Source {
 public:
  /// Throws InputError: no such file, not HDF5, truncated or damaged.
  explicit Source(const std::filesystem::path& path);
  Source(hid_t borrowed, std::string name) : id_(borrowed), name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  hid_t id() const { return id_; }
  bool has(const std::string& path) const;
  bool has_attribute(const std::string& object, const std::string& name) const;
  /// Throw InputError naming file and object where it is missing.
  Dataset dataset(const std::string& path) const;
  /// Refused where it does not print; `lines`: new lines and tabs pass.
  std::string attribute_text(const std::string& object, const std::string& name, bool lines = false) const;
  std::vector<double> attribute_numbers(const std::string& object, const std::string& name) const;
  double attribute_number(const std::string& object, const std::string& name) const;
  std::vector<std::string> texts(const std::string& path) const;  // a dataset of strings (one if scalar)
  std::vector<std::string> children(const std::string& group) const;  // in order of creation

 private:
  Handle own_;
  hid_t id_ = -1;
  std::string name_;
};

class ChunkPacker;
enum class Packing { plain, deflated };

/// A file being written under a temporary name (PATH.tmp). commit() closes, seals (seal.hpp), fsyncs and renames it and
/// fsyncs the directory; without it the temporary file is removed. Every failure throws RunError naming file and cause; the file
/// is then lost, and nothing else is.
class OutputFile {
 public:
  /// `threads`: for packing series (their bytes do not depend on it).
  explicit OutputFile(std::filesystem::path path, int threads = 1);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void commit();
  /// Throws RunError if anything written so far has failed, which reading back may be the first to notice.
  void verify() const { check(true, ""); }
  /// What was written so far, to read back.
  Source source() const { return Source(file_.get(), temporary_.string()); }

  void group(const std::string& path);
  void attribute(const std::string& object, const std::string& name, const std::string& text);
  void attribute(const std::string& object, const std::string& name, const char* text) {
    attribute(object, name, std::string(text));
  }
  /// ASCII of fixed length, which VTK demands.
  void attribute_ascii(const std::string& object, const std::string& name, const std::string& text);
  void attribute(const std::string& object, const std::string& name, const double* values, const Shape& shape);
  void attribute(const std::string& object, const std::string& name, double value) {
    attribute(object, name, &value, {});
  }
  void attribute(const std::string& object, const std::string& name, const std::vector<std::int64_t>& values,
                 bool scalar = false);

  /// A whole dataset at once.
  void write(const std::string& path, Type type, const Shape& shape, const void* data, const std::string& unit,
             Packing packing);
  template <class T>
  void write(const std::string& path, const std::vector<T>& data, const std::string& unit,
             Packing packing = Packing::deflated) {
    write(path, TypeOf<T>::value, {data.size()}, data.data(), unit, packing);
  }
  void write_text(const std::string& path, const std::string& text);
  void write_texts(const std::string& path, const std::vector<std::string>& texts);

  /// A chunked dataset of `items` items, each of shape `item`; `growing`: items may be added by extend(). Floats that
  /// are never written read as NaN, integers as 0.
  Dataset series(const std::string& path, Type type, const Shape& item, std::size_t items, bool growing,
                 const std::string& unit, Packing packing);
  void extend(Dataset& dataset, std::size_t items);
  void write_items(Dataset& dataset, Type type, std::size_t first, std::size_t count, const void* data);
  /// A dataset of shape `shape` that shows item `index` of the series `path` without holding its values.
  void view_item(const std::string& path, const Dataset& series, const std::string& series_path, Type type,
                 std::size_t index, const Shape& shape, const std::string& unit);

 private:
  void check(bool ok, const std::string& what) const;

  std::filesystem::path path_, temporary_;
  std::shared_ptr<WriteStatus> status_;
  std::unique_ptr<ChunkPacker> packer_;
  Handle file_;
};

/// Items in one chunk of a series: a power of two, 256 KiB and 64 items at most; more than 1 MiB an item: one, split further.
Shape chunk_shape(Type type, const Shape& item, std::size_t items);

}  // namespace pivnp::io::h5

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "pivnp/io/hdf5/hdf5_chunks.hpp"
#include "pivnp/io/hdf5/hdf5_driver.hpp"
#include "pivnp/io/hdf5/hdf5_internal.hpp"

namespace pivnp::io::h5 {

namespace {

// Little-endian on disk, whatever the machine.
hid_t disk_type(Type type) {
  switch (type) {
    case Type::f32: return H5T_IEEE_F32LE;
    case Type::f64: return H5T_IEEE_F64LE;
    case Type::u8: return H5T_STD_U8LE;
    case Type::i32: return H5T_STD_I32LE;
    case Type::i64: return H5T_STD_I64LE;
  }
  return -1;
}

void set_fill(hid_t properties, Type type) {
  if (type == Type::f32 || type == Type::f64) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &nan);
  }
}

Handle dataset_properties() {
  Handle p(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(p.get(), false);  // equal runs give equal files
  return p;
}

void set_chunks(hid_t properties, const Shape& chunk, Packing packing) {
  H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
  if (packing == Packing::deflated) {
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, 1);
  }
}

constexpr std::size_t small_bytes = std::size_t{1} << 18, large_bytes = std::size_t{1} << 20;

}  // namespace

Shape chunk_shape(Type type, const Shape& item, std::size_t items) {
  const std::size_t bytes = std::max<std::size_t>(1, size_of(type) * product(item));
  const std::size_t most = std::clamp<std::size_t>(items, 1, 64);
  Shape chunk{std::min(most, std::bit_floor(std::max<std::size_t>(1, small_bytes / bytes)))};
  for (const hsize_t n : item) chunk.push_back(std::max<hsize_t>(1, n));
  if (bytes > large_bytes && item.size() > 0) {
    const std::size_t pieces = (bytes + large_bytes - 1) / large_bytes;
    chunk[1] = std::max<std::size_t>(1, (item[0] + pieces - 1) / pieces);
  }
  return chunk;
}

OutputFile::OutputFile(std::filesystem::path path, int threads)
    : path_(std::move(path)),
      temporary_(path_.string() + ".tmp"),
      status_(std::make_shared<WriteStatus>()),
      packer_(std::make_unique<ChunkPacker>(threads)) {
  silence();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), create(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_link_creation_order(create.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
#if H5_VERSION_GE(1, 10, 7)
  H5Pset_file_locking(access.get(), false, true);  // .lock is ours
#endif
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  check(use_checked_driver(access.get(), status_.get()), "setting up the driver");
  file_ = Handle(H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, create.get(), access.get()), H5Fclose);
  if (!file_) {
    const int error = status_->error;
    ::unlink(temporary_.c_str());
    throw RunError(error ? write_failure(temporary_, error) : temporary_.string() + ": HDF5: " + last_cause());
  }
}

OutputFile::~OutputFile() {
  if (!file_) return;
  if (status_->error == 0) status_->error = -1;  // not wanted any more: nothing of it need reach the disk
  file_.reset();
  ::unlink(temporary_.c_str());
}

void OutputFile::check(bool ok, const std::string& what) const {
  if (status_->error > 0) throw RunError(write_failure(temporary_, status_->error));
  if (!ok) throw RunError(temporary_.string() + ": HDF5: " + what + ": " + last_cause());
}

void OutputFile::commit() {
  check(true, "");
  const herr_t closed = H5Fclose(file_.get());
  const std::string cause = closed < 0 ? last_cause() : "";
  // Handles of datasets keep a file open under HDF5: the caller must have let go of them.
  file_ = Handle();
  if (closed >= 0 && status_->error == 0) status_->error = append_seal(temporary_);
  if (closed < 0 || status_->error != 0) {
    ::unlink(temporary_.c_str());
    throw RunError(status_->error > 0 ? write_failure(temporary_, status_->error)
                                      : temporary_.string() + ": HDF5: closing: " + cause);
  }
  rename_file(temporary_, path_);
}

void OutputFile::group(const std::string& path) {
  const Handle create(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_link_creation_order(create.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const Handle id(H5Gcreate2(file_.get(), path.c_str(), H5P_DEFAULT, create.get(), H5P_DEFAULT), H5Gclose);
  check(bool(id), "group " + path);
}

void OutputFile::attribute(const std::string& object, const std::string& name, const std::string& text) {
  const Handle type = text_type(), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle id(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), type.get(), space.get(), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* raw = text.c_str();
  check(id && H5Awrite(id.get(), type.get(), &raw) >= 0, "attribute " + object + "@" + name);
}

void OutputFile::attribute_ascii(const std::string& object, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type.get(), text.size());
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  const Handle id(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), type.get(), space.get(), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(id && H5Awrite(id.get(), type.get(), text.data()) >= 0, "attribute " + object + "@" + name);
}

void OutputFile::attribute(const std::string& object, const std::string& name, const double* values,
                           const Shape& shape) {
  const Handle space(shape.empty() ? H5Screate(H5S_SCALAR)
                                   : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle id(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(id && H5Awrite(id.get(), H5T_NATIVE_DOUBLE, values) >= 0, "attribute " + object + "@" + name);
}

void OutputFile::attribute(const std::string& object, const std::string& name, const std::vector<std::int64_t>& values,
                           bool scalar) {
  const hsize_t count = values.size();
  const Handle space(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle id(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), H5T_STD_I64LE, space.get(), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(id && H5Awrite(id.get(), H5T_NATIVE_INT64, values.data()) >= 0, "attribute " + object + "@" + name);
}

void OutputFile::write(const std::string& path, Type type, const Shape& shape, const void* data,
                       const std::string& unit, Packing packing) {
  const Handle space(shape.empty() ? H5Screate(H5S_SCALAR)
                                   : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle properties = dataset_properties();
  // Packing pays from a few kilobytes on.
  if (!shape.empty() && packing == Packing::deflated && product(shape) * size_of(type) > 4096) {
    Shape chunk = shape;
    const std::size_t row = product(shape, 1) * size_of(type);
    chunk[0] = std::clamp<std::size_t>(large_bytes / std::max<std::size_t>(1, row), 1, shape[0]);
    set_chunks(properties.get(), chunk, packing);
  }
  const Handle id(H5Dcreate2(file_.get(), path.c_str(), disk_type(type), space.get(), H5P_DEFAULT, properties.get(),
                             H5P_DEFAULT), H5Dclose);
  check(bool(id), path);
  if (product(shape) > 0) {
    std::size_t first = 0, packed = shape.empty() ? 0 : shape[0];
    check(packer_->write(id.get(), shape, type, data, first, packed) &&
              (packed > 0 || H5Dwrite(id.get(), memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0),
          path);
  }
  attribute(path, "unit", unit);
}

void OutputFile::write_text(const std::string& path, const std::string& text) {
  const Handle type = text_type(), space(H5Screate(H5S_SCALAR), H5Sclose), properties = dataset_properties();
  const Handle id(
      H5Dcreate2(file_.get(), path.c_str(), type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  const char* raw = text.c_str();
  check(id && H5Dwrite(id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &raw) >= 0, path);
  attribute(path, "unit", "");
}

void OutputFile::write_texts(const std::string& path, const std::vector<std::string>& texts) {
  const hsize_t count = texts.size();
  const Handle type = text_type(), space(H5Screate_simple(1, &count, nullptr), H5Sclose),
               properties = dataset_properties();
  const Handle id(
      H5Dcreate2(file_.get(), path.c_str(), type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  std::vector<const char*> raw;
  for (const std::string& t : texts) raw.push_back(t.c_str());
  check(id && (raw.empty() || H5Dwrite(id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, raw.data()) >= 0), path);
  attribute(path, "unit", "");
}

Dataset OutputFile::series(const std::string& path, Type type, const Shape& item, std::size_t items, bool growing,
                           const std::string& unit, Packing packing) {
  Shape shape{items};
  shape.insert(shape.end(), item.begin(), item.end());
  Shape most = shape;
  if (growing) most[0] = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), most.data()), H5Sclose);
  const Handle properties = dataset_properties();
  set_fill(properties.get(), type);
  if (growing || product(shape) > 0)
    set_chunks(properties.get(), chunk_shape(type, item, growing ? 64 : items), packing);
  Handle id(
      H5Dcreate2(file_.get(), path.c_str(), disk_type(type), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  check(bool(id), path);
  attribute(path, "unit", unit);
  return Dataset(std::move(id), shape, temporary_.string() + ": " + path);
}

void OutputFile::extend(Dataset& dataset, std::size_t items) {
  dataset.shape_[0] = items;
  check(H5Dset_extent(dataset.id(), dataset.shape_.data()) >= 0, dataset.label());
}

void OutputFile::write_items(Dataset& dataset, Type type, std::size_t first, std::size_t count, const void* data) {
  if (count == 0 || product(dataset.shape_) == 0) return;
  const std::size_t item_bytes = product(dataset.shape_, 1) * size_of(type);
  const auto plainly = [&](std::size_t from, std::size_t items) {
    if (items == 0) return;
    Shape start(dataset.shape_.size(), 0), extent = dataset.shape_;
    start[0] = from;
    extent[0] = items;
    const Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
    const void* own = static_cast<const std::byte*>(data) + (from - first) * item_bytes;
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr) >= 0 &&
              H5Dwrite(dataset.id(), memory_type(type), memory.get(), space.get(), H5P_DEFAULT, own) >= 0,
          dataset.label());
  };
  std::size_t begin = first, packed = count;
  check(packer_->write(dataset.id(), dataset.shape_, type, data, begin, packed), dataset.label());
  if (packed == 0) return plainly(first, count);
  plainly(first, begin - first);
  plainly(begin + packed, first + count - begin - packed);
}

void OutputFile::view_item(const std::string& path, const Dataset& series, const std::string& series_path, Type type,
                           std::size_t index, const Shape& shape, const std::string& unit) {
  Shape start(series.shape().size(), 0), extent = series.shape();
  start[0] = index;
  extent[0] = 1;
  const Handle from(H5Screate_simple(static_cast<int>(extent.size()), series.shape().data(), nullptr), H5Sclose);
  const Handle to(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle properties = dataset_properties();
  set_fill(properties.get(), type);
  H5Sselect_hyperslab(from.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
  H5Pset_virtual(properties.get(), to.get(), ".", series_path.c_str(), from.get());
  const Handle id(H5Dcreate2(file_.get(), path.c_str(), disk_type(type), to.get(), H5P_DEFAULT, properties.get(),
                             H5P_DEFAULT), H5Dclose);
  check(bool(id), path);
  attribute(path, "unit", unit);
}

}  // namespace pivnp::io::h5

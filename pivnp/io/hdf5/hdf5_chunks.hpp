// Whole chunks packed by several threads. Private to this folder's sources.
#pragma once

#include <memory>

#include "pivnp/io/hdf5/hdf5.hpp"

namespace pivnp::io::h5 {

/// Shuffles and deflates chunks (libdeflate, level 1) on `threads` threads and hands them to HDF5 packed
/// (H5Dwrite_chunk), in order: HDF5's own filters use one thread and zlib. The file's format, and what readers need, are
/// the same; its bytes do not depend on the number of threads.
class ChunkPacker {
 public:
  explicit ChunkPacker(int threads);
  ~ChunkPacker();

  /// Writes those of the items [first, first + count) that fill whole chunks along the first dimension (its last chunk
  /// may be shorter). `first` and `count` become what was written: count 0 if nothing was, since the dataset is not
  /// shuffled and deflated in chunks or no chunk is filled. `data`: items from the given `first` on, as on disk.
  /// Returns false if HDF5 or libdeflate failed.
  bool write(hid_t dataset, const Shape& shape, Type type, const void* data, std::size_t& first, std::size_t& count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::io::h5

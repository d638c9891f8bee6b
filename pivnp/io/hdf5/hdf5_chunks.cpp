#include "pivnp/io/hdf5/hdf5_chunks.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace pivnp::io::h5 {

namespace {

struct FreeCompressor {
  void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
};

// Bytes of equal significance together, as H5Z_filter_shuffle has them.
template <std::size_t size>
void shuffle(const std::byte* in, std::size_t values, std::byte* out) {
  for (std::size_t b = 0; b < size; ++b)
    for (std::size_t k = 0; k < values; ++k) out[b * values + k] = in[k * size + b];
}

// What is never written reads as this (OutputFile::series).
void fill(Type type, std::vector<std::byte>& bytes) {
  const auto with = [&](auto value) {
    for (std::size_t k = 0; k + sizeof(value) <= bytes.size(); k += sizeof(value))
      std::memcpy(bytes.data() + k, &value, sizeof(value));
  };
  if (type == Type::f32)
    with(std::numeric_limits<float>::quiet_NaN());
  else if (type == Type::f64)
    with(std::numeric_limits<double>::quiet_NaN());
  else
    std::fill(bytes.begin(), bytes.end(), std::byte{0});
}

// The dataset's chunk; empty if it is not one of shuffled and deflated chunks.
Shape packed_chunk(hid_t dataset, std::size_t rank) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (!properties || H5Pget_layout(properties.get()) != H5D_CHUNKED || H5Pget_nfilters(properties.get()) != 2) return {};
  const auto filter = [&](unsigned n) {
    unsigned flags = 0;
    std::size_t values = 0;
    return H5Pget_filter2(properties.get(), n, &flags, &values, nullptr, 0, nullptr, nullptr);
  };
  if (filter(0) != H5Z_FILTER_SHUFFLE || filter(1) != H5Z_FILTER_DEFLATE) return {};
  Shape chunk(rank);
  return H5Pget_chunk(properties.get(), static_cast<int>(rank), chunk.data()) == static_cast<int>(rank) ? chunk : Shape{};
}

}  // namespace

struct ChunkPacker::Impl {
  struct Slot {
    std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor{libdeflate_alloc_compressor(1)};
    std::vector<std::byte> plain, shuffled, packed;
    std::size_t size = 0;  // of `packed`; 0: failed
  };

  void pack(Slot& slot, Type type) const;

  int threads;
  std::vector<Slot> slots;  // a chunk each
};

void ChunkPacker::Impl::pack(Slot& slot, Type type) const {
  const std::size_t size = size_of(type), values = slot.plain.size() / size;
  const std::byte* source = slot.plain.data();
  if (size > 1) {
    slot.shuffled.resize(slot.plain.size());
    (size == 4 ? shuffle<4> : shuffle<8>)(source, values, slot.shuffled.data());
    source = slot.shuffled.data();
  }
  slot.packed.resize(libdeflate_zlib_compress_bound(slot.compressor.get(), slot.plain.size()));
  slot.size = libdeflate_zlib_compress(slot.compressor.get(), source, slot.plain.size(), slot.packed.data(),
                                       slot.packed.size());
}

ChunkPacker::ChunkPacker(int threads) : impl_(std::make_unique<Impl>()) { impl_->threads = std::max(1, threads); }
ChunkPacker::~ChunkPacker() = default;

bool ChunkPacker::write(hid_t dataset, const Shape& shape, Type type, const void* data, std::size_t& first,
                        std::size_t& count) {
  const std::size_t given = first, end = first + count;
  count = 0;
  if (std::endian::native != std::endian::little || shape.empty()) return true;
  const Shape chunk = packed_chunk(dataset, shape.size());
  if (chunk.empty()) return true;
  const std::size_t begin = (first + chunk[0] - 1) / chunk[0] * chunk[0];
  const std::size_t last = end == shape[0] ? end : end / chunk[0] * chunk[0];
  if (begin >= last) return true;
  first = begin, count = last - begin;

  // An item is rows of values; only items and their rows are split among chunks.
  const std::size_t rows = shape.size() > 1 ? shape[1] : 1, chunk_rows = shape.size() > 1 ? chunk[1] : 1,
                    row_bytes = (shape.size() > 2 ? product(shape, 2) : 1) * size_of(type);
  const std::size_t across = (rows + chunk_rows - 1) / chunk_rows, down = (count + chunk[0] - 1) / chunk[0];
  const std::size_t chunks = across * down, batch = std::size_t(impl_->threads) * 4;
  impl_->slots.resize(std::max(impl_->slots.size(), std::min(batch, chunks)));
  const auto* bytes = static_cast<const std::byte*>(data);
  for (std::size_t start = 0; start < chunks; start += batch) {
    const int now = static_cast<int>(std::min(batch, chunks - start));
#pragma omp parallel for num_threads(impl_->threads) schedule(dynamic)
    for (int k = 0; k < now; ++k) {
      Impl::Slot& slot = impl_->slots[std::size_t(k)];
      const std::size_t item = begin + (start + std::size_t(k)) / across * chunk[0],
                        row = (start + std::size_t(k)) % across * chunk_rows;
      const std::size_t items = std::min<std::size_t>(chunk[0], last - item), some = std::min(chunk_rows, rows - row);
      slot.plain.resize(chunk[0] * chunk_rows * row_bytes);
      if (items < chunk[0] || some < chunk_rows) fill(type, slot.plain);
      for (std::size_t n = 0; n < items; ++n)
        std::memcpy(slot.plain.data() + n * chunk_rows * row_bytes, bytes + ((item + n - given) * rows + row) * row_bytes,
                    some * row_bytes);
      impl_->pack(slot, type);
    }
    for (int k = 0; k < now; ++k) {
      const Impl::Slot& slot = impl_->slots[std::size_t(k)];
      Shape place(shape.size(), 0);
      place[0] = begin + (start + std::size_t(k)) / across * chunk[0];
      if (shape.size() > 1) place[1] = (start + std::size_t(k)) % across * chunk_rows;
      if (slot.size == 0 || H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, place.data(), slot.size, slot.packed.data()) < 0)
        return false;
    }
  }
  return true;
}

}  // namespace pivnp::io::h5

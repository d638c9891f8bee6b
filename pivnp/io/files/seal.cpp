#include "pivnp/io/files/seal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/hash.hpp"
#include "pivnp/io/files/files.hpp"

namespace pivnp::io {

namespace {

using Bytes = std::array<unsigned char, seal_bytes>;

Bytes seal_for(std::uint64_t hash) {
  Bytes bytes{};
  std::memcpy(bytes.data(), seal_letters, 8);
  for (std::size_t k = 0; k < 8; ++k) bytes[8 + k] = static_cast<unsigned char>(hash >> (8 * k));
  return bytes;
}

// The end of the file that HDF5's superblock states (HDF5 File Format Specification 3.0, II.A; addresses of 8 bytes); 0
// if it is not one of HDF5's.
std::uint64_t stated_end(int descriptor) {
  std::array<unsigned char, 64> block{};
  if (::pread(descriptor, block.data(), block.size(), 0) != static_cast<ssize_t>(block.size()) ||
      std::memcmp(block.data(), "\x89HDF\r\n\x1a\n", 8) != 0)
    return 0;
  const std::size_t at = block[8] == 0 ? 40 : block[8] == 1 ? 44 : 28;  // by the superblock's version
  std::uint64_t end = 0;
  for (std::size_t k = 8; k-- > 0;) end = end << 8 | block[at + k];
  return end;
}

// Of the first `size` bytes; nothing if they cannot be read (errno says why).
std::optional<std::uint64_t> hash_of(int descriptor, off_t size) {
  Hash64 hash;
  std::vector<unsigned char> block(std::size_t{1} << 20);
  for (off_t at = 0; at < size;) {
    const auto wanted = static_cast<std::size_t>(std::min<off_t>(size - at, static_cast<off_t>(block.size())));
    const ssize_t got = ::pread(descriptor, block.data(), wanted, at);
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = EIO;
    if (got <= 0) return std::nullopt;
    hash.add(block.data(), static_cast<std::size_t>(got));
    at += got;
  }
  return hash.value();
}

}  // namespace

Seal seal_of(const std::filesystem::path& file) {
  const Descriptor d{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};  // a pipe would wait for its writer
  const auto unreadable = [&] { return RunError(file.string() + ": cannot be read: " + std::strerror(errno)); };
  if (d.value < 0) throw unreadable();
  const off_t size = ::lseek(d.value, 0, SEEK_END) - static_cast<off_t>(seal_bytes);
  Bytes there{};
  if (size < 0 || ::pread(d.value, there.data(), there.size(), size) != static_cast<ssize_t>(there.size())) return Seal::none;
  const std::uint64_t end = stated_end(d.value), least = static_cast<std::uint64_t>(size);
  if (std::memcmp(there.data(), seal_letters, 8) != 0)  // HDF5's part ends where it ends before a seal, or in what is left of one
    return end > 0 && end >= least && end < least + seal_bytes ? Seal::broken : Seal::none;
  if (end > least) return Seal::none;
  const auto hash = hash_of(d.value, size);
  if (!hash) throw unreadable();
  return seal_for(*hash) == there ? Seal::intact : Seal::broken;
}

int append_seal(const std::filesystem::path& file) {
  const Descriptor d{::open(file.c_str(), O_RDWR | O_CLOEXEC)};
  if (d.value < 0) return errno;
  const off_t size = ::lseek(d.value, 0, SEEK_END);
  const auto hash = size < 0 ? std::nullopt : hash_of(d.value, size);
  if (!hash) return errno;
  const Bytes seal = seal_for(*hash);
  for (std::size_t done = 0; done < seal.size();) {
    const ssize_t put = ::pwrite(d.value, seal.data() + done, seal.size() - done, size + static_cast<off_t>(done));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno;
    done += static_cast<std::size_t>(put);
  }
  return ::fsync(d.value) == 0 ? 0 : errno;
}

}  // namespace pivnp::io

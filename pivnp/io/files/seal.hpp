// A checksum at the end of an HDF5 file that is never changed once it is closed. HDF5 does not see it: its files may be
// longer than what they hold. Private to this folder's sources.
#pragma once

#include <filesystem>

namespace pivnp::io {

/// Eight letters and XXH64 of all bytes before them, little-endian: the last 16 bytes of a sealed file.
inline constexpr char seal_letters[] = "pivnpsum";
inline constexpr std::size_t seal_bytes = 16;

/// none: no seal, or HDF5 opened the file for writing since. It then takes the seal for a part of its own (the end that
/// the superblock states is that of the file), and somebody has changed the file who may. broken: the content is not what
/// the seal was made of, or up to 16 bytes that are no seal follow HDF5's part.
enum class Seal { none, intact, broken };

/// Reads the whole file. Throws RunError if it cannot be read: that is no damage.
Seal seal_of(const std::filesystem::path& file);

/// Appends the seal and fsyncs. Returns errno, 0 if all went well.
int append_seal(const std::filesystem::path& file);

}  // namespace pivnp::io

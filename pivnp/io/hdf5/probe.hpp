// A look at HDF5 files that nobody vouches for. Private to this folder's sources.
#pragma once

#include <filesystem>

namespace pivnp::io {

/// Reads all of an HDF5 file in a child process: damaged metadata makes the library crash, hang or ask for any amount
/// of memory, which must not happen to the program itself. The child may take 2 GiB and four times the file's size.
/// Throws InputError of one line that names the file: not to be read, beyond its limits, values or links in another file
/// (virtual and external datasets, external links), or the child's end by a signal. Files that are none of HDF5's pass:
/// whoever opens them says so.
void probe_foreign_file(const std::filesystem::path& file);

}  // namespace pivnp::io

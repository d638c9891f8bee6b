// A look at HDF5 files that this process did not write. Private to this folder's sources.
#pragma once

#include <filesystem>
#include <vector>

namespace pivnp::io {

/// Reads all of an HDF5 file in a child process, sealed or not: a seal finds damage, and anyone can make one. Damaged or
/// hostile metadata makes the library crash, hang or ask for any amount of memory, which must not happen to the program
/// itself. The child may take 2 GiB and four times the file's size. Throws InputError of one line that names the file:
/// not to be read, beyond its limits, the child's end by a signal, or anything that is not on the list of what records are
/// made of: hard and soft links; values in this file (virtual datasets that show it may stand there, but are not read);
/// the filters deflate, shuffle and fletcher32; numbers and text as h5::reads() has them. Files that are none of HDF5's
/// pass: whoever opens them says so.
void probe_file(const std::filesystem::path& file);
/// All of them in one child; what is thrown names their folder where there are several.
void probe_files(std::vector<std::filesystem::path> files);

}  // namespace pivnp::io

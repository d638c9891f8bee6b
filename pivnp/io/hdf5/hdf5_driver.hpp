// How the record's files reach the disk. Private to this folder's sources.
#pragma once

#include <hdf5.h>

#include "pivnp/io/files/files.hpp"

namespace pivnp::io::h5 {

/// Lets files made with `access` be written by our own driver. HDF5's own leaves a file that cannot be written (full
/// disk) open for good and hides the cause in a stack of messages. Ours notes the first error in `status`, which must
/// outlive the file, then lets HDF5 go on as if nothing had happened, so that it closes cleanly; the caller looks at
/// `status` after each step. The file is fsynced when it is closed. Returns false if HDF5 refuses.
bool use_checked_driver(hid_t access, WriteStatus* status);

}  // namespace pivnp::io::h5

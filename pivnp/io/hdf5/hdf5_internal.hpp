// What the sources hdf5*.cpp share.
#pragma once

#include <string>

#include "pivnp/io/hdf5/hdf5.hpp"

namespace pivnp::io::h5 {

hid_t memory_type(Type type);
/// Whether values of this kind are read at all: integers of 1, 2, 4 or 8 whole bytes, IEEE floats of 4 or 8, enumerations
/// of such integers, text, and tables (compounds) of such numbers.
bool reads(hid_t type);
/// Variable-length UTF-8.
Handle text_type();
/// Switches off HDF5's printing of errors to stderr.
void silence();
/// What the innermost entry of HDF5's error stack says.
std::string last_cause();

}  // namespace pivnp::io::h5

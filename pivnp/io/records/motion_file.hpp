// A motion read frame by frame from an open file. Private to this folder's sources.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pivnp/io/records/schema.hpp"

namespace pivnp::io {

/// Reads /motion/NAME of `source`; `keep` is whatever must live as long (the reader's file).
std::unique_ptr<MotionSource> open_motion(const h5::Source& source, const std::string& name, const Units& units,
                                          std::shared_ptr<const void> keep);

}  // namespace pivnp::io

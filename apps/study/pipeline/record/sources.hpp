// The files a run reads beside its case.
#pragma once

#include <vector>

#include "apps/case/case.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/io/files/file_identity.hpp"
#include "pivnp/io/imports/import_vectors.hpp"

namespace pivnp::app {

/// Names, sizes and content of the files of the frames (`source`, which may be nullptr), of the masks and of other
/// programs' vectors (likewise), in this order; all are read once. Throws InputError where one cannot be read,
/// Interrupted.
std::vector<io::FileIdentity> sources_of(const Case& c, const image::FrameSource* source, const io::VectorFiles* vectors,
                                         Progress& progress);

}  // namespace pivnp::app

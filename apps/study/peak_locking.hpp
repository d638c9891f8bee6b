// What frames and vectors say about peak locking, as remarks.
#pragma once

#include <string>
#include <vector>

#include "apps/study/scene.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

/// One sentence if the texture of a frame is too fine for its pixels; else none.
std::vector<std::string> texture_remarks(const Setting& setting, const Image& frame);

/// One sentence if displacements are drawn toward whole pixels, judged on at most 16 pairs spread over the record; else
/// none.
std::vector<std::string> fraction_remarks(const Setting& setting, const io::RecordWriter& writer, std::size_t pairs);

}  // namespace pivnp::app

// What frames and vectors say about peak locking and compression, as remarks.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/record/vectors.hpp"

namespace pivnp::app {

/// A sentence if the texture of a frame is too fine for its pixels, and one if the blocks of its compression show.
std::vector<std::string> texture_remarks(const Setting& setting, const Image& frame);

/// One sentence if displacements are drawn towards whole pixels, judged on at most 16 of the `pairs` that `pair` reads
/// (in the world, at the setting's nodes); else none.
std::vector<std::string> fraction_remarks(const Setting& setting, std::size_t pairs,
                                          const std::function<VectorField(std::size_t)>& pair);

}  // namespace pivnp::app

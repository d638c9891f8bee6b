// What frames and vectors say about peak locking and compression, as remarks.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

/// A sentence if the texture of a frame is too fine for its pixels, and one if its compression shows.
/// `file`: what the frame is read from, if it is a file of its own.
std::vector<std::string> texture_remarks(const Setting& setting, const Image& frame,
                                         const std::filesystem::path& file = {});

/// The file of the first frame; empty where frames have no file of their own.
inline std::filesystem::path file_of_first(const image::FrameSource& source) {
  const auto files = source.files();
  return files.size() == source.frames().size() ? files.front() : std::filesystem::path();
}

/// One sentence if displacements are drawn towards whole pixels, judged on at most 16 of the `pairs` that `pair` reads
/// (in the world, at the setting's nodes); else none.
std::vector<std::string> fraction_remarks(const Setting& setting, std::size_t pairs,
                                          const std::function<VectorField(std::size_t)>& pair);

/// One sentence if the frames are interlaced: `frame` is the first one of the pair that `field` was measured in.
std::vector<std::string> interlace_remarks(const Setting& setting, const Image& frame, const VectorField& field);

}  // namespace pivnp::app

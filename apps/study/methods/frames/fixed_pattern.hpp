// Texture that stands still in front of material that moves: dirt, scratches and reflections on the glass.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/methods/frames/repeated_cause.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

/// The fixed pattern of a sequence, floating grey values about 0, of the frames' size. It is the median of up to
/// `most` frames, freed of light (a blur of 32 px). Nothing is kept where the first and the last of them agree as they stand
/// (correlation above .85 in Gaussian windows of 16 px): what moves nowhere is material at rest.
Image pattern_on_glass(image::FrameSource& source, int most);

/// The same where the material about has moved on by more than 8 px over the sequence, by the vectors that `fast` finds in six pairs
/// of the frames without the pattern. With a camera that moves, or fewer than eight frames, all of it.
Image pattern_over_motion(const Case& c, const Setting& setting, image::FrameSource& source, int most, int threads, Progress& progress);

/// How far pictures agree where material has moved on by more than its grains' size: over up to four pairs of frames, as far
/// apart as the sequence is long, amid nodes whose vectors (`pair`) add up to more than 6 px.
StillPicture fixed_texture(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair);

/// A sentence where such texture is seen and nothing takes it out.
std::vector<std::string> pattern_remarks(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair);

}  // namespace pivnp::app

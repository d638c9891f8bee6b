// Texture that stands still in front of material that moves: dirt, scratches and reflections on the glass.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/methods/repeated_cause.hpp"
#include "pivnp/image/frames.hpp"

namespace pivnp::app {

/// The fixed pattern of a sequence, floating grey values about 0, of the frames' size. The means of the two halves of up to
/// `most` frames are freed of light (a blur of 32 px); of their mean m is kept, in windows of 16 px, the share that both
/// have in common: common / |m|^2, the filter of Wiener (1949) where the rest of each half is independent. Nothing is kept where
/// two frames half a sequence apart agree as they stand (correlation above .7): what moves nowhere is material at rest.
Image pattern_on_glass(image::FrameSource& source, int most);

/// How far pictures agree where material has moved on by more than its grains' size: over up to four pairs of frames, as far
/// apart as the sequence is long, at nodes whose vectors (`pair`) add up to more than 6 px.
StillPicture fixed_texture(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair);

/// A sentence where such texture is seen and nothing takes it out.
std::vector<std::string> pattern_remarks(const Setting& setting, image::FrameSource& source, const std::function<VectorField(std::size_t)>& pair);

}  // namespace pivnp::app

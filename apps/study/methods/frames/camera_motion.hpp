// How the camera moved while it filmed, from what is at rest.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

/// Subsets of the first frame that are at rest, or are taken to be: in [camera.motion] zone_*, at targets_px, or (dominant)
/// over the whole image outside regions and masks. Every frame is held directly against the first, so that no error adds
/// up: subsets are searched about where the frame before has them, matched to subpixels, and the motion that most of them
/// share is the camera's (pivnp/image/camera/similarity.hpp). A frame in which too few are found keeps the place of the frame
/// before (points = 0 there). Empty if camera.motion.from is none. Throws InputError: no zone, targets or texture, a
/// target at the image's edge.
CameraMotion find_camera_motion(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                                Progress& progress);

/// Finds where the tools of [mask.NAME] with `follow` are in every frame, from the texture within their outlines: each frame
/// is held against the first, as that of the camera is, with shift and rotation. Throws InputError: a tool without texture,
/// or a sequence of mask images of another length than the frames.
void follow_masks(const Case& c, Setting& setting, image::FrameSource& source, int threads, Progress& progress);

/// What the camera's motion came to, and where what should be at rest is not: one sentence each.
std::vector<Remark> camera_motion_remarks(const Case& c, const CameraMotion& motion, const std::vector<Frame>& frames);

/// Without [camera.motion]: whether np.still_zone_* moves in the vectors themselves, which says that the camera did.
/// `pair`: of frames k and k + 1.
std::vector<std::string> still_zone_remarks(const Case& c, const Setting& setting, std::size_t pairs,
                                            const std::function<VectorField(std::size_t)>& pair);

}  // namespace pivnp::app

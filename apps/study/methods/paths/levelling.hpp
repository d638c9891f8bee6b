// Comparing like with like: what would have been measured, had the material moved as simulated.
#pragma once

#include <memory>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "compare/compare.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// Frames that carry the first frame's texture by `motion`. The first frame is freed of noise, and every frame receives noise of its own
/// (methods/texture.hpp). A pixel shows the place where its material was at the first frame, by the triangles of the particles' present places;
/// pixels outside the material keep what they show in the first frame, or the background's median grey where
/// that was material. Frames later than the motion's last time are left out.
std::unique_ptr<image::FrameSource> carried_frames(const Image& first, const std::vector<Frame>& frames, bool has_rate,
                                                   const image::Camera& camera, const MotionSource& motion,
                                                   double noise, std::uint64_t seed);

/// Measures the simulation as the experiment was measured (record OUT/levelled), compares it with the measurement, and
/// adds the metrics of displacement, velocity and strain to `comparison` under names that begin with "levelled_".
void add_levelled(const Case& c, const Setting& setting, const RunSettings& settings, image::FrameSource& source,
                  const std::vector<Frame>& frames, const io::RecordWriter& writer, const MotionSource& measured,
                  const MotionSource& simulated, const StrainNote& note, const compare::CompareOptions& options,
                  Comparison& comparison, Progress& progress);

}  // namespace pivnp::app

// Vectors of one pair of frames by the present settings.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "apps/case/case.hpp"
#include "apps/view/model/frames.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/image/camera/camera.hpp"

namespace pivnp::view {

/// A rectangle of the image, px.
struct PixelBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};

struct LivePair {
  VectorField field;
  image::Camera camera;
  double spacing_px = 0;
  bool part = false;  // of the visible part only
  double seconds = 0;
};

/// Measures the pair that begins with `frame` (of double frames: the one that it belongs to) as a run would, with the camera and followed tools at rest. The
/// visible part comes first where it is less than half of the image, then the whole; each is handed to `done`. Between them
/// `stop` is asked. Throws InputError as a run does, with the key's place.
void measure_live(const app::Case& c, SharedFrames& frames, int frame, const std::optional<PixelBox>& visible, int threads,
                  const std::function<bool()>& stop, const std::function<void(LivePair)>& done);

/// column, row, x, y, displacement, standard uncertainty, status and score of each vector, as CSV with units.
std::string csv_of(const LivePair& pair);

}  // namespace pivnp::view

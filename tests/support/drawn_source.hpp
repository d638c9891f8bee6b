// What all sources of frames that tests draw have in common: size, names, times.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pivnp/image/frames/frames.hpp"

namespace pivnp::test {

class DrawnSource : public image::FrameSource {
 public:
  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return true; }
  int width() const override { return width_; }
  int height() const override { return height_; }

 protected:
  /// Frames "frame 0", "frame 1" ... at this rate.
  DrawnSource(int width, int height, int count, double rate_hz) : width_(width), height_(height) {
    for (int k = 0; k < count; ++k) frames_.push_back({"frame " + std::to_string(k), k / rate_hz, frame_ok});
  }

 private:
  int width_, height_;
  std::vector<Frame> frames_;
};

}  // namespace pivnp::test

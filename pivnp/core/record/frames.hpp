// What a record holds of the frames.
#pragma once

#include <cstdint>
#include <string>

namespace pivnp {

/// Bits of Frame::flag: doubts about the step from the frame before to this one.
enum FrameFlag : std::uint8_t {
  frame_ok = 0,
  frame_decorrelated = 1,  // the pair that ends here lost its correlation over most of the image
  frame_repeated = 2,      // this exposure repeats the frame before
  frame_jump = 4,          // moves out of line with the steps before and after: a frame missing, or a shock
  frame_flash = 8,         // brighter or darker than the frames before and after: a flash, a lamp that fails
};

struct Frame {
  std::string name;        // file name, or "video.mp4#17"
  double time = 0;         // time unit of the record (s; frames without a rate)
  std::uint8_t flag = frame_ok;
};

}  // namespace pivnp

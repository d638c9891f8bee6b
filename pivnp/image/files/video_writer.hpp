// A video out.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace pivnp::image {

/// MP4: H.264 where OpenCV has an encoder of it, else MPEG-4 part 2. Written under a temporary name, which finish() gives its own; without
/// it nothing is left.
class VideoWriter {
 public:
  VideoWriter(std::filesystem::path file, double frames_a_second);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// A picture as PNG bytes; all of one size (odd sizes lose their last row or column: the format wants even ones). Throws
  /// RunError naming the file where it cannot be written, or where this OpenCV writes no MP4.
  void add_png(const std::string& png);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::image

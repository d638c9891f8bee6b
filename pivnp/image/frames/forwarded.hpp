// A source that stands before another one and answers as it does, but for how it is read.
#pragma once

#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "pivnp/image/frames/frames.hpp"

namespace pivnp::image {

class ForwardedFrames : public FrameSource {
 public:
  explicit ForwardedFrames(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

  const std::vector<Frame>& frames() const override { return source_->frames(); }
  bool has_rate() const override { return source_->has_rate(); }
  int width() const override { return source_->width(); }
  int height() const override { return source_->height(); }
  std::vector<std::filesystem::path> files() const override { return source_->files(); }
  std::vector<Remark> remarks() const override { return source_->remarks(); }

 protected:
  std::unique_ptr<FrameSource> source_;
};

}  // namespace pivnp::image

// Frames that several threads read: one source behind a lock, and those read last.
#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

#include "pivnp/image/frames/frames.hpp"

namespace pivnp::view {

class SharedFrames final : public image::FrameSource {
 public:
  explicit SharedFrames(std::unique_ptr<image::FrameSource> source) : source_(std::move(source)) {}

  const std::vector<Frame>& frames() const override { return source_->frames(); }
  bool has_rate() const override { return source_->has_rate(); }
  int width() const override { return source_->width(); }
  int height() const override { return source_->height(); }
  std::vector<std::filesystem::path> files() const override { return source_->files(); }
  std::vector<Remark> remarks() const override { return source_->remarks(); }
  /// From any thread.
  Image read(int index) override;
  /// The same, kept as long as there is room (256 MiB), for who comes back to it.
  std::shared_ptr<const Image> shared(int index);

 private:
  std::mutex mutex_;
  std::unique_ptr<image::FrameSource> source_;
  std::list<std::pair<int, std::shared_ptr<const Image>>> kept_;  // the last one used first
};

/// A grey value at a pixel, as stored.
double grey_at(const ImageView& image, int column, int row);

}  // namespace pivnp::view

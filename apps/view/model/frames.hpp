// Frames that several threads read: one source behind a lock, and those read last.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

#include "pivnp/image/frames/forwarded.hpp"

namespace pivnp::view {

class SharedFrames final : public image::ForwardedFrames {
 public:
  using ForwardedFrames::ForwardedFrames;

  /// From any thread.
  Image read(int index) override;
  /// The same, kept as long as there is room (256 MiB), for who comes back to it.
  std::shared_ptr<const Image> shared(int index);

 private:
  std::mutex mutex_;
  std::list<std::pair<int, std::shared_ptr<const Image>>> kept_;  // the last one used first
};

/// A grey value at a pixel, as stored.
double grey_at(const ImageView& image, int column, int row);

}  // namespace pivnp::view

// Reading ahead of the computation.
#include <future>

#include "pivnp/image/frames/forwarded.hpp"

namespace pivnp::image {

namespace {

// The wrapped source is touched by one thread at a time: a read in the background is waited for before the next one.
class Prefetched final : public ForwardedFrames {
 public:
  using ForwardedFrames::ForwardedFrames;
  ~Prefetched() override {
    if (ahead_.valid()) ahead_.wait();
  }

  Image read(int index) override {
    const bool forward = index == last_ + 1 || index == last_;
    last_ = index;
    Image image = take(index);
    if (forward && !ahead_.valid() && std::size_t(index) + 1 < frames().size()) start(index + 1);
    return image;
  }

 private:
  Image take(int index) {
    if (ahead_.valid()) {
      ahead_.wait();
      if (ahead_index_ == index) return ahead_.get();
      if (ahead_index_ != index + 1) ahead_ = {};  // reading jumped; what the background read threw goes with it
    }
    return source_->read(index);
  }

  void start(int index) {
    ahead_index_ = index;
    ahead_ = std::async(std::launch::async, [this, index] { return source_->read(index); });
  }

  std::future<Image> ahead_;
  int ahead_index_ = -1, last_ = -1;
};

}  // namespace

std::unique_ptr<FrameSource> prefetched(std::unique_ptr<FrameSource> source) {
  return std::make_unique<Prefetched>(std::move(source));
}

}  // namespace pivnp::image

// Reading ahead of the computation.
#include <future>

#include "pivnp/image/frames/frames.hpp"

namespace pivnp::image {

namespace {

// The wrapped source is touched by one thread at a time: a read in the background is waited for before the next one.
class Prefetched final : public FrameSource {
 public:
  explicit Prefetched(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}
  ~Prefetched() override {
    if (ahead_.valid()) ahead_.wait();
  }

  const std::vector<Frame>& frames() const override { return source_->frames(); }
  bool has_rate() const override { return source_->has_rate(); }
  int width() const override { return source_->width(); }
  int height() const override { return source_->height(); }
  std::vector<std::filesystem::path> files() const override { return source_->files(); }
  std::vector<Remark> remarks() const override { return source_->remarks(); }

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

  std::unique_ptr<FrameSource> source_;
  std::future<Image> ahead_;
  int ahead_index_ = -1, last_ = -1;
};

}  // namespace

std::unique_ptr<FrameSource> prefetched(std::unique_ptr<FrameSource> source) {
  return std::make_unique<Prefetched>(std::move(source));
}

}  // namespace pivnp::image

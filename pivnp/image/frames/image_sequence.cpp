// Frames that lie in one file each.
#include <algorithm>

#include "pivnp/core/error.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "pivnp/image/frames/sources.hpp"

namespace pivnp::image {

namespace fs = std::filesystem;

namespace {

class ImageSequence final : public FrameSource {
 public:
  ImageSequence(std::vector<fs::path> files, std::vector<Frame> frames, bool has_rate, std::vector<Remark> remarks)
      : files_(std::move(files)), frames_(std::move(frames)), has_rate_(has_rate), remarks_(std::move(remarks)) {
    const Image first = read_image_file(files_.front(), frames_key);
    width_ = first.width();
    height_ = first.height();
    depth_ = first.depth();
  }

  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return has_rate_; }
  int width() const override { return width_; }
  int height() const override { return height_; }
  std::vector<fs::path> files() const override { return files_; }
  std::vector<Remark> remarks() const override { return remarks_; }

  Image read(int index) override {
    const fs::path& file = files_.at(std::size_t(index));
    Image image = read_image_file(file, frames_key);
    if (image.width() != width_ || image.height() != height_ || image.depth() != depth_)
      throw InputError(frames_key + ": '" + file.string() + "' is " +
                       describe(image.width(), image.height(), image.depth()) + ", but the first frame '" +
                       files_.front().string() + "' is " + describe(width_, height_, depth_));
    return image;
  }

 private:
  std::vector<fs::path> files_;
  std::vector<Frame> frames_;
  bool has_rate_;
  std::vector<Remark> remarks_;
  int width_ = 0, height_ = 0;
  PixelDepth depth_ = PixelDepth::u8;
};

fs::path used_file(const FrameOptions& options, const FrameFiles& files, int number) {
  if (const fs::path* file = files.find(number)) return *file;
  const fs::path& first = files.files.front().path;
  const std::int64_t in_name = files.files.front().number + number;
  const auto pattern = NumberedName::parse(fs::path(options.path).filename().string(), frames_key);
  const std::string name = pattern ? (first.parent_path() / pattern->name(in_name)).string() : std::to_string(in_name);
  throw InputError(frames_key + ": frame " + std::to_string(number) + " is missing: '" + name +
                   "' does not exist (the sequence runs from '" + first.filename().string() + "' to '" +
                   files.files.back().path.filename().string() + "'; a glob takes what exists)");
}

}  // namespace

std::unique_ptr<FrameSource> image_sequence(const FrameOptions& options, const FrameFiles& files,
                                            const fs::path& base) {
  if (options.times == FrameTimes::stamps)
    throw InputError("frames.times: found \"stamps\" for images, which have none; expected \"even\", or a video");
  std::vector<fs::path> paths;
  std::vector<Frame> frames;
  double before = 0;
  for (const int number : chosen_frames(options, files.count(), options.path)) {
    paths.push_back(used_file(options, files, number));
    const auto at = [&](int k) { return files.clock.empty() ? double(k) : files.clock[std::size_t(k)]; };
    const double steps = at(number) - at(options.first);
    if (options.pairs == FramePairs::twos && frames.size() % 2 != 0 && steps != before + 1)
      throw InputError("frames.pairs: '" + frames.back().name + "' and '" + paths.back().filename().string() +
                       "' are not the exposures of one pair, as numbers between them are missing; frames.first begins at another one");
    before = steps;
    frames.push_back({paths.back().filename().string(), frame_time(options, options.rate_hz.value_or(0), frames.size(), steps), frame_ok});
  }
  const auto elsewhere = [&](const fs::path& p) { return p.parent_path() != paths.front().parent_path(); };
  if (std::any_of(paths.begin(), paths.end(), elsewhere))
    for (std::size_t k = 0; k < paths.size(); ++k) frames[k].name = paths[k].lexically_relative(base).string();
  return std::make_unique<ImageSequence>(std::move(paths), std::move(frames), options.rate_hz.has_value(),
                                         files.remarks);
}

}  // namespace pivnp::image

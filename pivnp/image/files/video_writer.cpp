#include "pivnp/image/files/video_writer.hpp"

#include <cstdint>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "pivnp/core/error.hpp"

namespace pivnp::image {

struct VideoWriter::Impl {
  std::filesystem::path file, temporary;
  double rate = 25;
  cv::VideoWriter writer;
  cv::Size size;
  bool begun = false;
};

VideoWriter::VideoWriter(std::filesystem::path file, double frames_a_second) : impl_(std::make_unique<Impl>()) {
  impl_->temporary = file.parent_path() / (file.stem().string() + ".part.mp4");  // the suffix tells the format
  impl_->file = std::move(file);
  impl_->rate = frames_a_second;
}

VideoWriter::~VideoWriter() {
  impl_->writer.release();
  std::error_code ignored;
  std::filesystem::remove(impl_->temporary, ignored);
}

void VideoWriter::add_png(const std::string& png) {
  const std::vector<std::uint8_t> bytes(png.begin(), png.end());
  cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
  if (picture.empty()) throw RunError(impl_->file.string() + ": a frame of the video is no picture");
  picture = picture(cv::Rect(0, 0, picture.cols / 2 * 2, picture.rows / 2 * 2)).clone();
  if (!impl_->begun) {
    std::error_code none_there;
    std::filesystem::remove(impl_->temporary, none_there);  // a link would be written through
    impl_->begun = true;
    impl_->size = picture.size();
    bool opened = false;
    // H.264 is what browsers play too; MPEG-4 part 2 where no encoder of it is installed.
    for (const int codec : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')}) {
      if (opened) break;
      try {
        opened = impl_->writer.open(impl_->temporary.string(), codec, impl_->rate, impl_->size);
      } catch (const cv::Exception&) {
        opened = false;
      }
    }
    if (!opened) throw RunError(impl_->file.string() + ": cannot be written as MP4 (the folder, or this OpenCV, does not let it)");
  }
  if (picture.size() != impl_->size) throw RunError(impl_->file.string() + ": frames of the video differ in size");
  impl_->writer.write(picture);
}

void VideoWriter::finish() {
  impl_->writer.release();
  std::error_code failed;
  std::filesystem::rename(impl_->temporary, impl_->file, failed);
  if (failed) throw RunError(impl_->file.string() + ": " + failed.message());
}

}  // namespace pivnp::image

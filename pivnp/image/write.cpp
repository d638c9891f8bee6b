#include "pivnp/image/write.hpp"

#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pivnp/core/error.hpp"

namespace pivnp::image {

void write_image(const ImageView& image, const std::filesystem::path& file) {
  const int type = image.depth == PixelDepth::u8 ? CV_8UC1 : image.depth == PixelDepth::u16 ? CV_16UC1 : CV_32FC1;
  // OpenCV only reads from it; its Mat has no const form.
  const cv::Mat mat(image.height, image.width, type, const_cast<std::byte*>(image.data), std::size_t(image.stride));
  bool written = false;
  try {
    written = cv::imwrite(file.string(), mat, {cv::IMWRITE_PNG_COMPRESSION, 3});
  } catch (const cv::Exception&) {
  }
  if (!written) throw RunError(file.string() + ": the image could not be written");
}

}  // namespace pivnp::image

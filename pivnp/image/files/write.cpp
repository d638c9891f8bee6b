#include "pivnp/image/files/write.hpp"

#include <cstring>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pivnp/core/error.hpp"

namespace pivnp::image {

namespace {

// OpenCV only reads from it; its Mat has no const form.
cv::Mat seen_by_opencv(const ImageView& image) {
  const int type = image.depth == PixelDepth::u8 ? CV_8UC1 : image.depth == PixelDepth::u16 ? CV_16UC1 : CV_32FC1;
  return {image.height, image.width, type, const_cast<std::byte*>(image.data), std::size_t(image.stride)};
}

}  // namespace

void write_image(const ImageView& image, const std::filesystem::path& file) {
  const cv::Mat mat = seen_by_opencv(image);
  bool written = false;
  try {
    written = cv::imwrite(file.string(), mat, {cv::IMWRITE_PNG_COMPRESSION, 3});
  } catch (const cv::Exception&) {
  }
  if (!written) throw RunError(file.string() + ": the image could not be written");
}

Image through_jpeg(const ImageView& image, int quality) {
  std::vector<unsigned char> bytes;
  cv::Mat decoded;
  try {
    if (image.depth == PixelDepth::u8 && cv::imencode(".jpg", seen_by_opencv(image), bytes, {cv::IMWRITE_JPEG_QUALITY, quality}))
      decoded = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
  }
  if (decoded.rows != image.height || decoded.cols != image.width || decoded.type() != CV_8UC1)
    throw RunError("the image could not be kept as a JPEG of quality " + std::to_string(quality));
  Image out(image.width, image.height, PixelDepth::u8, image.white);
  for (int r = 0; r < image.height; ++r) std::memcpy(out.row<std::uint8_t>(r), decoded.ptr(r), std::size_t(image.width));
  return out;
}

}  // namespace pivnp::image

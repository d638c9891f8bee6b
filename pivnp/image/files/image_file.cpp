#include "pivnp/image/files/image_file.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/image/files/image_check.hpp"

namespace pivnp::image {

namespace {

std::vector<unsigned char> bytes_of(const std::filesystem::path& file, const std::string& what) {
  std::error_code error;
  std::ifstream in = open_regular_file(file, what + ": '" + file.string() + "'");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::vector<unsigned char> bytes(error ? 0 : std::size_t(size));
  if (in) in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
  if (error || !in) throw InputError(what + ": '" + file.string() + "' cannot be read (permission, or a read error)");
  return bytes;
}

// While one of these lives, what libpng and libjpeg print of a file goes nowhere: our own line says what is wrong with it.
// C's stderr alone changes; std::cerr, which the program itself writes to, keeps what it had.
class QuietLibraries {
 public:
  QuietLibraries() {
    const std::lock_guard lock(mutex_);
    static std::FILE* const nowhere = std::fopen("/dev/null", "w");
    if (nowhere && alive_++ == 0) said_ = std::exchange(stderr, nowhere);
  }
  ~QuietLibraries() {
    const std::lock_guard lock(mutex_);
    if (said_ && --alive_ == 0) stderr = std::exchange(said_, nullptr);
  }
  QuietLibraries(const QuietLibraries&) = delete;
  QuietLibraries& operator=(const QuietLibraries&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline int alive_ = 0;
  static inline std::FILE* said_ = nullptr;
};

cv::Mat decoded(std::vector<unsigned char>& bytes) {
  const ImageFormat format = image_format(bytes);
  if (format == ImageFormat::tiff) tiff_clear_orientation(bytes);
  if (format == ImageFormat::png) png_drop_ancillary_chunks(bytes);
  // A JPEG's luma channel is the BT.601 luma; other colour images are converted by one formula for all formats.
  const int flags =
      format == ImageFormat::jpeg ? cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION : cv::IMREAD_UNCHANGED;
  const QuietLibraries quiet;
  try {
    return cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

cv::Mat grey(const cv::Mat& image) {
  cv::Mat out;
  switch (image.channels()) {
    case 1: return image;
    case 2: cv::extractChannel(image, out, 0); break;  // grey and alpha
    case 3: cv::cvtColor(image, out, cv::COLOR_BGR2GRAY); break;
    case 4: cv::cvtColor(image, out, cv::COLOR_BGRA2GRAY); break;
  }
  return out;
}

// False for a pixel type that is not read here.
bool depth_of(const cv::Mat& image, PixelDepth& depth, float& white) {
  switch (image.depth()) {
    case CV_8U: depth = PixelDepth::u8, white = 255; return true;
    case CV_16U: depth = PixelDepth::u16, white = 65535; return true;
    case CV_32F: depth = PixelDepth::f32, white = 1; return true;
    default: return false;
  }
}

}  // namespace

void silence_vendor_messages() {
  static std::once_flag once;
  std::call_once(once, [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // AV_LOG_QUIET; read by OpenCV when it first opens a video
    // Containers that hold their frames themselves: a playlist would have other files opened, or places of the net.
    ::setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS",
             "protocol_whitelist;file|format_whitelist;mov,avi,matroska,mpeg,mpegts,mpegvideo,m4v,h264,hevc,asf,flv,ogg,mxf,"
             "dv,gif,ivf,nut,yuv4mpegpipe,mjpeg,apng",
             1);
  });
}

bool looks_like_image(const std::filesystem::path& file) {
  unsigned char head[16] = {};
  std::ifstream in = open_regular_file(file);
  in.read(reinterpret_cast<char*>(head), sizeof head);
  if (image_format(Bytes(head, std::size_t(in.gcount()))) != ImageFormat::unknown) return true;
  silence_vendor_messages();
  try {
    return in.gcount() > 0 && cv::haveImageReader(file.string());
  } catch (const cv::Exception&) {
    return false;
  }
}

std::string describe(int width, int height, PixelDepth depth) {
  const char* bits = depth == PixelDepth::u8 ? "8-bit" : depth == PixelDepth::u16 ? "16-bit" : "floating point";
  return std::to_string(width) + "x" + std::to_string(height) + " " + bits;
}

Image read_image_file(const std::filesystem::path& file, const std::string& what) {
  silence_vendor_messages();
  const std::string place = what + ": '" + file.string() + "' ";
  std::vector<unsigned char> bytes = bytes_of(file, what);
  if (const auto defect = image_defect(bytes)) throw InputError(place + "is " + *defect);
  const int maxval = pnm_maxval(bytes),
            compression = image_format(bytes) == ImageFormat::tiff ? rare_tiff_compression(bytes) : 0;
  const cv::Mat image = grey(decoded(bytes));
  if (image.empty()) throw InputError(place + "cannot be decoded; expected a png, tif, bmp, jpg or pgm image");

  if (compression != 0 && cv::countNonZero(image) == 0)
    throw InputError(place + "is a TIFF of compression " + std::to_string(compression) +
                     " that came out black; expected none, LZW, deflate, PackBits or JPEG");

  PixelDepth depth = PixelDepth::u8;
  float white = 0;
  if (!depth_of(image, depth, white))
    throw InputError(place + "has a pixel type that is not read; expected 8 or 16 bit, or floating point within 0..1");
  if (depth == PixelDepth::f32) {
    double least = 0, most = 0;
    if (cv::checkRange(image)) cv::minMaxLoc(image, &least, &most);
    else most = 2;
    if (least < 0 || most > 1)
      throw InputError(place + "has floating-point grey values outside 0..1; scale them so that white is 1");
  }
  if (depth == PixelDepth::u16 && maxval > 0) white = float(maxval);
  Image out(image.cols, image.rows, depth, white);
  const std::size_t row_bytes = std::size_t(out.stride());
  for (int r = 0; r < image.rows; ++r) std::memcpy(out.row<std::byte>(r), image.ptr(r), row_bytes);
  return out;
}

}  // namespace pivnp::image

#include "pivnp/image/frames/filter.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace pivnp::image {

namespace {

int matrix_type(PixelDepth depth) {
  return depth == PixelDepth::u8 ? CV_8U : depth == PixelDepth::u16 ? CV_16U : CV_32F;
}

// The image's own memory as a matrix.
cv::Mat matrix_of(Image& image) {
  return {image.height(), image.width(), matrix_type(image.depth()), image.row<std::byte>(0),
          std::size_t(image.stride())};
}

double full_scale(const Image& image) {
  return image.depth() == PixelDepth::u8 ? 255 : image.depth() == PixelDepth::u16 ? 65535 : double(image.white());
}

// Rounded to the image's depth, within 0 and its greatest value.
void put(const cv::Mat& grey, Image& image) {
  cv::Mat held;
  cv::min(cv::max(grey, 0.0), full_scale(image), held);
  cv::Mat out = matrix_of(image);
  held.convertTo(out, out.type());
}

cv::Mat blurred(const cv::Mat& grey, double sigma) {
  cv::Mat out;
  cv::GaussianBlur(grey, out, cv::Size(0, 0), sigma, sigma, cv::BORDER_REFLECT_101);
  return out;
}

// CLAHE needs whole numbers: floating grey values go through 16 bits.
cv::Mat equalised(const cv::Mat& grey, const FilterOptions& options, const Image& like) {
  const bool bytes = like.depth() == PixelDepth::u8;
  const double most = bytes ? 255 : 65535, scale = most / full_scale(like);
  cv::Mat whole, out;
  grey.convertTo(whole, bytes ? CV_8U : CV_16U, scale);
  const auto tiles = [&](int length) { return std::max(1, int((length + options.clahe_px / 2) / options.clahe_px)); };
  cv::createCLAHE(options.clahe_limit, cv::Size(tiles(grey.cols), tiles(grey.rows)))->apply(whole, out);
  out.convertTo(out, CV_32F, 1 / scale);
  return out;
}

double median_of(const cv::Mat& grey) {
  std::vector<float> values(grey.begin<float>(), grey.end<float>());
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return double(*middle);
}

cv::Mat made_even(const cv::Mat& grey, double sigma, double white) {
  const cv::Mat mean = blurred(grey, sigma), off = grey - mean;
  cv::Mat deviation;
  cv::sqrt(blurred(off.mul(off), sigma), deviation);
  cv::Mat out;
  cv::divide(off, cv::max(deviation, 0.01 * white), out, white / 6);
  return out + white / 2;
}

template <class T>
void median_rows(const std::vector<Image>& frames, int from, int to, Image& out) {
  std::vector<T> at(frames.size());
  const auto middle = at.begin() + std::ptrdiff_t((frames.size() - 1) / 2);
  for (int r = from; r < to; ++r)
    for (int c = 0; c < out.width(); ++c) {
      for (std::size_t k = 0; k < frames.size(); ++k) at[k] = frames[k].view().row<T>(r - from)[c];
      std::nth_element(at.begin(), middle, at.end());
      out.row<T>(r)[c] = *middle;
    }
}

Image rows_of(const Image& frame, int from, int to) {
  Image part(frame.width(), to - from, frame.depth(), frame.white());
  std::memcpy(part.row<std::byte>(0), frame.view().row<std::byte>(from),
              std::size_t(frame.stride()) * std::size_t(to - from));
  return part;
}

Image median_background(int count, const std::function<Image(int)>& read, std::size_t memory) {
  Image out;
  for (int from = 0, rows = 0; out.empty() || from < out.height(); from += rows) {
    std::vector<Image> bands;
    for (int k = 0; k < count; ++k) {
      Image frame = read(k);
      if (out.empty()) {
        out = Image(frame.width(), frame.height(), frame.depth(), frame.white());
        const std::size_t row = std::size_t(frame.stride()) * std::size_t(count);
        rows = int(std::clamp<std::size_t>(memory / row, 1, std::size_t(frame.height())));
      }
      bands.push_back(rows_of(frame, from, std::min(from + rows, out.height())));
    }
    const int to = std::min(from + rows, out.height());
    if (out.depth() == PixelDepth::u8)
      median_rows<std::uint8_t>(bands, from, to, out);
    else if (out.depth() == PixelDepth::u16)
      median_rows<std::uint16_t>(bands, from, to, out);
    else
      median_rows<float>(bands, from, to, out);
  }
  return out;
}

}  // namespace

std::vector<int> background_frames(int frames, int most) {
  const int count = std::min(frames, most);
  std::vector<int> out;
  for (int k = 0; k < count; ++k) out.push_back(count > 1 ? int(std::int64_t(k) * (frames - 1) / (count - 1)) : 0);
  return out;
}

Image blurred_image(const ImageView& frame, double sigma) {
  // OpenCV has no matrix of constant memory; this one is only read.
  const cv::Mat grey(frame.height, frame.width, matrix_type(frame.depth), const_cast<std::byte*>(frame.data),
                     std::size_t(frame.stride));
  cv::Mat real;
  grey.convertTo(real, CV_32F);
  Image out(frame.width, frame.height, PixelDepth::f32, frame.white);
  blurred(real, sigma).copyTo(matrix_of(out));
  return out;
}

Image part_of(const ImageView& frame, int left, int top, int width, int height) {
  Image part(width, height, frame.depth, frame.white);
  const std::size_t pixel = bytes_per_pixel(frame.depth);
  for (int r = 0; r < height; ++r)
    std::memcpy(part.row<std::byte>(r), frame.row<std::byte>(top + r) + pixel * std::size_t(left),
                pixel * std::size_t(width));
  return part;
}

Image background_of(int count, const std::function<Image(int)>& read, Background kind, std::size_t memory) {
  if (kind == Background::median) return median_background(count, read, memory);
  Image out = read(0);
  cv::Mat sum, first = matrix_of(out);
  first.convertTo(sum, CV_64F);
  for (int k = 1; k < count; ++k) {
    Image frame = read(k);
    cv::Mat grey;
    matrix_of(frame).convertTo(grey, CV_64F);
    if (kind == Background::minimum)
      cv::min(sum, grey, sum);
    else
      sum += grey;
  }
  put(kind == Background::minimum ? sum : cv::Mat(sum / count), out);
  return out;
}

FrameFilter::FrameFilter(const FilterOptions& options, Image background)
    : options_(options), background_(std::move(background)) {}

Image FrameFilter::operator()(Image frame) const {
  if (!options_.any()) return frame;
  cv::Mat grey;
  matrix_of(frame).convertTo(grey, CV_32F);
  if (!background_.empty()) {
    const ImageView view = background_.view();
    // OpenCV has no matrix of constant memory; this one is only read.
    const cv::Mat still(view.height, view.width, matrix_type(view.depth), const_cast<std::byte*>(view.data),
                        std::size_t(view.stride));
    cv::Mat float_still;
    still.convertTo(float_still, CV_32F);
    grey = grey - float_still + cv::mean(float_still)[0];
  }
  if (options_.high_pass_px > 0) {
    const double mean = cv::mean(grey)[0];
    grey = grey - blurred(grey, options_.high_pass_px) + mean;
  }
  if (options_.clahe_px > 0) grey = equalised(grey, options_, frame);
  if (options_.cap_std > 0) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(grey, mean, deviation);
    grey = cv::min(grey, median_of(grey) + options_.cap_std * deviation[0]);
  }
  if (options_.local_px > 0) grey = made_even(grey, options_.local_px, full_scale(frame));
  put(grey, frame);
  return frame;
}

}  // namespace pivnp::image

// An image as every engine sees it: memory, extent and depth. No vendor type, no file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace pivnp {

enum class PixelDepth : std::uint8_t { u8, u16, f32 };

inline std::size_t bytes_per_pixel(PixelDepth depth) {
  return depth == PixelDepth::u8 ? 1 : depth == PixelDepth::u16 ? 2 : 4;
}

/// One grey channel; pixel (column, row), row downward, pixel centres on whole numbers. Does not own its memory.
struct ImageView {
  const std::byte* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;  // bytes from one row to the next
  PixelDepth depth = PixelDepth::u8;
  float white = 255.0f;       // grey value of full scale: 255, 4095, 65535, 1

  template <class T>
  const T* row(int r) const {
    return reinterpret_cast<const T*>(data + r * stride);
  }
};

/// Pixels that may be used: 1; masked ones: 0. An empty view (data == nullptr) means that every pixel may be used.
struct MaskView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;

  bool usable(int column, int row) const { return data == nullptr || data[row * stride + column] != 0; }
};

/// Owns an image. Rows are contiguous. Memory is not initialised.
class Image {
 public:
  Image() = default;
  Image(int width, int height, PixelDepth depth, float white)
      : width_(width), height_(height), depth_(depth), white_(white),
        bytes_(std::make_unique_for_overwrite<std::byte[]>(std::size_t(width) * std::size_t(height) *
                                                           bytes_per_pixel(depth))) {}
  int width() const { return width_; }
  int height() const { return height_; }
  PixelDepth depth() const { return depth_; }
  float white() const { return white_; }
  bool empty() const { return !bytes_; }
  std::ptrdiff_t stride() const { return std::ptrdiff_t(width_) * std::ptrdiff_t(bytes_per_pixel(depth_)); }
  template <class T>
  T* row(int r) {
    return reinterpret_cast<T*>(bytes_.get() + r * stride());
  }
  ImageView view() const { return {bytes_.get(), width_, height_, stride(), depth_, white_}; }

 private:
  int width_ = 0, height_ = 0;
  PixelDepth depth_ = PixelDepth::u8;
  float white_ = 255.0f;
  std::unique_ptr<std::byte[]> bytes_;
};

}  // namespace pivnp

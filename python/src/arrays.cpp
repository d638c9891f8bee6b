#include "python/src/arrays.hpp"

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::python {

namespace {

std::string extents(const std::vector<py::ssize_t>& shape) {
  std::string text;
  for (const py::ssize_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text;
}

}  // namespace

BorrowedImage::BorrowedImage(const py::buffer& buffer, const std::string& what, double white) : info_(buffer.request()) {
  const std::string& f = info_.format;
  if (info_.ndim != 2) throw InputError(what + ": found an array of " + extents(info_.shape) + ", expected rows x columns of grey values");
  if (f == "B" || f == "?") {
    view_.depth = PixelDepth::u8;
  } else if (f == "H") {
    view_.depth = PixelDepth::u16;
  } else if (f == "f") {
    view_.depth = PixelDepth::f32;
  } else {
    throw InputError(what + ": found an array of type '" + f + "', expected uint8, uint16 or float32");
  }
  if (info_.strides[1] != info_.itemsize)
    throw InputError(what + ": found pixels " + std::to_string(info_.strides[1]) +
                     " bytes apart, expected rows whose pixels lie side by side (numpy.ascontiguousarray copies)");
  constexpr float usual[] = {255.0f, 65535.0f, 1.0f};
  view_.data = static_cast<const std::byte*>(info_.ptr);
  view_.height = int(info_.shape[0]);
  view_.width = int(info_.shape[1]);
  view_.stride = info_.strides[0];
  view_.white = white > 0 ? float(white) : usual[int(view_.depth)];
}

MaskView BorrowedImage::mask() const {
  if (view_.depth != PixelDepth::u8) throw InputError("mask: found an array of wide numbers, expected bool or uint8");
  return {reinterpret_cast<const std::uint8_t*>(view_.data), view_.width, view_.height, view_.stride};
}

std::vector<Vec2> positions(const py::array_t<double, py::array::c_style | py::array::forcecast>& array, const std::string& what) {
  if (array.ndim() != 2 || array.shape(1) != 2)
    throw InputError(what + ": found an array of " + extents({array.shape(), array.shape() + array.ndim()}) + ", expected n x 2");
  std::vector<Vec2> out;
  const auto at = array.unchecked<2>();
  for (py::ssize_t k = 0; k < array.shape(0); ++k) out.emplace_back(at(k, 0), at(k, 1));
  return out;
}

}  // namespace pivnp::python

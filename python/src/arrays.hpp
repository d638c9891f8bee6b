// Memory that numpy and the engines share: images from any buffer, results as arrays over the engines' own memory.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::python {

namespace py = pybind11;

using Shape = std::vector<py::ssize_t>;

/// A read-only array over memory that `owner` keeps: nothing is copied.
template <class T>
py::array view(const void* data, Shape shape, py::handle owner) {
  py::array array(py::dtype::of<T>(), std::move(shape), {}, data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// An array that takes over `values`: nothing is copied. T is the number that the rows consist of.
template <class T, class Row>
py::array taken(std::vector<Row>&& values, Shape shape) {
  auto kept = std::make_unique<std::vector<Row>>(std::move(values));
  const void* data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<Row>*>(p); });
  kept.release();
  return py::array(py::dtype::of<T>(), std::move(shape), {}, data, owner);
}

/// An image in any object with a buffer: two-dimensional, uint8, uint16 or float32, pixels of a row side by side. The
/// memory stays the caller's, and in place while this lives. Throws InputError naming `what`.
class BorrowedImage {
 public:
  BorrowedImage(const py::buffer& buffer, const std::string& what, double white);
  const ImageView& view() const { return view_; }
  MaskView mask() const;  // of bytes: 0 hides a pixel

 private:
  py::buffer_info info_;
  ImageView view_;
};

/// Positions from an array [n][2].
std::vector<Vec2> positions(const py::array_t<double, py::array::c_style | py::array::forcecast>& array, const std::string& what);

}  // namespace pivnp::python

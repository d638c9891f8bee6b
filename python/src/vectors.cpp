// Image correlation: vectors of a pair from two arrays.
#include <pybind11/stl.h>

#include <cmath>
#include <cstring>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/sequence.hpp"
#include "python/src/guard.hpp"
#include "python/src/parts.hpp"

namespace pivnp::python {

namespace {

// A case's measurement of pairs of arrays, as `pivnp run` makes it of files.
class Correlator {
 public:
  Correlator(const std::string& toml, int width, int height, const py::object& mask, int threads) {
    const app::Case c = case_of(toml);
    setting_ = app::make_setting(c, width, height);
    if (c.camera_motion.from != image::RestSource::none || !setting_.moving_masks.empty())
      throw InputError("Correlator: the case has a camera or masks that move, expected neither (pivnp.run follows them)");
    lattice_ = app::node_lattice(setting_);
    if (!mask.is_none()) mask_ = std::make_unique<BorrowedImage>(mask.cast<py::buffer>(), "mask", 0);
    if (mask_ && (mask_->view().width != width || mask_->view().height != height))
      throw InputError("mask: found " + image::describe(mask_->view().width, mask_->view().height, PixelDepth::u8) +
                       ", expected " + image::describe(width, height, PixelDepth::u8));
    options_ = c.piv.value_or(piv::PivOptions{});
    threads_ = threads_here(threads);
    correlator_ = std::make_unique<piv::PairCorrelator>(options_, lattice_, width, height, threads_);
  }

  // Frames one after the other; vectors come group by group, as `pivnp run` makes them.
  std::vector<Vectors> sequence(const std::vector<py::buffer>& frames, double white) {
    std::vector<std::unique_ptr<BorrowedImage>> images;
    for (const py::buffer& frame : frames) {
      images.push_back(std::make_unique<BorrowedImage>(frame, "frame", white));
      demand_size(*images.back(), "frame");
    }
    return unlocked([&](Progress& progress) {
      piv::SequenceCorrelator correlator(options_, lattice_, setting_.width, setting_.height, threads_);
      std::vector<Vectors> all;
      for (std::size_t k = 0; k + 1 < images.size(); ++k) {
        if (progress.stop_requested()) throw Interrupted();
        correlator.add(images[k]->view(), images[k + 1]->view(), mask_ ? mask_->mask() : setting_.mask.view());
        if (correlator.held() < piv::SequenceCorrelator::group && k + 2 < images.size()) continue;
        for (const piv::PixelVectors& pixels : correlator.finish()) {
          const int first = int(all.size());
          all.push_back(Vectors{app::world_vectors(pixels, lattice_, setting_, {first, first + 1}), setting_.camera.length_unit()});
        }
      }
      return all;
    });
  }

  Vectors correlate(const py::buffer& first, const py::buffer& second, double white, std::array<int, 2> pair) {
    const BorrowedImage a(first, "first", white), b(second, "second", white);
    demand_size(a, "first");
    demand_size(b, "second");
    return unlocked([&](Progress&) {
      const std::lock_guard one_at_a_time(mutex_);  // its buffers serve every pair
      const piv::PixelVectors pixels =
          correlator_->correlate(a.view(), b.view(), mask_ ? mask_->mask() : setting_.mask.view());
      return Vectors{app::world_vectors(pixels, lattice_, setting_, pair), setting_.camera.length_unit()};
    });
  }

 private:
  void demand_size(const BorrowedImage& image, const char* what) const {
    if (image.view().width == setting_.width && image.view().height == setting_.height) return;
    throw InputError(std::string(what) + ": found " + image::describe(image.view().width, image.view().height, image.view().depth) + ", expected " +
                     std::to_string(setting_.width) + "x" + std::to_string(setting_.height));
  }

  app::Setting setting_;
  piv::NodeLattice lattice_;
  piv::PivOptions options_;
  int threads_ = 0;
  std::unique_ptr<BorrowedImage> mask_;
  std::unique_ptr<piv::PairCorrelator> correlator_;
  std::mutex mutex_;
};

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

template <class Row, class Array>
void fill(std::vector<Row>& rows, const Array& from, const VectorField& field, py::ssize_t components,
          const char* what) {
  const py::ssize_t count = py::ssize_t(field.grid.node_count());
  if (from.size() != count * components || from.shape(0) != field.grid.ny)
    throw InputError(std::string(what) + ": found " + std::to_string(from.size()) + " values, expected " +
                     std::to_string(field.grid.ny) + " x " + std::to_string(field.grid.nx) +
                     (components > 1 ? " x " + std::to_string(components) : ""));
  rows.resize(std::size_t(count));
  std::memcpy(static_cast<void*>(rows.data()), from.data(), std::size_t(from.nbytes()));
}

Vectors from_arrays(const Floats& displacement, std::array<double, 2> origin, std::array<double, 2> spacing,
                    const std::optional<Bytes>& status, const std::optional<Floats>& cov,
                    const std::optional<Floats>& score, const std::string& anchor, const std::string& length_unit) {
  Vectors v;
  v.length_unit = length_unit;
  if (displacement.ndim() != 3 || displacement.shape(2) != 2)
    throw InputError("displacement: found " + std::to_string(displacement.ndim()) +
                     " dimensions, expected ny x nx x 2");
  v.field.grid =
      Grid{{origin[0], origin[1]}, {spacing[0], spacing[1]}, int(displacement.shape(1)), int(displacement.shape(0))};
  const auto known = value_named<Anchor>(anchor);
  if (!known) throw InputError("anchor: found \"" + anchor + "\", expected central or forward");
  v.field.anchor = *known;
  fill(v.field.displacement, displacement, v.field, 2, "displacement");
  v.field.status.assign(v.field.grid.node_count(), VectorStatus::valid);
  if (status) fill(v.field.status, *status, v.field, 1, "status");
  for (const VectorStatus s : v.field.status)
    if (s > VectorStatus::outside) throw InputError("status: found " + std::to_string(int(s)) + ", expected 0 to 5");
  for (std::size_t k = 0; k < v.field.status.size(); ++k)
    if (!std::isfinite(v.field.displacement[k][0] + v.field.displacement[k][1]) && usable(v.field.status[k]))
      v.field.status[k] = VectorStatus::failed;
  v.field.score.assign(v.field.grid.node_count(), 1.0f);
  if (score) fill(v.field.score, *score, v.field, 1, "score");
  if (cov) fill(v.field.cov, *cov, v.field, 3, "cov");
  return v;
}

std::vector<double> axis(double origin, double spacing, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(origin + k * spacing);
  return values;
}

py::array image_array(const std::string& file) {
  auto image = std::make_unique<Image>(image::read_image_file(file, "image"));
  const Shape shape{image->height(), image->width()};
  const void* data = image->view().data;
  const PixelDepth depth = image->depth();
  const py::capsule owner(image.get(), [](void* p) { delete static_cast<Image*>(p); });
  image.release();
  const py::dtype type = depth == PixelDepth::u8    ? py::dtype::of<std::uint8_t>()
                         : depth == PixelDepth::u16 ? py::dtype::of<std::uint16_t>()
                                                    : py::dtype::of<float>();
  return py::array(type, shape, {}, data, owner);
}

}  // namespace

void bind_vectors(py::module_& m) {
  py::class_<Vectors, std::shared_ptr<Vectors>>(
      m, "Vectors", R"(Displacement increments of one pair of frames at the nodes of a regular grid.

Lengths are in `length_unit`, x to the right, y up; node [j, i] lies at (x[i], y[j]). Arrays share the engine's memory and
are read-only.)")
      .def(py::init(&from_arrays), py::arg("displacement"), py::arg("origin") = std::array<double, 2>{0, 0},
           py::arg("spacing") = std::array<double, 2>{1, 1}, py::kw_only(), py::arg("status") = py::none(),
           py::arg("cov") = py::none(), py::arg("score") = py::none(), py::arg("anchor") = "central",
           py::arg("length_unit") = "px",
           "From arrays [ny, nx, ...], which are copied; a displacement that is not finite becomes a failed vector.")
      .def_readonly("length_unit", &Vectors::length_unit, "Unit of displacement, x and y.")
      .def_property_readonly(
          "anchor", [](const Vectors& v) { return std::string(name_of(v.field.anchor)); },
          "Instant to which a vector's place belongs: central (middle of the pair) or forward (first frame).")
      .def_property_readonly(
          "pair", [](const Vectors& v) { return py::make_tuple(v.field.pair[0], v.field.pair[1]); }, "The two frames.")
      .def_property_readonly(
          "origin", [](const Vectors& v) { return py::make_tuple(v.field.grid.origin.x(), v.field.grid.origin.y()); },
          "Node [0, 0], length.")
      .def_property_readonly(
          "spacing",
          [](const Vectors& v) { return py::make_tuple(v.field.grid.spacing.x(), v.field.grid.spacing.y()); },
          "From node to node, length.")
      .def_property_readonly(
          "x",
          [](const Vectors& v) {
            const Grid& g = v.field.grid;
            return taken<double>(axis(g.origin.x(), g.spacing.x(), g.nx), {g.nx});
          },
          "[nx], length.")
      .def_property_readonly(
          "y",
          [](const Vectors& v) {
            const Grid& g = v.field.grid;
            return taken<double>(axis(g.origin.y(), g.spacing.y(), g.ny), {g.ny});
          },
          "[ny], length, upward.")
      .def_property_readonly(
          "displacement",
          [](const std::shared_ptr<Vectors>& v) {
            return view<float>(v->field.displacement.data(), {v->field.grid.ny, v->field.grid.nx, 2}, py::cast(v));
          },
          "[ny, nx, 2], length: (x, y); NaN where nothing was measured.")
      .def_property_readonly(
          "status",
          [](const std::shared_ptr<Vectors>& v) {
            return view<std::uint8_t>(v->field.status.data(), {v->field.grid.ny, v->field.grid.nx}, py::cast(v));
          },
          "[ny, nx]: 0 masked, 1 valid, 2 replaced, 3 rejected, 4 failed.")
      .def_property_readonly(
          "cov",
          [](const std::shared_ptr<Vectors>& v) -> py::object {
            if (v->field.cov.empty()) return py::none();
            return view<float>(v->field.cov.data(), {v->field.grid.ny, v->field.grid.nx, 3}, py::cast(v));
          },
          "[ny, nx, 3], length^2: covariance (uu, vv, uv) of the random error; None where it is not known.")
      .def_property_readonly(
          "score",
          [](const std::shared_ptr<Vectors>& v) {
            return view<float>(v->field.score.data(), {v->field.grid.ny, v->field.grid.nx}, py::cast(v));
          },
          "[ny, nx]: correlation coefficient, -1 to 1.");

  py::class_<Correlator>(
      m, "Correlator",
      "Correlates pairs of images of one size with a case's [piv], [camera] and [grid]; keeps plans and buffers.")
      .def(py::init<const std::string&, int, int, const py::object&, int>(), py::arg("toml"), py::arg("width"),
           py::arg("height"), py::arg("mask"), py::arg("threads"))
      .def("correlate", &Correlator::correlate, py::arg("first"), py::arg("second"), py::arg("white"), py::arg("pair"))
      .def("sequence", &Correlator::sequence, py::arg("frames"), py::arg("white"));

  m.def("read_image", &image_array, py::arg("file"),
        R"(Grey values of an image file as pivnp reads them: [rows, columns] of uint8, uint16 or float32 (0 to 1).

Colour becomes luma. ValueError where the file is none.)");
}

}  // namespace pivnp::python

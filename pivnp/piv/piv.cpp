#include "pivnp/piv/piv.hpp"

#include <limits>
#include <string>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/piv/dis.hpp"
#include "pivnp/piv/gauss_newton.hpp"
#include "pivnp/piv/lattice.hpp"
#include "pivnp/piv/method.hpp"
#include "pivnp/piv/multipass.hpp"

namespace pivnp::piv {

namespace {

[[noreturn]] void refuse(const std::string& key, const std::string& found, const std::string& expected) {
  throw InputError("piv." + key + ": found " + found + ", expected " + expected);
}

// What ranges of single options cannot say.
void check(const PivOptions& options, const NodeLattice& lattice, int width, int height) {
  if (width < 1 || height < 1) throw InputError("piv: found frames without pixels, expected at least 1 x 1");
  if (options.anchor != "central" && options.anchor != "forward")
    refuse("anchor", "'" + options.anchor + "'", "central or forward");
  if (options.window_px < 8 || options.window_px > std::min(width, height))
    refuse("window_px", std::to_string(options.window_px),
           "8 to the frames' shorter side (" + std::to_string(std::min(width, height)) + " px)");
  if (options.first_window_px != 0 && options.first_window_px < options.window_px)
    refuse("first_window_px", std::to_string(options.first_window_px),
           "0 or at least window_px (" + std::to_string(options.window_px) + ")");
  if (options.passes < 0) refuse("passes", std::to_string(options.passes), "0 or more");
  if (!(options.median_threshold > 0)) refuse("median_threshold", std::to_string(options.median_threshold), "above 0");
  const std::size_t count = std::size_t(lattice.nx) * std::size_t(lattice.ny);
  if (lattice.nx < 1 || lattice.ny < 1 || lattice.pixel.size() != count ||
      (!lattice.on.empty() && lattice.on.size() != count))
    throw InputError("piv: found a lattice whose arrays do not match its size, expected one place a node");
}

}  // namespace

struct PairCorrelator::Impl {
  std::unique_ptr<Method> method;
  NodeLattice nodes;
  Anchor anchor = Anchor::central;
  int width = 0, height = 0;

  // As they are before anything is measured.
  PixelVectors empty_vectors() const {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const std::size_t count = nodes.pixel.size();
    PixelVectors vectors{anchor, {}, {}, {}, {}, nan};
    vectors.displacement.assign(count, {nan, nan});
    vectors.cov.assign(count, {nan, nan, nan});
    vectors.score.assign(count, nan);
    vectors.status.assign(count, VectorStatus::failed);
    for (std::size_t k = 0; k < count; ++k)
      if (!switched_on(nodes, k)) vectors.status[k] = VectorStatus::masked;
    return vectors;
  }
};

PairCorrelator::PairCorrelator(const PivOptions& options, NodeLattice lattice, int width, int height, int threads)
    : impl_(std::make_unique<Impl>()) {
  check(options, lattice, width, height);
  impl_->anchor = anchor_of(options);
  impl_->width = width;
  impl_->height = height;
  const auto gauss_newton = [&](int finest) {
    return make_gauss_newton(options, lattice, width, height, threads, finest);
  };
  if (options.method == "default" || options.method == "gn")
    impl_->method = gauss_newton(1);
  else if (options.method == "fast")
    impl_->method = gauss_newton(2);
  else if (options.method == "fft" || options.method == "ncc")
    impl_->method = make_multipass(options, lattice, width, height, threads);
  else if (options.method == "dis")
    impl_->method = make_dense_inverse_search(options, lattice, width, height, threads);
  else
    refuse("method", "'" + options.method + "'", "default, gn, fast, fft, ncc or dis");
  impl_->nodes = std::move(lattice);
}

PairCorrelator::~PairCorrelator() = default;

PixelVectors PairCorrelator::correlate(const ImageView& first, const ImageView& second, const MaskView& mask) {
  for (const ImageView* view : {&first, &second})
    if (view->width != impl_->width || view->height != impl_->height)
      throw InputError("piv: found a frame of " + std::to_string(view->width) + " x " + std::to_string(view->height) +
                       " px, expected " + std::to_string(impl_->width) + " x " + std::to_string(impl_->height));
  if (mask.data != nullptr && (mask.width != impl_->width || mask.height != impl_->height))
    throw InputError("piv: found a mask of " + std::to_string(mask.width) + " x " + std::to_string(mask.height) +
                     " px, expected " + std::to_string(impl_->width) + " x " + std::to_string(impl_->height));
  PixelVectors vectors = impl_->empty_vectors();
  impl_->method->correlate(first, second, mask, vectors);
  return vectors;
}

}  // namespace pivnp::piv

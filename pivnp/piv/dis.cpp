#include "pivnp/piv/dis.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>

#include "pivnp/piv/increments.hpp"
#include "pivnp/piv/judge.hpp"
#include "pivnp/piv/lattice.hpp"
#include "pivnp/piv/lattice_filter.hpp"

namespace pivnp::piv {

namespace {

cv::Mat as_8_bits(const ImageView& image) {
  const int type = image.depth == PixelDepth::u8 ? CV_8U : image.depth == PixelDepth::u16 ? CV_16U : CV_32F;
  const cv::Mat view(image.height, image.width, type, const_cast<std::byte*>(image.data), std::size_t(image.stride));
  cv::Mat grey;
  view.convertTo(grey, CV_8U, 255.0 / static_cast<double>(image.white));
  return grey;
}

class DenseInverseSearch final : public Method {
 public:
  DenseInverseSearch(const PivOptions& options, const Extent& extent, int threads)
      : options_(options),
        nodes_(extent.nodes),
        mask_(extent.mask),
        width_(extent.width),
        height_(extent.height),
        threads_(std::max(1, threads)),
        anchor_(anchor_of(options)),
        search_(cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)) {
    lattice_.step = std::max(2, options.window_px / 4);
    const Box box = bounding_box(nodes_, 2.0f * static_cast<float>(lattice_.step), width_, height_);
    if (box.empty()) return;
    lattice_.x0 = box.x0, lattice_.y0 = box.y0;
    lattice_.nx = std::max(least_lattice_points, (box.width() + lattice_.step - 1) / lattice_.step + 1);
    lattice_.ny = std::max(least_lattice_points, (box.height() + lattice_.step - 1) / lattice_.step + 1);
  }

  void correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) override {
    if (lattice_.nx == 0) return;
    cv::setNumThreads(threads_);
    search_->calc(as_8_bits(first), as_8_bits(second), flow_);
    std::vector<float> u(lattice_.size()), v(lattice_.size());
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        const auto d = displacement(static_cast<float>(lattice_.x0 + i * lattice_.step),
                                    static_cast<float>(lattice_.y0 + j * lattice_.step));
        u[lattice_.index(i, j)] = d[0], v[lattice_.index(i, j)] = d[1];
      }
    judge(first, second, u, v, vectors);
  }

 private:
  // Of the material that is at (x, y) at the instant of the anchor.
  std::array<float, 2> displacement(float x, float y) const {
    std::array<float, 2> d = at(x, y);
    constexpr int steps = 8;  // the place in the first frame, by fixed-point iteration
    for (int k = 0; anchor_ == Anchor::central && k < steps; ++k) d = at(x - 0.5f * d[0], y - 0.5f * d[1]);
    return d;
  }

  std::array<float, 2> at(float x, float y) const {
    x = std::clamp(x, 0.0f, static_cast<float>(width_ - 1));
    y = std::clamp(y, 0.0f, static_cast<float>(height_ - 1));
    const int c = std::min(static_cast<int>(x), std::max(width_ - 2, 0)),
              r = std::min(static_cast<int>(y), std::max(height_ - 2, 0));
    const int c1 = std::min(c + 1, width_ - 1), r1 = std::min(r + 1, height_ - 1);
    const float s = x - static_cast<float>(c), t = y - static_cast<float>(r);
    const auto mix = [&](int k) {
      return (1 - t) * ((1 - s) * flow_(r, c)[k] + s * flow_(r, c1)[k]) +
             t * ((1 - s) * flow_(r1, c)[k] + s * flow_(r1, c1)[k]);
    };
    return {mix(0), mix(1)};
  }

  void judge(const ImageView& first, const ImageView& second, const std::vector<float>& u, const std::vector<float>& v,
             PixelVectors& vectors) {
    const float rounding = rounding_variance(first);
    first_.assign(first, mask_, 1, threads_);
    second_.assign(second, mask_, 1, threads_);
    masked_.take_mask(mask_, 1);
    first_flags_.take(first, masked_);
    second_flags_.take(second, masked_);
    field_.interpolate(lattice_, u, v);
    SumsInput input;
    input.first = &first_, input.second = &second_;
    if (!first_flags_.empty()) input.first_flags = &first_flags_;
    if (!second_flags_.empty()) input.second_flags = &second_flags_;
    input.field = &field_;
    input.shares = shares_of(anchor_);
    input.scores = true;
    accumulate_sums(input, threads_, sums_);
    // What a Gauss-Newton step would still change is the flow's own error, as far as the images tell.
    cell_increments(sums_, rounding, increments_);
    SmoothedField error_u, error_v;
    error_of(increments_.u, error_u);
    error_of(increments_.v, error_v);
    judge_nodes({options_, nodes_, width_, height_, 1, threads_, rounding}, field_, sums_, u, v, error_u, error_v,
                vectors);
  }

  void error_of(const std::vector<float>& increment, SmoothedField& error) const {
    constexpr int reach = 2;
    std::vector<float> square(increment.size());
    for (std::size_t k = 0; k < increment.size(); ++k) square[k] = increment[k] * increment[k];
    box_mean(lattice_, square, reach, error.variance);
    error.area.assign(increment.size(), 1.0f);
  }

  PivOptions options_;
  NodeLattice nodes_;
  MaskView mask_;
  int width_, height_, threads_;
  Anchor anchor_;
  cv::Ptr<cv::DISOpticalFlow> search_;
  cv::Mat_<cv::Vec2f> flow_;
  CellLattice lattice_;
  SplineImage first_, second_;
  PixelFlags masked_, first_flags_, second_flags_;
  SplineField field_;
  CellSums sums_;
  Increments increments_;
};

}  // namespace

std::unique_ptr<Method> make_dense_inverse_search(const PivOptions& options, const Extent& extent, int threads) {
  return std::make_unique<DenseInverseSearch>(options, extent, threads);
}

}  // namespace pivnp::piv

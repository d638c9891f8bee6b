#include "pivnp/piv/dis.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "pivnp/piv/dense/corrections.hpp"
#include "pivnp/piv/dense/gn_level.hpp"
#include "pivnp/piv/dense/lattice_filter.hpp"
#include "pivnp/piv/validation/vector_validation.hpp"

namespace pivnp::piv {

namespace {

// Halved, as the search ends at a quarter of the resolution: nothing is done at the full one.
cv::Mat half_as_8_bits(const ImageView& image) {
  const int type = image.depth == PixelDepth::u8 ? CV_8U : image.depth == PixelDepth::u16 ? CV_16U : CV_32F;
  const cv::Mat view(image.height, image.width, type, const_cast<std::byte*>(image.data), std::size_t(image.stride));
  cv::Mat half, grey;
  const cv::Size size(image.width / dis_decimation, image.height / dis_decimation);
  const cv::Rect whole(0, 0, dis_decimation * size.width, dis_decimation * size.height);
  cv::resize(view(whole), half, size, 0, 0, cv::INTER_AREA);
  half.convertTo(grey, CV_8U, 255.0 / static_cast<double>(image.white));
  return grey;
}

class DenseInverseSearch final : public Method {
 public:
  DenseInverseSearch(const PivOptions& options, const Extent& extent, int threads)
      : options_(options),
        extent_(extent),
        threads_(std::max(1, threads)),
        anchor_(options.anchor),
        search_(cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST)),
        empty_(bounding_box(extent.nodes, 0, extent.width, extent.height).empty()),
        level_(extent, dis_decimation, options.window_px, 1) {
    constexpr int patch_stride = 5;  // of patches of 8 pixels, at a quarter of the resolution
    search_->setPatchStride(patch_stride);
    search_->setFinestScale(1);
  }

  void correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) override {
    if (empty_) return;
    cv::setNumThreads(threads_);
    search_->calc(half_as_8_bits(first), half_as_8_bits(second), flow_);
    const CellLattice& lattice = level_.lattice();
    u_.resize(lattice.size());
    v_.resize(lattice.size());
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) {
        const auto d = displacement(static_cast<float>(lattice.x0 + i * lattice.step),
                                    static_cast<float>(lattice.y0 + j * lattice.step));
        u_[lattice.index(i, j)] = d[0], v_[lattice.index(i, j)] = d[1];
      }
    validate(first, second, vectors);
  }

 private:
  // Of the material that is at (x, y) at the instant of the anchor; pixels of the level.
  std::array<float, 2> displacement(float x, float y) const {
    std::array<float, 2> d = at(x, y);
    constexpr int steps = 8;  // the place in the first frame, by fixed-point iteration
    for (int k = 0; anchor_ == Anchor::central && k < steps; ++k) d = at(x - 0.5f * d[0], y - 0.5f * d[1]);
    return d;
  }

  std::array<float, 2> at(float x, float y) const {
    const int right = flow_.cols - 1, bottom = flow_.rows - 1;
    x = std::clamp(x, 0.0f, static_cast<float>(right));
    y = std::clamp(y, 0.0f, static_cast<float>(bottom));
    const int c = static_cast<int>(x), r = static_cast<int>(y);
    const int c1 = std::min(c + 1, right), r1 = std::min(r + 1, bottom);
    const float s = x - static_cast<float>(c), t = y - static_cast<float>(r);
    const auto mix = [&](int k) {
      return (1 - t) * ((1 - s) * flow_(r, c)[k] + s * flow_(r, c1)[k]) +
             t * ((1 - s) * flow_(r1, c)[k] + s * flow_(r1, c1)[k]);
    };
    return {mix(0), mix(1)};
  }

  void validate(const ImageView& first, const ImageView& second, PixelVectors& vectors) {
    constexpr float smoothing = 0.25f;  // averages over blocks of pixels hold the aliases of their own sampling
    const float rounding = rounding_variance(first);
    level_.take(first, second, smoothing, threads_, nullptr);
    field_.interpolate(level_.lattice(), u_, v_, threads_);
    SumsInput input;
    input.first = &level_.images().first, input.second = &level_.images().second;
    input.first_flags = level_.first_flags(), input.second_flags = level_.second_flags();
    input.field = &field_;
    input.shares = shares_of(anchor_);
    if (!level_.wanted().empty()) input.active = &level_.wanted();
    input.scores = true;
    accumulate_sums(input, threads_, sums_);
    // What a Gauss-Newton step would still change is the flow's own error, as far as the images tell.
    cell_corrections(sums_, rounding, corrections_);
    SmoothedField error_u, error_v;
    error_of(corrections_.u, error_u);
    error_of(corrections_.v, error_v);
    validate_vectors({limits_of(options_), extent_.nodes, extent_.width, extent_.height, dis_decimation, threads_,
                      rounding, extent_.mask},
                     field_, sums_, u_, v_, error_u, error_v, vectors, trusted_);
  }

  void error_of(const std::vector<float>& correction, SmoothedField& error) const {
    constexpr int reach = 1;
    std::vector<float> square(correction.size());
    for (std::size_t k = 0; k < correction.size(); ++k) square[k] = correction[k] * correction[k];
    box_mean(level_.lattice(), square, reach, error.variance);
    error.area.assign(correction.size(), 1.0f);
  }

  PivOptions options_;
  Extent extent_;
  int threads_;
  Anchor anchor_;
  cv::Ptr<cv::DISOpticalFlow> search_;
  cv::Mat_<cv::Vec2f> flow_;
  bool empty_;  // no node lies in the frames
  GnLevel level_;
  SplineField field_;
  CellSums sums_;
  Corrections corrections_;
  std::vector<std::uint8_t> trusted_;
  std::vector<float> u_, v_;  // the flow at the level's lattice, level pixels
};

}  // namespace

std::unique_ptr<Method> make_dense_inverse_search(const PivOptions& options, const Extent& extent, int threads) {
  return std::make_unique<DenseInverseSearch>(options, extent, threads);
}

}  // namespace pivnp::piv

#include "pivnp/image/synthetic/synthetic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "pivnp/core/error.hpp"

namespace pivnp::image {

namespace {

// Random numbers are hashes of (seed, what they are for, index), so that no draw depends on another and the order of
// drawing does not matter. Mixing: splitmix64 (Steele, Lea & Flood 2014). Only integer arithmetic and IEEE basic
// operations are used below: the standard distributions and the last bits of libm differ between platforms.
enum class Stream : std::uint64_t { peak = 1, loss = 2, noise = 3, grain = 4 };

std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

std::uint64_t stream_key(int seed, Stream stream, std::uint64_t frame) {
  return mix(mix(mix(static_cast<std::uint64_t>(seed)) ^ static_cast<std::uint64_t>(stream)) ^ frame);
}

double uniform01(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; }

// Standard normal as the sum of twelve 16-bit uniforms (Irwin-Hall): mean 0, variance 1 - 2^-32, excess kurtosis -0.1,
// no tail beyond six standard deviations; exact on every platform.
double normal(std::uint64_t key, std::uint64_t index) {
  std::uint32_t sum = 0;
  for (std::uint64_t part = 0; part < 3; ++part) {
    const std::uint64_t bits = mix(key + 3 * index + part);
    sum +=
        static_cast<std::uint32_t>((bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48));
  }
  return (static_cast<double>(sum) - 12.0 * 32767.5) * 0x1.0p-16;
}

double exp_of_negative(double y) {  // exp(-y), y >= 0, by Taylor on y/256 and squaring
  const double z = -y / 256.0;
  double e = 1.0 + z * (1.0 + z / 2 * (1.0 + z / 3 * (1.0 + z / 4 * (1.0 + z / 5 * (1.0 + z / 6)))));
  for (int k = 0; k < 8; ++k) e *= e;
  return e;
}

/// Integral of the normal density from -infinity to x (in standard deviations), by cubic Hermite interpolation between
/// knots 1/32 apart: error below 1e-8, far below a grey value of 16 bits.
class NormalCdf {
 public:
  static constexpr int per_sigma = 32;
  static constexpr int reach = 6;  // beyond it 0 or 1; 1 - cdf(6) = 1e-9

  NormalCdf() {
    for (int k = 0; k <= 2 * reach * per_sigma; ++k) {
      const double x = static_cast<double>(k) / per_sigma - reach;
      density_[std::size_t(k)] = exp_of_negative(x * x / 2) * 0.3989422804014327;
      value_[std::size_t(k)] = 0.5 + (x < 0 ? -half(-x) : half(x));
    }
  }

  double operator()(double x) const {
    const double s = (x + reach) * per_sigma;
    if (s <= 0) return 0;
    if (s >= 2 * reach * per_sigma) return 1;
    const auto k = static_cast<std::size_t>(s);
    const double t = s - static_cast<double>(k), m0 = density_[k] / per_sigma, m1 = density_[k + 1] / per_sigma;
    const double rise = value_[k + 1] - value_[k];
    return value_[k] + t * (m0 + t * (3 * rise - 2 * m0 - m1 + t * (m0 + m1 - 2 * rise)));
  }

 private:
  // Integral from 0 to x: density times x (1 + x^2/3 + x^4/15 + ...), all terms positive.
  static double half(double x) {
    double term = x, sum = x;
    for (int n = 1; n < 200; ++n) {
      term *= x * x / (2 * n + 1);
      sum += term;
    }
    return sum * exp_of_negative(x * x / 2) * 0.3989422804014327;
  }

  std::array<double, 2 * reach * per_sigma + 1> density_{}, value_{};
};

const NormalCdf& normal_cdf() {
  static const NormalCdf cdf;
  return cdf;
}

// Shares of a unit blob in the pixels first..first + count - 1 along one axis.
struct AxisShares {
  static constexpr int capacity = 288;  // 2 x 5 sigma of the widest blob (grain of 100 px blurred by 10), and some
  int first = 0, count = 0;
  std::array<double, capacity> share{};
};

void axis_shares(double centre, double sigma, int pixels, AxisShares& axis) {
  const double reach = 5 * sigma + 0.5;
  axis.count = 0;
  if (!(centre + reach >= 0 && centre - reach <= pixels - 1)) return;  // also catches NaN
  axis.first = std::max(0, static_cast<int>(std::ceil(centre - reach)));
  const int last = std::min(pixels - 1, static_cast<int>(std::floor(centre + reach)));
  const NormalCdf& cdf = normal_cdf();
  double below = cdf((axis.first - 0.5 - centre) / sigma);
  for (int k = axis.first; k <= last && axis.count < AxisShares::capacity; ++k) {
    const double above = cdf((k + 0.5 - centre) / sigma);
    axis.share[std::size_t(axis.count++)] = above - below;
    below = above;
  }
}

// A Gaussian that is no longer round: its covariance, px^2.
struct Ellipse {
  double xx = 0, yy = 0, xy = 0, light = 1;
};

// F C F^T of a round blob of variance `own`, and the lens's blur. The light grows with the area.
Ellipse ellipse(const Mat2& F, double own, double blur) {
  // Polar parts in closed form: F F^T has the squares of the stretches as its principal values.
  Mat2 B = F * F.transpose();
  const double mean = (B(0, 0) + B(1, 1)) / 2, half = (B(0, 0) - B(1, 1)) / 2, radius = std::sqrt(half * half + B(0, 1) * B(0, 1));
  constexpr double most = 25;  // stretch of five, squared
  const double high = std::clamp(mean + radius, 1 / most, most), low = std::clamp(mean - radius, 1 / most, most);
  const double c = radius > 0 ? half / radius : 1, s = radius > 0 ? B(0, 1) / radius : 0;
  const double middle = (high + low) / 2, about = (high - low) / 2;
  return {own * (middle + about * c) + blur, own * (middle - about * c) + blur, own * about * s, std::sqrt(high * low)};
}

// Adds `amount` times the ellipse's share of each pixel: along columns by the normal distribution function, given the row;
// along rows by Gauss-Legendre with three points a pixel.
void add_ellipse(const Vec2& centre, const Ellipse& e, double amount, int width, int height, std::vector<float>& signal) {
  static constexpr std::array<double, 3> place{-0.3872983346207417, 0, 0.3872983346207417}, weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const double sy = std::sqrt(e.yy), sx = std::sqrt(e.xx), slope = e.xy / e.yy;
  const double given_row = std::sqrt(std::max(1e-6, e.xx - e.xy * slope));
  const double reach_y = 5 * sy + 0.5, reach_x = 5 * sx + 0.5;
  if (!(centre.x() + reach_x >= 0 && centre.x() - reach_x <= width - 1 && centre.y() + reach_y >= 0 && centre.y() - reach_y <= height - 1)) return;
  const int first_row = std::max(0, static_cast<int>(std::ceil(centre.y() - reach_y)));
  const int last_row = std::min(height - 1, static_cast<int>(std::floor(centre.y() + reach_y)));
  const NormalCdf& cdf = normal_cdf();
  for (int r = first_row; r <= last_row; ++r) {
    float* out = signal.data() + std::size_t(r) * std::size_t(width);
    for (std::size_t k = 0; k < place.size(); ++k) {
      const double dy = r + place[k] - centre.y();
      const double density = exp_of_negative(std::min(30.0, dy * dy / (2 * e.yy))) * 0.3989422804014327 / sy;
      const double x = centre.x() + slope * dy, reach = 5 * given_row + 0.5;
      const int first = std::max(0, static_cast<int>(std::ceil(x - reach)));
      const int last = std::min(width - 1, static_cast<int>(std::floor(x + reach)));
      double below = cdf((first - 0.5 - x) / given_row);
      for (int c = first; c <= last; ++c) {
        const double above = cdf((c + 0.5 - x) / given_row);
        out[c] += static_cast<float>(amount * weight[k] * density * (above - below));
        below = above;
      }
    }
  }
}

// Brightness in time: a triangle wave between 1 + change/2 and 1 - change/2 that takes the whole sequence, or eight
// frames of a longer one, for one half period. The two frames of a pair so differ by the whole change.
double light_in_time(double change, int frame, int frames) {
  const int half_period = std::clamp(frames - 1, 1, 8);
  const int phase = ((frame % (2 * half_period)) + 2 * half_period) % (2 * half_period);
  const double fall = static_cast<double>(phase <= half_period ? phase : 2 * half_period - phase) / half_period;
  return 1 + change * (0.5 - fall);
}

template <class Grey>
void quantise(std::span<const float> signal, int width, int height, double white, double noise, std::uint64_t key,
              Image& image) {
  for (int r = 0; r < height; ++r) {
    Grey* out = image.row<Grey>(r);
    const float* in = signal.data() + std::size_t(r) * std::size_t(width);
    for (int c = 0; c < width; ++c) {
      double grey = in[c];
      if (noise > 0) grey += noise * normal(key, std::uint64_t(r) * std::uint64_t(width) + std::uint64_t(c));
      out[c] = static_cast<Grey>(std::floor(std::clamp(grey, 0.0, white) + 0.5));
    }
  }
}

// Half to twice, even in the logarithm: exp2 by Taylor, since the last bits of libm differ between platforms.
double half_to_twice(double share) {
  const double x = (2 * share - 1) * 0.6931471805599453;
  double term = 1, sum = 1;
  for (int n = 1; n < 16; ++n) sum += term *= x / n;
  return sum;
}

}  // namespace

TextureOptions soil_texture() {
  TextureOptions texture;
  texture.kind = TextureKind::soil;
  texture.density_per_px = 0.2;
  texture.background = 0.45;
  texture.peak_min = 0.08;
  texture.peak_max = 0.28;
  return texture;
}

BlobRenderer::BlobRenderer(const TextureOptions& options, int width, int height)
    : options_(options), width_(width), height_(height) {
  if (options.bits != 8 && options.bits != 12 && options.bits != 16)
    throw InputError("texture bits: found " + std::to_string(options.bits) + ", expected 8, 12 or 16");
  if (width < 1 || height < 1)
    throw InputError("synthetic image: found " + std::to_string(width) + " x " + std::to_string(height) +
                     " px, expected at least 1 x 1");
  if (!(options.blob_diameter_px >= 0.5 && options.blob_diameter_px <= 50))
    throw InputError("texture blob_diameter_px: found " + std::to_string(options.blob_diameter_px) +
                     ", expected 0.5 to 50");
  if (!(options.blur_px >= 0 && options.blur_px <= 10))
    throw InputError("texture blur_px: found " + std::to_string(options.blur_px) + ", expected 0 to 10");
}

Image BlobRenderer::draw(std::span<const Vec2> centres_px, int frame, int frames, std::span<const Mat2> shapes) const {
  const double white = options_.bits == 8 ? 255.0 : options_.bits == 12 ? 4095.0 : 65535.0;
  const bool soil = options_.kind == TextureKind::soil;
  const std::uint64_t peaks = stream_key(options_.seed, Stream::peak, 0),
                      grains = stream_key(options_.seed, Stream::grain, 0);

  std::vector<float> signal(std::size_t(width_) * std::size_t(height_),
                            static_cast<float>(options_.background * white));
  AxisShares columns, rows;
  for (std::size_t blob = 0; blob < centres_px.size(); ++blob) {
    double sigma = options_.blob_diameter_px / 4;
    double peak = options_.peak_min + (options_.peak_max - options_.peak_min) * uniform01(mix(peaks + blob));
    if (soil) {
      const std::uint64_t bits = mix(grains + blob);
      sigma *= half_to_twice(uniform01(bits));
      if (bits & 1) peak = -peak;  // below the bits of the size
    }
    const double centred = 2 * normal_cdf()(0.5 / sigma) - 1;  // share of a centred blob in its pixel, per axis
    const double peak_scale = white / (centred * centred);
    if (!shapes.empty()) {
      const Ellipse e = ellipse(shapes[blob], sigma * sigma, options_.blur_px * options_.blur_px);
      add_ellipse(centres_px[blob], e, peak * peak_scale * e.light, width_, height_, signal);
      continue;
    }
    const double seen = options_.blur_px > 0 ? std::sqrt(sigma * sigma + options_.blur_px * options_.blur_px) : sigma;
    axis_shares(centres_px[blob].x(), seen, width_, columns);
    axis_shares(centres_px[blob].y(), seen, height_, rows);
    for (int r = 0; r < rows.count; ++r) {
      float* out = signal.data() + std::size_t(rows.first + r) * std::size_t(width_) + columns.first;
      const double amount = peak * peak_scale * rows.share[std::size_t(r)];
      for (int c = 0; c < columns.count; ++c) out[c] += static_cast<float>(amount * columns.share[std::size_t(c)]);
    }
  }

  const double now = light_in_time(options_.light_change, frame, frames);
  const double per_column = width_ > 1 ? options_.light_slope / (width_ - 1) : 0.0;
  for (int r = 0; r < height_; ++r) {
    float* out = signal.data() + std::size_t(r) * std::size_t(width_);
    for (int c = 0; c < width_; ++c) out[c] = static_cast<float>(std::min(white, out[c] * now * (1 - per_column * c)));
  }

  Image image(width_, height_, options_.bits == 8 ? PixelDepth::u8 : PixelDepth::u16, static_cast<float>(white));
  const std::uint64_t key = stream_key(options_.seed, Stream::noise, static_cast<std::uint64_t>(frame) + 1);
  if (options_.bits == 8)
    quantise<std::uint8_t>(signal, width_, height_, white, options_.noise * white, key, image);
  else
    quantise<std::uint16_t>(signal, width_, height_, white, options_.noise * white, key, image);
  return image;
}

std::vector<std::size_t> BlobRenderer::lost(std::size_t blobs, int frame) const {
  const std::uint64_t key = stream_key(options_.seed, Stream::loss, static_cast<std::uint64_t>(frame) + 1);
  std::vector<std::size_t> indices;
  for (std::size_t blob = 0; blob < blobs; ++blob)
    if (uniform01(mix(key + blob)) < options_.loss) indices.push_back(blob);
  return indices;
}

}  // namespace pivnp::image

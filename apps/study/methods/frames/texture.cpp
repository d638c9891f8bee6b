#include "apps/study/methods/frames/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "apps/study/pipeline/measure/statistics.hpp"

namespace pivnp::app {

struct CarriedTexture::Moments {
  double mean = 0, variance = 0;
};

namespace {

// Coefficients of the interpolating cubic B-spline, mirrored at the edges (Unser, Aldroubi & Eden 1993).
void prefilter(std::vector<double>& line) {
  const double z = std::sqrt(3.0) - 2;
  const std::size_t n = line.size();
  if (n < 2) return;
  double first = 0, power = 1;
  for (std::size_t k = 0; k < std::min<std::size_t>(n, 30); ++k, power *= z) first += power * line[k];
  for (double& v : line) v *= 6;
  line[0] = 6 * first;
  for (std::size_t k = 1; k < n; ++k) line[k] += z * line[k - 1];
  line[n - 1] = z / (z * z - 1) * (line[n - 1] + z * line[n - 2]);
  for (std::size_t k = n - 1; k-- > 0;) line[k] = z * (line[k + 1] - line[k]);
}

int mirrored(int k, int n) {
  if (n == 1) return 0;
  const int period = 2 * (n - 1);
  k = std::abs(k) % period;
  return k < n ? k : period - k;
}

}  // namespace

CarriedTexture::Grey CarriedTexture::grey_of(const ImageView& image) {
  Grey g{image.width, image.height, std::vector<float>(std::size_t(image.width) * std::size_t(image.height))};
  for (int r = 0; r < image.height; ++r)
    for (int c = 0; c < image.width; ++c)
      g.at(c, r) = image.depth == PixelDepth::u8    ? float(image.row<std::uint8_t>(r)[c])
                   : image.depth == PixelDepth::u16 ? float(image.row<std::uint16_t>(r)[c])
                                                    : image.row<float>(r)[c];
  return g;
}

CarriedTexture::Moments CarriedTexture::moments(const Grey& g, int c0, int c1, int r0, int r1) {
  double sum = 0, square = 0;
  const int left = std::max(0, c0), right = std::min(g.width - 1, c1), top = std::max(0, r0),
            bottom = std::min(g.height - 1, r1);
  const double n = double(right - left + 1) * double(bottom - top + 1);
  for (int r = top; r <= bottom; ++r)
    for (int c = left; c <= right; ++c) {
      sum += double(g.at(c, r));
      square += double(g.at(c, r)) * double(g.at(c, r));
    }
  return {sum / n, std::max(0.0, square / n - (sum / n) * (sum / n))};
}

CarriedTexture::Grey CarriedTexture::without_noise(const Grey& g, double noise) {
  Grey out = g;
  for (int r = 0; r < g.height; ++r)
    for (int c = 0; c < g.width; ++c) {
      const Moments m = moments(g, c - 1, c + 1, r - 1, r + 1);
      const double share = m.variance > 0 ? std::max(0.0, m.variance - noise) / std::max(m.variance, noise) : 0;
      out.at(c, r) = float(m.mean + share * (double(g.at(c, r)) - m.mean));
    }
  return out;
}

CarriedTexture::Grey CarriedTexture::coefficients(const Grey& g) {
  Grey out = g;
  std::vector<double> line;
  for (int r = 0; r < g.height; ++r) {
    line.assign(out.value.begin() + std::ptrdiff_t(r) * g.width, out.value.begin() + std::ptrdiff_t(r + 1) * g.width);
    prefilter(line);
    for (int c = 0; c < g.width; ++c) out.at(c, r) = float(line[std::size_t(c)]);
  }
  for (int c = 0; c < g.width; ++c) {
    line.clear();
    for (int r = 0; r < g.height; ++r) line.push_back(double(out.at(c, r)));
    prefilter(line);
    for (int r = 0; r < g.height; ++r) out.at(c, r) = float(line[std::size_t(r)]);
  }
  return out;
}

double CarriedTexture::at(const Vec2& px) const {
  const double fc = std::floor(px.x()), fr = std::floor(px.y());
  const auto weights = [](double t) {
    const double s = 1 - t;
    return std::array<double, 4>{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                                 (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
  };
  const auto wc = weights(px.x() - fc), wr = weights(px.y() - fr);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += wr[std::size_t(j)] * wc[std::size_t(i)] *
             double(spline_.at(mirrored(int(fc) - 1 + i, spline_.width), mirrored(int(fr) - 1 + j, spline_.height)));
  return sum;
}

CarriedTexture::Grey CarriedTexture::blurred(const Grey& g, double sigma) {
  if (!(sigma > 0)) return g;
  const int reach = int(std::ceil(4 * sigma));
  std::vector<double> weight;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) sum += weight.emplace_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  Grey rows = g, out = g;
  for (int r = 0; r < g.height; ++r)
    for (int c = 0; c < g.width; ++c) {
      double value = 0;
      for (int k = -reach; k <= reach; ++k) value += weight[std::size_t(k + reach)] * double(g.at(mirrored(c + k, g.width), r));
      rows.at(c, r) = float(value / sum);
    }
  for (int r = 0; r < g.height; ++r)
    for (int c = 0; c < g.width; ++c) {
      double value = 0;
      for (int k = -reach; k <= reach; ++k) value += weight[std::size_t(k + reach)] * double(rows.at(c, mirrored(r + k, g.height)));
      out.at(c, r) = float(value / sum);
    }
  return out;
}

CarriedTexture::CarriedTexture(const Image& frame, double noise, double blur, NoiseShape shape)
    : still_(blurred(without_noise(grey_of(frame.view()), noise), blur)), spline_(coefficients(still_)), noise_(std::sqrt(noise)),
      shape_(std::move(shape)), depth_(frame.depth()), white_(frame.white()) {}

Image CarriedTexture::draw(const std::function<double(int, int)>& grey, std::uint64_t seed, std::uint64_t number) const {
  const double most = depth_ == PixelDepth::u8 ? 255 : depth_ == PixelDepth::u16 ? 65535 : double(white_);
  const std::vector<float> noise = noise_ > 0 ? shape_.draw(width(), height(), seed + 7919 * (number + 1)) : std::vector<float>();
  Image image(width(), height(), depth_, white_);
  for (int r = 0; r < height(); ++r)
    for (int c = 0; c < width(); ++c) {
      const std::size_t k = std::size_t(r) * std::size_t(width()) + std::size_t(c);
      const double value = std::clamp(grey(c, r) + (noise.empty() ? 0 : noise_ * double(noise[k])), 0.0, most);
      if (depth_ == PixelDepth::u8) image.row<std::uint8_t>(r)[c] = std::uint8_t(std::lround(value));
      else if (depth_ == PixelDepth::u16) image.row<std::uint16_t>(r)[c] = std::uint16_t(std::lround(value));
      else image.row<float>(r)[c] = float(value);
    }
  return image;
}

double noise_variance(const ImageView& first, const std::vector<Vec2>& nodes_px, int window_px,
                      const std::vector<VectorField>& pairs) {
  const CarriedTexture::Grey g = CarriedTexture::grey_of(first);
  const int half = window_px / 2;
  double best_score = -1, noise = 0;
  for (const VectorField& pair : pairs) {
    std::vector<double> scores, found;
    for (std::size_t n = 0; n < pair.score.size(); ++n) {
      if (pair.status[n] != VectorStatus::valid || !std::isfinite(pair.score[n])) continue;
      const int c = int(std::lround(nodes_px[n].x())), r = int(std::lround(nodes_px[n].y()));
      scores.push_back(double(pair.score[n]));
      found.push_back(std::max(0.0, 1 - double(pair.score[n])) *
                      CarriedTexture::moments(g, c - half, c + half, r - half, r + half).variance);
    }
    const double score = median(scores, std::nan(""));
    if (!(score > best_score)) continue;
    best_score = score;
    noise = median(found, std::nan(""));
  }
  return noise;
}

}  // namespace pivnp::app

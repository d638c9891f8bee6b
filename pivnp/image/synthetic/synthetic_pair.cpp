#include "pivnp/image/synthetic/synthetic_pair.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace pivnp::image {

namespace {

constexpr double tilt = 5 * std::numbers::pi / 180;

std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

// Number k of the places' random sequence: splitmix64 (Steele, Lea & Flood 2014).
double random01(int seed, std::uint64_t k) {
  return static_cast<double>(mix_bits((static_cast<std::uint64_t>(seed) << 40) + (k + 1) * 0x9e3779b97f4a7c15ull) >> 11) *
         0x1.0p-53;
}

}  // namespace

Motion uniform(double u, double v) {
  return [=](const Vec2&) { return Vec2(u, v); };
}

Motion rotation(double degrees, double cx, double cy) {
  const double a = degrees * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
  return [=](const Vec2& p) {
    const double x = p.x() - cx, y = p.y() - cy;
    return Vec2(c * x - s * y - x, s * x + c * y - y);
  };
}

Motion plain_shear(double slope, double middle) {
  return [=](const Vec2& p) { return Vec2(slope * (p.y() - middle), 0); };
}

Motion triangle_shear(double slope) {
  return [=](const Vec2& p) {
    const double phase = p.y() / 256 - std::floor(p.y() / 256);
    return Vec2(slope * 64 * (phase < 0.5 ? 4 * phase - 1 : 3 - 4 * phase), 0);
  };
}

Motion sine(double amplitude, double length) {
  const double c = std::cos(tilt), s = std::sin(tilt);
  return [=](const Vec2& p) {
    const double a = amplitude * std::sin(2 * std::numbers::pi * (-s * p.x() + c * p.y()) / length);
    return Vec2(a * c, a * s);
  };
}

Motion band(double amplitude, double half_width, double cx, double cy) {
  const double c = std::cos(tilt), s = std::sin(tilt);
  return [=](const Vec2& p) {
    const double a = amplitude * std::tanh((-s * (p.x() - cx) + c * (p.y() - cy)) / half_width);
    return Vec2(a * c, a * s);
  };
}

Motion vortex(double amplitude, double radius, double cx, double cy) {
  return [=](const Vec2& p) {
    const Vec2 r = Vec2(p.x() - cx, p.y() - cy) / radius;
    const double a = amplitude * std::exp(0.5 * (1 - r.squaredNorm()));
    return Vec2(-a * r.y(), a * r.x());
  };
}

Motion strain_concentration(double far, double peak, double sigma, double cx, double cy) {
  const double reach = peak * sigma * std::sqrt(std::numbers::pi / 2);
  return [=](const Vec2& p) {
    const double x = p.x() - cx, y = (p.y() - cy) / sigma;
    return Vec2(far * x + reach * std::erf(x / (sigma * std::numbers::sqrt2)) * std::exp(-0.5 * y * y), 0);
  };
}

Vec2 displacement_at(const Motion& motion, const Vec2& place, Anchor anchor) {
  if (anchor == Anchor::forward) return motion(place);
  Vec2 start = place;
  for (int k = 0; k < 60; ++k) start = place - 0.5 * motion(start);
  return motion(start);
}

SyntheticPair synthetic_pair(Motion motion, int width, int height, const TextureOptions& texture) {
  constexpr double margin = 48;
  const double across = width + 2 * margin, down = height + 2 * margin;
  const auto place = [&](std::uint64_t k) {
    return Vec2(random01(texture.seed, 2 * k) * across - margin - 0.5,
                random01(texture.seed, 2 * k + 1) * down - margin - 0.5);
  };
  const BlobRenderer renderer(texture, width, height);
  const auto count = static_cast<std::size_t>(texture.density_per_px * across * down);
  std::vector<Vec2> before(count), after(count);
  for (std::size_t k = 0; k < count; ++k) before[k] = place(k), after[k] = before[k] + motion(before[k]);
  for (const std::size_t k : renderer.lost(count, 1)) after[k] = place(count + k);
  return {std::move(motion), width, height, renderer.draw(before, 0, 2), renderer.draw(after, 1, 2)};
}

}  // namespace pivnp::image

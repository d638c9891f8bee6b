// Frames of opaque, shaded grains that a map carries: drawn by discs that hide each other, sampled three by three in each
// pixel. Shares nothing with the texture of the library (blobs that add up).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace pivnp::grains {

struct Soil {
  std::string name;
  double least_px, most_px;  // diameters, even in the logarithm
  double dark, bright;       // grey values, 0 to 255
  double gloss = 0;          // share of white in a highlight
  double flock = 0;          // share of grains that are dark fibres six times as long as wide
};

inline std::vector<Soil> soils() {
  return {{"fine sand", 2, 4, 70, 190},
          {"coarse sand", 6, 12, 60, 200},
          {"clay with flock", 2, 4, 105, 135, 0, 0.03},
          {"glass beads", 4.5, 5.5, 80, 150, 0.8}};
}

struct Place {
  double x, y;  // column, row
};

struct Scene {
  Soil soil;
  int width = 256, height = 256;
  unsigned seed = 1;
  double noise = 2;                                        // standard deviation, grey values
  std::function<Place(Place, int)> place;                  // where the material at X in frame 0 is in frame k
  std::function<int(Place)> body = [](Place) { return 0; };  // of X in frame 0: bodies of higher number hide others
  std::function<bool(double, double, int, int)> holds;     // whether body b may show at (column, row) in frame k; empty: yes
  std::function<double(double, double, int)> light;        // factor; empty: 1
  std::function<double(double, double)> on_glass;          // added grey values; empty: 0
};

/// Frame k as grey values, row by row.
inline std::vector<std::uint8_t> draw(const Scene& s, int k) {
  constexpr int fine = 3, margin = 80;
  std::mt19937 random(s.seed);
  const auto uniform = [&] { return double(random()) / 4294967296.0; };
  const int across = s.width * fine, down = s.height * fine;
  std::vector<float> grey(std::size_t(across) * std::size_t(down), float(s.soil.dark) * 0.5f);
  const double mean = std::sqrt(s.soil.least_px * s.soil.most_px), field = double(s.width + 2 * margin) * (s.height + 2 * margin);
  const auto count = std::size_t(3.0 * field / (M_PI / 4 * mean * mean));
  for (std::size_t n = 0; n < count; ++n) {
    const Place from{uniform() * (s.width + 2 * margin) - margin, uniform() * (s.height + 2 * margin) - margin};
    const double radius = fine / 2.0 * s.soil.least_px * std::pow(s.soil.most_px / s.soil.least_px, uniform());
    double shade = s.soil.dark + (s.soil.bright - s.soil.dark) * uniform();
    const bool fibre = uniform() < s.soil.flock;
    const double angle = M_PI * uniform(), length = fibre ? 6 : 1;
    if (fibre) shade = 0.3 * s.soil.dark;
    const int body = s.body(from);
    const Place at = s.place(from, k);
    const double x = (at.x + 0.5) * fine - 0.5, y = (at.y + 0.5) * fine - 0.5, reach = radius * length + 1;
    const double c = std::cos(angle), t = std::sin(angle);
    for (int r = std::max(0, int(std::ceil(y - reach))); r <= std::min(down - 1, int(y + reach)); ++r)
      for (int q = std::max(0, int(std::ceil(x - reach))); q <= std::min(across - 1, int(x + reach)); ++q) {
        if (s.holds && !s.holds((q + 0.5) / fine - 0.5, (r + 0.5) / fine - 0.5, body, k)) continue;
        const double a = (c * (q - x) + t * (r - y)) / length, b = c * (r - y) - t * (q - x), off = std::hypot(a, b) / radius;
        const double covered = std::clamp((1 - off) * radius + 0.5, 0.0, 1.0);
        if (!(covered > 0)) continue;
        double value = shade * (1 - 0.45 * off * off - 0.15 * ((q - x) + (r - y)) / (radius * length));
        if (s.soil.gloss > 0)
          value += 255 * s.soil.gloss * std::exp(-8 * (std::pow((q - x) / radius + 0.35, 2) + std::pow((r - y) / radius + 0.35, 2)));
        float& pixel = grey[std::size_t(r) * std::size_t(across) + std::size_t(q)];
        pixel = float((1 - covered) * double(pixel) + covered * std::min(value, 255.0));
      }
  }
  std::mt19937 own(s.seed * 7919u + unsigned(k) * 104729u + 17u);
  std::vector<std::uint8_t> out(std::size_t(s.width) * std::size_t(s.height));
  for (int r = 0; r < s.height; ++r)
    for (int q = 0; q < s.width; ++q) {
      double value = 0;
      for (int b = 0; b < fine; ++b)
        for (int a = 0; a < fine; ++a) value += double(grey[std::size_t(r * fine + b) * std::size_t(across) + std::size_t(q * fine + a)]) / (fine * fine);
      if (s.light) value *= s.light(q, r, k);
      if (s.on_glass) value += s.on_glass(q, r);
      double normal = -6;
      for (int i = 0; i < 12; ++i) normal += double(own()) / 4294967296.0;
      out[std::size_t(r) * std::size_t(s.width) + std::size_t(q)] = std::uint8_t(std::lround(std::clamp(value + s.noise * normal, 0.0, 255.0)));
    }
  return out;
}

}  // namespace pivnp::grains

// Synthetic frames with known truth: blobs integrated over pixels, drawn where a motion carried them.
// The texture's carrier is the caller's (an analytic map, a tracer's own integration), never the gather under test.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::image {

enum class TextureKind { blobs, soil };
inline constexpr std::array texture_kind_names{NamedValue{"blobs", TextureKind::blobs},
                                               NamedValue{"soil", TextureKind::soil}};
constexpr const auto& names_of(TextureKind) { return texture_kind_names; }

struct TextureOptions {
  TextureKind kind = TextureKind::blobs;
  double density_per_px = 0.05;
  double blob_diameter_px = 3.0;
  double peak_min = 85.0 / 255.0;
  double peak_max = 170.0 / 255.0;
  double background = 10.0 / 255.0;
  double blur_px = 0.0;
  double noise = 0.0;
  double loss = 0.0;
  double light_slope = 0.0;
  double light_change = 0.0;
  int bits = 8;
  int seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("kind", self.kind,
          OptionInfo{.text = "blobs: of one size, bright; soil: half to twice the diameter, bright and dark"});
    visit("density_per_px", self.density_per_px,
          OptionInfo{.unit = "1/px^2", .text = "blobs per pixel", .min = 0, .above_min = true});
    visit("blob_diameter_px", self.blob_diameter_px,
          OptionInfo{.unit = "px", .text = "four standard deviations of a blob", .min = 0.5, .max = 50});
    visit("peak_min", self.peak_min, OptionInfo{.text = "least peak of a centred blob, fraction of white", .min = 0, .max = 1});
    visit("peak_max", self.peak_max, OptionInfo{.text = "greatest peak", .min = 0, .max = 1});
    visit("background", self.background, OptionInfo{.text = "grey value without blobs, fraction of white", .min = 0, .max = 1});
    visit("blur_px", self.blur_px,
          OptionInfo{.unit = "px", .text = "standard deviation of the lens's blur", .min = 0, .max = 10});
    visit("noise", self.noise, OptionInfo{.text = "standard deviation of the noise, fraction of white", .min = 0, .max = 1});
    visit("loss", self.loss, OptionInfo{.text = "fraction of blobs replaced per frame", .min = 0, .max = 1});
    visit("light_slope", self.light_slope, OptionInfo{.text = "fall of the light across the image's width, as a fraction", .min = 0, .max = 1});
    visit("light_change", self.light_change, OptionInfo{.text = "variation of the light in time, as a fraction", .min = 0, .max = 1});
    visit("bits", self.bits, OptionInfo{.text = "bits per pixel: 8, 12 or 16", .min = 8, .max = 16});
    visit("seed", self.seed, OptionInfo{.text = "seed of the random numbers"});
  }
};

/// Dense, of several sizes, about a mid grey: what sand looks like from some distance.
TextureOptions soil_texture();

/// Draws blobs: each is a Gaussian of sigma = diameter/4 with its own peak (drawn from the seed and the blob's index),
/// integrated over each pixel; overlapping blobs add, the sum is clipped at white. Of kind soil, each has its own
/// diameter and sign too. Blur widens the blobs and keeps their light. Noise and light are added before rounding. Same
/// seed, same bits.
class BlobRenderer {
 public:
  BlobRenderer(const TextureOptions& options, int width, int height);
  /// `centres_px` (column, row) of every blob; those outside the image are cut. `frame` seeds the frame's noise and
  /// the phase of light_change; `frames` is the length of the sequence. `shapes`: one a blob, the deformation gradient
  /// in pixels (column, row) that has made an ellipse of it (stretches are held to 1/5 ... 5, its light to its area);
  /// empty: all are round.
  Image draw(std::span<const Vec2> centres_px, int frame, int frames, std::span<const Mat2> shapes = {}) const;
  /// Indices of the blobs that are lost (replaced by a blob elsewhere) in `frame`: the caller re-places them.
  std::vector<std::size_t> lost(std::size_t blobs, int frame) const;

 private:
  TextureOptions options_;
  int width_, height_;
};

}  // namespace pivnp::image

// Pixels of a frame that show no material, found in the frame itself.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/image_view.hpp"

namespace pivnp::image {

/// By what air is told from material.
enum class AirKind { none, texture, still };
inline constexpr std::array air_kind_names{NamedValue{"none", AirKind::none}, NamedValue{"texture", AirKind::texture},
                                           NamedValue{"still", AirKind::still}};
constexpr const auto& names_of(AirKind) { return air_kind_names; }

inline constexpr int air_window_px = 15;  // side of the windows that are judged

/// Windows without texture: the standard deviation of grey values is below what parts the two classes of the frame's windows
/// (Otsu 1979, on its logarithm). Air is every pixel of such a window, so that it ends where texture begins. Where the classes
/// differ by less than a factor of three, the frame has one of them only, and nothing is air. Groups of fewer than 2 windows'
/// pixels change sides. One byte a pixel, 1 = air.
std::vector<std::uint8_t> air_without_texture(const ImageView& image);

/// A background that stays as it was: of what lies outside the material in the first frame, what still looks the same.
class StillBackground {
 public:
  StillBackground() = default;
  /// `material`: one byte a pixel, 1 where material is in the first frame. How far windows differ though nothing moves is the
  /// median outside it from the first frame to the second.
  StillBackground(const ImageView& first, const ImageView& second, std::vector<std::uint8_t> material);
  bool empty() const { return material_.empty(); }
  std::vector<std::uint8_t> find(const ImageView& image) const;

 private:
  std::vector<float> first_;
  std::vector<std::uint8_t> material_;
  double most_ = 0;  // variance of the difference within a window
};

/// Pixels within `reach` rows and columns of a marked one are marked too.
void grow(std::vector<std::uint8_t>& covered, int width, int height, int reach);

}  // namespace pivnp::image

// Where a subset of one frame is in another, to whole pixels.
#pragma once

#include <optional>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::piv {

struct SearchHit {
  Vec2 to = Vec2::Zero();  // px
  double score = 0;        // zero-normalised correlation coefficient there
};

/// The shift by at most `reach_px` along columns and rows from `expected` at which the square of `side_px` about `from`
/// (rounded to whole pixels) correlates best, zero mean and normalised. Nothing where the square does not lie in the first
/// image, no shift of it in the second, or it has no texture.
std::optional<SearchHit> search_subset(const ImageView& first, const ImageView& second, const Vec2& from, const Vec2& expected,
                                       int side_px, int reach_px);

}  // namespace pivnp::piv

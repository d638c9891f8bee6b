// How the frames share a displacement.
#pragma once

#include "pivnp/core/record/vector_status.hpp"

namespace pivnp::piv {

/// The frames show the same material at x + first d and x + second d, d the displacement at x.
struct AnchorShares {
  float first = -0.5f, second = 0.5f;
};

inline AnchorShares shares_of(Anchor anchor) {
  return anchor == Anchor::central ? AnchorShares{-0.5f, 0.5f} : AnchorShares{0.0f, 1.0f};
}

}  // namespace pivnp::piv

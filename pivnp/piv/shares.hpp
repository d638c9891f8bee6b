// How the frames share a displacement.
#pragma once

namespace pivnp::piv {

/// The frames show the same material at x + first d and x + second d, d the displacement at x.
struct AnchorShares {
  float first = -0.5f, second = 0.5f;
};

}  // namespace pivnp::piv

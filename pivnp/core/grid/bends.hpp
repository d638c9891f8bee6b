// How sharply a smoothed field bent before it was smoothed.
#pragma once

#include <array>
#include <vector>

namespace pivnp {

/// Laplacians of a smoothed field, [ny][nx][2] in any unit, times
///   1/(1 - (q/3)^2),   q^2 = sum (second differences of L)^2 / sum L^2   over 3 x 3 nodes, 2.7^2 at most,
/// which for l^2 laplacian(F) makes up for what smoothing and differences over a spacing h = 2 l ... 8 l took off them:
/// 1.05, 1.5 and 2.5 for bands of tanh(s/w), w = 2.7, 0.9 and 0.5 h and l = h/4.
/// Beyond the border L is as on it.
void sharpen_bends(int nx, int ny, std::vector<std::array<float, 2>>& bends);

}  // namespace pivnp

#include "pivnp/core/grid/bends.hpp"

#include <algorithm>
#include <cstddef>

namespace pivnp {

void sharpen_bends(int nx, int ny, std::vector<std::array<float, 2>>& bends) {
  constexpr float most = 2.7f * 2.7f;
  const auto at = [&](int i, int j) -> const std::array<float, 2>& {
    return bends[std::size_t(std::clamp(j, 0, ny - 1)) * std::size_t(nx) + std::size_t(std::clamp(i, 0, nx - 1))];
  };
  std::vector<std::array<float, 2>> squares(bends.size());  // of the differences, of L
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      std::array<float, 2> out{0, 0};
      for (std::size_t c = 0; c < 2; ++c) {
        const float here = at(i, j)[c], around = at(i - 1, j)[c] + at(i + 1, j)[c] + at(i, j - 1)[c] + at(i, j + 1)[c],
                    second = around - 4 * here;
        out[0] += second * second, out[1] += here * here;
      }
      squares[std::size_t(j) * std::size_t(nx) + std::size_t(i)] = out;
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      float differences = 0, bent = 0;
      for (int b = std::max(0, j - 1); b <= std::min(ny - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(nx - 1, i + 1); ++a) {
          const std::array<float, 2>& of = squares[std::size_t(b) * std::size_t(nx) + std::size_t(a)];
          differences += of[0], bent += of[1];
        }
      if (!(bent > 0)) continue;
      const float factor = 1 / (1 - std::min(most, differences / bent) / 9);
      for (float& value : bends[std::size_t(j) * std::size_t(nx) + std::size_t(i)]) value *= factor;
    }
}

}  // namespace pivnp

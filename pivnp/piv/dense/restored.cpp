#include "pivnp/piv/dense/restored.hpp"

namespace pivnp::piv {

void restore_measured(const CellLattice& lattice, const std::vector<float>& instead, const std::vector<float>& about,
                      const std::vector<std::uint8_t>& known, int threads, std::vector<float>& measured) {
  constexpr float hats = 1.0f / 12;
  constexpr float not_stepped = 0.3f;  // measured on sequences of known motion, with what shrinkage takes off; 0.45 and more add noise
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      if (!known[k]) continue;
      const float lack = instead[k] - about[k];
      float bend = 0;
      const auto against = [&](int a, int b) {
        if (a < 0 || b < 0 || a >= lattice.nx || b >= lattice.ny) return;
        const std::size_t to = lattice.index(a, b);
        if (known[to]) bend += lack - (instead[to] - about[to]);
      };
      against(i - 1, j), against(i + 1, j), against(i, j - 1), against(i, j + 1);
      measured[k] += not_stepped * lack + hats * bend;
    }
}

}  // namespace pivnp::piv

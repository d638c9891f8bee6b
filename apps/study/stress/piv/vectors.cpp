#include "apps/study/stress/piv/vectors.hpp"

#include "apps/case/fields.hpp"
#include "pivnp/piv/validation/block_edges.hpp"

namespace pivnp::app {

std::string words_of(const piv::PivOptions& options) { return write_fields(options); }

Survival measured(const piv::PivOptions& options, const piv::NodeLattice& nodes, const KnownFrames& frames, const std::vector<std::uint8_t>& scored) {
  piv::PivOptions own = options;
  own.replace = false;  // a vector that was replaced would hide what was measured
  piv::PairCorrelator correlator(own, nodes, frames.first.width(), frames.first.height(), 1);
  const piv::PixelVectors found = correlator.correlate(frames.first.view(), frames.second.view(), frames.mask);
  const bool blocks = piv::block_edge_ratio(frames.first.view(), frames.mask) > piv::most_block_edges;  // a run warns of such frames
  Survival s;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (!scored.empty() && !scored[k]) continue;
    if (found.status[k] == VectorStatus::failed || found.status[k] == VectorStatus::masked) {
      s.count_none();
      continue;
    }
    const Vec2 place(double(nodes.pixel[k][0]), double(nodes.pixel[k][1]));
    const Vec2 value(double(found.displacement[k][0]), double(found.displacement[k][1]));
    s.count((value - frames.truth(place, found.anchor)).norm(), vector_bounds, !blocks && found.status[k] == VectorStatus::valid);
  }
  return s;
}

}  // namespace pivnp::app

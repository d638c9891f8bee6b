#include "pivnp/piv/dense/gn_level.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::piv {

namespace {

constexpr int margin = 2;  // cells beyond the outermost nodes

CellLattice lattice_of(const Extent& extent, const Level& level, int step) {
  CellLattice lattice;
  lattice.step = step;
  const Box box =
      bounding_box(extent.nodes, static_cast<float>(margin * step * level.decimation), extent.width, extent.height);
  const auto place = [&](int first, int end, int& origin, int& points) {
    const float from = level.from_full(static_cast<float>(first)), to = level.from_full(static_cast<float>(end - 1));
    const int cells = static_cast<int>(std::ceil((to - from) / static_cast<float>(step)));
    points = std::max(least_lattice_points, cells + 1);
    // Centred, so that what the lattice has too much is the same on both sides.
    origin = static_cast<int>(std::floor(from - 0.5f * (static_cast<float>((points - 1) * step) - (to - from))));
  };
  place(box.x0, box.x1, lattice.x0, lattice.nx);
  place(box.y0, box.y1, lattice.y0, lattice.ny);
  return lattice;
}

}  // namespace

GnLevel::GnLevel(const Extent& extent, int decimation, int window_px, int passes)
    : mask_(extent.mask),
      own_{.decimation = decimation, .first = {}, .second = {}, .mask = {}, .first_mask = {}},
      lattice_(lattice_of(extent, own_, std::max(2, window_px / 4))),
      shrinker_(lattice_),
      passes_(passes) {
  masked_.take_mask(mask_, decimation);
  const NodeLattice& nodes = extent.nodes;
  if (nodes.on.empty()) return;
  const float reach = std::max(node_spacing(nodes), static_cast<float>(margin * lattice_.step * own_.decimation));
  wanted_ = nodes_near(even(), nodes, reach).on;
}

EvenLattice GnLevel::even() const {
  const auto step = static_cast<float>(lattice_.step * own_.decimation);
  return {lattice_.nx, lattice_.ny, column(0), row(0), step, step};
}

void GnLevel::take(const ImageView& first, const ImageView& second, float smoothing, int threads, const Level* shared) {
  images_ = shared != nullptr ? shared : &own_;
  if (shared == nullptr) {
    own_.first.assign(first, mask_, own_.decimation, threads, smoothing);
    own_.second.assign(second, mask_, own_.decimation, threads, smoothing);
  }
  if (own_.decimation == 1) {
    first_flags_.take(first, has_first_mask_ ? first_masked_ : masked_);
    second_flags_.take(second, masked_);
  }
}

}  // namespace pivnp::piv

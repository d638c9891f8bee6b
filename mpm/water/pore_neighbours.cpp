// What the water meets beside the material: rigid bodies, other bodies of material, and the opposite of two tied sides.
#include <algorithm>

#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

namespace {

constexpr double sealed_margin = 0.5;  // cells: material that touches a body may stay so far from it

}  // namespace

bool PoreWater::covered(const GridState& g, std::size_t element, double time) const {
  if (bodies_->empty()) return false;
  const Vec2& h = g.grid.spacing;
  return bodies_->cover(g.position(element) + 0.5 * h, time, sealed_margin * h.minCoeff());
}

// The second node's potential less the first one's, where pressures are the same.
double PoreWater::head_across(const GridState& g, const TiedSides::Tie& tie, const Vec2& gravity) const {
  return head(g.position(tie.node[0]), gravity) - head(g.position(tie.node[1]), gravity);
}

// Tied nodes are one node of the flow: each has the sums of both, and its own frame of the potential. Edges and elements are one
// side's alone.
void PoreWater::tie_sums(const GridState& g, const Vec2& gravity, double time) {
  joined_.clear();
  for (const TiedSides::Tie& tie : ties_->ties()) {
    PoreNode &a = sums_.node[tie.node[0]], &b = sums_.node[tie.node[1]];
    const double volume = a.volume + b.volume, of_a = alike_.own ? a.mobile : a.volume, of_b = alike_.own ? b.mobile : b.volume,
                 weight = of_a + of_b;
    if (time >= tie.until || !(of_a > 0 && of_b > 0)) continue;
    joined_.push_back({&tie, {of_a / weight, of_b / weight}, {a.potential / of_a, b.potential / of_b}, 0, 0});
    const double across = head_across(g, tie, gravity), potential = a.potential + b.potential - across * of_b;
    a.volume = b.volume = volume;
    a.potential = potential;
    b.potential = potential + across * weight;
    a.strained = b.strained = a.strained + b.strained;
    a.mobile = b.mobile = a.mobile + b.mobile;
  }
}

// Where one of them has a given potential, so has the other.
void PoreWater::tie_given(const GridState& g, const Vec2& gravity) {
  for (const Joined& joined : joined_) {
    const auto found = [&](int side) {
      return std::find_if(given_.begin(), given_.end(), [&](const Given& at) { return at.node == joined.tie->node[side]; });
    };
    for (const int side : {0, 1}) {
      const auto here = found(side), there = found(1 - side);
      if (here == given_.end()) continue;
      here->share = joined.share[side];
      here->mean = joined.potential[side];
      if (there != given_.end()) continue;
      const double across = (side == 0 ? 1 : -1) * head_across(g, *joined.tie, gravity);
      const std::uint32_t other = joined.tie->node[1 - side];
      const Given opposite{other, here->mobility, joined.potential[1 - side], joined.share[1 - side]};
      field_.potential[other] = field_.potential[here->node] + across;
      std::erase_if(through_, [&](const Through& through) { return through.node == other; });
      given_.push_back(opposite);
      break;
    }
  }
}

// Each has gained from its own side.
void PoreWater::tie_smoothed(const double* from, double* to) const {
  for (const Joined& joined : joined_) {
    const std::uint32_t a = joined.tie->node[0], b = joined.tie->node[1];
    to[a] = to[b] = to[a] + to[b] - from[a];
  }
}

void PoreWater::keep_means() {
  for (Joined& joined : joined_) {
    joined.mean = field_.mean[joined.tie->node[0]];
    joined.even = field_.even[joined.tie->node[0]];
  }
}

// Water that passes the seam changes its height: its potential energy is work from outside.
PoreFlow PoreWater::tie_exchanged(const GridState& g, const Vec2& gravity, double rate) {
  PoreFlow sum;
  const PoreFields& f = field_;
  for (const Joined& joined : joined_) {
    const std::uint32_t a = joined.tie->node[0], b = joined.tie->node[1];
    f.mean[a] = f.mean[b] = f.mean[a] + f.mean[b] - 2 * joined.mean + joined.even;
    if (marks_[a].given) continue;
    const double own = alike_.own ? rate : rate * alike_.mobility;
    const double to_a = f.change[a] - own * f.potential[a], to_b = f.change[b] - own * f.potential[b];
    const double passed = joined.share[0] * (to_b + own * (f.potential[a] - joined.potential[0])) - joined.share[1] * to_a;  // from b to a
    sum.external -= head_across(g, *joined.tie, gravity) * capacity(a) * passed;
    f.change[a] += to_b;
    f.change[b] += to_a;
  }
  sum.darcy = sum.external;
  return sum;
}

}  // namespace pivnp::mpm

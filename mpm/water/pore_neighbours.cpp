// What the water meets beside the material: rigid bodies, other bodies of material, and the opposite of two tied sides.
#include <algorithm>

#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

namespace {

constexpr double sealed_margin = 0.5;  // cells: material that touches a body may stay so far from it

}  // namespace

// Of an element that a body's own points leave empty: another body of material, or a rigid one, lets no water through.
bool PoreWater::sealed(const GridState& g, std::size_t element, double time) const {
  for (std::size_t other = element % g.field_nodes(); g.velocity_fields > 1 && other < node_.size(); other += g.field_nodes())
    if (node_[other].cell != 0) return true;
  if (bodies_->empty()) return false;
  const Vec2& h = g.grid.spacing;
  return bodies_->cover(g.position(element) + 0.5 * h, time, sealed_margin * h.minCoeff());
}

// The second node's potential less the first one's, where pressures are the same.
double PoreWater::head_across(const GridState& g, const TiedSides::Tie& tie, const Vec2& gravity) const {
  return head(g.position(tie.node[0]), gravity) - head(g.position(tie.node[1]), gravity);
}

// Tied nodes are one node of the flow: each has the sums of both, and its own frame of the potential.
void PoreWater::tie_means(const GridState& g, const Vec2& gravity, double time) {
  joined_.clear();
  for (const TiedSides::Tie& tie : ties_->ties()) {
    PoreNode &a = node_[tie.node[0]], &b = node_[tie.node[1]];
    const double volume = a.volume + b.volume;
    if (time >= tie.until || !(a.volume > 0 && b.volume > 0)) continue;
    joined_.push_back({&tie, {a.volume / volume, b.volume / volume}});
    const double across = head_across(g, tie, gravity);
    const double potential = a.potential + b.potential - across * b.volume;
    a.volume = b.volume = volume;
    a.potential = potential;
    b.potential = potential + across * volume;
    a.strained = b.strained = a.strained + b.strained;
  }
}

void PoreWater::tie_given(const GridState& g, const Vec2& gravity) {
  for (const Joined& joined : joined_) {
    PoreNode &a = node_[joined.tie->node[0]], &b = node_[joined.tie->node[1]];
    if (!a.given && !b.given) continue;
    const double across = head_across(g, *joined.tie, gravity);
    if (a.given) b.potential = a.potential + across;
    else a.potential = b.potential - across;
    a.given = b.given = true;
  }
}

// Of exchange along an axis: what each of them gained inwards. (Along the seam both have gained the same.)
void PoreWater::tie_gains(const GridState& g, std::size_t step, double PoreNode::*from, double PoreNode::*to) {
  const auto row = std::size_t(g.grid.nx);
  for (const Joined& joined : joined_) {
    const std::size_t n = joined.tie->node[0], m = joined.tie->node[1];
    const std::size_t across = (std::max(n, m) - std::min(n, m)) % row == 0 ? row : 1;
    if (step != across) continue;
    PoreNode &a = node_[n], &b = node_[m];
    a.*to = b.*to = a.*to + b.*to - a.*from;
  }
}

// Water that passes the seam changes its height: its potential energy is work from outside.
PoreFlow PoreWater::tie_changes(const GridState& g, const Vec2& gravity) {
  PoreFlow sum;
  for (const Joined& joined : joined_) {
    PoreNode &a = node_[joined.tie->node[0]], &b = node_[joined.tie->node[1]];
    const double volume = a.volume, gained = a.change, other = b.change;
    sum.external += head_across(g, *joined.tie, gravity) * volume * (joined.share[1] * gained - joined.share[0] * other);
    a.change = b.change = gained + other;
    a.unseen = b.unseen = a.unseen + b.unseen;
  }
  sum.darcy = sum.external;
  return sum;
}

}  // namespace pivnp::mpm

// Which particles of the second motion stand for a particle of the first: by identity, or by material position.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/side.hpp"
#include "compare/triangulation.hpp"

namespace pivnp::compare {

/// Where a particle lies among the other side's; vertex[0] < 0: no partner. A partner by identity has one weight.
using Partner = Location;

inline bool has_partner(const Partner& partner) { return partner.vertex[0] >= 0; }

/// The other side's motion at a partner. u = sum w u_i + (sum w F_i - I) beyond: the gradient that the side itself
/// carries takes the displacement from the material's edge to the particle just beyond it, exactly for affine motions.
struct PartnerState {
  Vec2 u;
  Mat2 F;
  std::array<double, 3> cov;  // sum w cov_i: an upper bound, reached when neighbours' errors are the same
};
PartnerState partner_state(const Partner& partner, const SideState& state);

class Alignment {
 public:
  /// Both sides as read at the common start.
  /// Identity if at least half of the smaller side finds its id on the other side and every such pair has the same
  /// material position within 1e-6 of the spacing; else linear interpolation on the second's triangulation of material
  /// positions. Label names that both sides know pair only with their own.
  Alignment(const Side& first, const Side& second);

  bool by_identity() const { return by_identity_; }

  /// Renews the partners for those of the second that are still followed. A particle that lost its partner gets none
  /// again.
  void update(const std::vector<std::uint8_t>& second_followed);
  const std::vector<Partner>& partners() const { return partners_; }

  /// Share of each side's particles (of all it has) that have a partner at the common start.
  double coverage_first() const { return coverage_first_; }
  double coverage_second() const { return coverage_second_; }

 private:
  void decide();
  /// Partners of the wanted particles of the first among those of the second that are followed.
  std::vector<Partner> find_partners(const std::vector<std::uint8_t>& wanted) const;
  void measure_coverage();

  const Side& first_;
  const Side& second_;
  std::vector<int> group_first_, group_second_;  // particles pair within a group
  int groups_ = 1;
  std::vector<int> same_id_;  // index on the second side, -1: none
  bool by_identity_ = false;
  std::vector<std::uint8_t> second_followed_;  // as of the last update
  std::vector<Partner> partners_;
  double coverage_first_ = 0, coverage_second_ = 0;
};

}  // namespace pivnp::compare

// Which particles of the second motion stand for a particle of the first: by identity, or by material position.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/triangulation.hpp"

namespace pivnp::compare {

/// Where a particle lies among the other data set's: shares of its particles, none without a partner. By identity: one.
using Partner = Natural;

inline bool has_partner(const Partner& partner) { return !partner.shares.empty(); }

/// The other data set's motion at a partner, with the gradient that it carries itself:
///   u = sum w_i (u_i + (F_i - I)(X - X_i)/2) + (F - I) beyond,   F = sum w_i (F_i + grad F_i (X - X_i)/2)
/// Any weights that reproduce X make u exact for motions of second degree and F for those of third (the halves cancel
/// the curvature; without them natural neighbours, which reach further, would miss it by more than triangles do). The
/// gradients of F are those of Natural::curving; where they are missing, or det F would not be positive, F = sum w_i
/// F_i.
struct PartnerState {
  Vec2 u;
  Mat2 F;
  std::array<double, 3> cov;  // sum w cov_i: an upper bound, reached when neighbours' errors are the same
  std::array<double, 3> cov_F{0, 0, 0};  // likewise
};
PartnerState partner_state(const Partner& partner, const DataSetState& state);

class Alignment {
 public:
  /// Both sets as read at the common start.
  /// Identity if at least half of the smaller data set finds its id in the other and every such pair has the same
  /// material position within 1e-6 of the spacing; else natural neighbours among the second's material positions
  /// (MaterialMesh::find_natural). Label names that both data sets know pair only with their own.
  Alignment(const DataSet& first, const DataSet& second);

  bool by_identity() const { return by_identity_; }

  /// Renews the partners that rest on particles of the second that are followed no more; the others stay, since a
  /// point's natural neighbours, and theirs, are not changed by the loss of others. A particle that lost its partner
  /// gets none again.
  void update(const std::vector<std::uint8_t>& second_followed);
  const std::vector<Partner>& partners() const { return partners_; }

  /// Share of each data set's particles (of all it has) that have a partner at the common start.
  double coverage_first() const { return coverage_first_; }
  double coverage_second() const { return coverage_second_; }

 private:
  void decide();
  /// Partners of the wanted particles of the first among those of the second that are followed.
  std::vector<Partner> find_partners(const std::vector<std::uint8_t>& wanted) const;
  void measure_coverage();

  const DataSet& first_;
  const DataSet& second_;
  std::vector<int> group_first_, group_second_;  // particles pair within a group
  int groups_ = 1;
  std::vector<int> same_id_;  // index in the second data set, -1: none
  bool by_identity_ = false;
  std::vector<std::uint8_t> second_followed_;  // as of the last update
  std::vector<Partner> partners_;
  double coverage_first_ = 0, coverage_second_ = 0;
};

}  // namespace pivnp::compare

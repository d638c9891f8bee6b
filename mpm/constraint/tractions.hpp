// Loads on faces of the material.
//
// A face lies beyond the centres of the points next to it. Its load t enters the balance of momentum through a layer of
// material under it, column by column under pieces of the face: with f equal to 1 near the face and falling to 0 at the layer's end, N the face's normal, all of time 0,
// the divergence theorem gives
//   int_face t N_i dA = int_layer (f t (F N) . grad N_i + t N_i df/dN) dV,
// a stress and a body force. Both are summed over the points as the internal force is, so that a uniform stress under the
// load is in balance, point by point, wherever in their cells the points are; and no node is pushed by more than its mass
// bears. (To load the nodes at the face's own place is not in balance with the sums over points: rows of stress alternate as
// the face moves through a cell.) A load that follows its face has the traction of the piece of face over the point.
// Axisymmetric: both integrals are those of a radian, r dA and r dV, and df/dN becomes df/dN + f N_r/r.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/options.hpp"
#include "mpm/constraint/reaction.hpp"
#include "mpm/grid/grid_state.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::mpm {

/// A piece of a loaded face: it belongs to the particle under it and moves with it.
struct Traction {
  std::size_t particle;
  double face;    // its length at time 0, m
  Vec2 along;     // of unit length, at time 0
  Vec2 out;       // from the particle to it, at time 0, m
  Vec2 traction;  // at time 0, Pa; to be multiplied by share()
  bool follows;
  double rise, until;
  std::uint16_t boundary;  // its number in the scene
  std::int32_t next;       // piece over the same particle, where two faces meet; -1: none
  double share(double time) const { return time >= until ? 0 : rise > 0 ? std::min(1.0, time / rise) : 1.0; }
  /// Per length at time 0: as then, or, where it follows, turned with the face and in proportion to its length.
  Vec2 traction_now(const Mat2& F) const {
    if (!follows) return traction;
    const Vec2 now = F * along;
    return traction.dot(along) * now + (along.x() * traction.y() - along.y() * traction.x()) * Vec2(-now.y(), now.x());
  }
};

class Tractions {
 public:
  /// `cell`: sides of the grid's cells, which set the depth of the layers. Throws InputError naming boundary.<name>.<key>.
  Tractions(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const ParticleSet& particles,
            const Vec2& cell);

  bool any() const { return !pieces_.empty(); }
  /// The piece of a face over a particle of the set (the first, where two meet); null: none.
  const Traction* of(std::size_t particle) const;
  /// The next over the same particle; null: none.
  const Traction* after(const Traction& piece) const { return piece.next < 0 ? nullptr : &pieces_[std::size_t(piece.next)]; }
  /// Adds the forces at a time to NodeArrays::loads, and their impulses over dt to those of their boundaries. Same bits for
  /// any number of threads.
  void add_to_loads(const Particles& p, GridState& g, double time, double dt, std::span<Impulse> of_boundaries, int threads) const;
  /// Times at which one is complete or ends, in no order.
  const std::vector<double>& changes() const { return changes_; }

 private:
  struct InLayer {
    std::uint32_t piece;  // over it
    double share;         // f
    double change;        // df/dN, 1/m, scaled so that a column's body forces add up to its piece's load
    double even;          // what takes the place of df/dN where the column is torn: the load on its points' centres, 1/m
    Vec2 normal;
  };
  void add(const std::string& key, const BoundaryOptions& options, std::size_t boundary, const ParticleSet& particles,
           const Vec2& cell, std::vector<std::pair<std::size_t, InLayer>>& layers);
  std::span<const InLayer> layers(std::size_t particle) const {
    return {layers_.data() + first_[particle], layers_.data() + first_[particle + 1]};
  }

  std::vector<Traction> pieces_;      // face after face
  std::vector<std::int32_t> over_;    // of every particle: the piece over it; -1: none. Empty without loads
  std::vector<InLayer> layers_;       // particle after particle
  std::vector<std::uint32_t> first_;  // of every particle, and one more: its first among them
  std::vector<double> changes_;
};

}  // namespace pivnp::mpm

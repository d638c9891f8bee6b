// The material under pieces of a rigid outline.
//
// A face lies beyond the centres of the points next to it, and where a body meets it an impulse must fit the sums over
// points that the internal force is made of. With f equal to 1 near the face and falling to 0 at the layer's end, h the share of
// a piece of the outline (hats along it, sum 1) and e the direction from the body into the material, the divergence theorem gives
//   int_face h N_i dA = -int_layer div(f h N_i e) dV,
// summed over the points as they are now. Scaled so that linear fields of velocity are exact, the numbers that it gives to the
// nodes say what an impulse on the piece does to them and, by duality, what the velocity of the face is: its work is exact.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

/// Of a node in a sum over nodes.
struct NodeShare {
  std::uint32_t node;
  double share;
};

/// A point under a piece of an outline: the piece's share of it, its depth below and its place along, in m.
struct UnderPiece {
  std::size_t piece;
  double share, depth, along;
  double half;  // of the point's extent across the face, m
  Vec2 normal;  // e
};

/// A face of the material under a piece.
struct MaterialFace {
  enum class State { none, thin, found } state = State::none;  // thin: too few points under it for a layer
  double gap = 0;    // from the outline to it, m; below 0: inside
  double along = 0;  // where an impulse acts
  double area = 0;   // of it, m (m^2 a radian)
};

class ContactLayer {
 public:
  /// Forgets all points, for so many pieces.
  void begin(std::size_t pieces, int velocity_fields);
  /// Adds to a list the pieces that a point is under: a parallelogram, the columns of `halves` half its sides.
  using Under = std::function<void(const Vec2& x, const Mat2& halves, std::vector<UnderPiece>& list)>;
  /// Takes the points in and around a box, as far away as a layer is deep.
  void add(const Particles& p, const GridState& g, const Vec2& low, const Vec2& high, const Under& under);
  /// The face under a piece, and what an impulse on it gives to nodes (appended). `held`: it has not flowed, however stretched.
  MaterialFace face(const GridState& g, std::size_t piece, int field, std::vector<NodeShare>& nodes, bool held = false);

 private:
  struct Point {
    std::size_t node[most_stencil_nodes];
    double wx[3], wy[3], gx[3], gy[3];  // along both axes; derivatives per m
  };
  struct Member {
    std::size_t point;
    double volume, radius, stretch2;  // of the piece's share of it; 1 in the plane; |F|^2
    UnderPiece at;
    double body = 0, stress = 0;  // of an impulse: as a body force, and as a stress, m
  };

  std::vector<Point> points_;
  std::vector<std::vector<Member>> members_;  // piece after piece, field after field
  int fields_ = 1;
  std::vector<std::int32_t> place_;  // of a node among those appended; -1: not among them
};

}  // namespace pivnp::mpm

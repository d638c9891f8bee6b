// What one pair of frames offers the particles: per element, whether its nodes can be interpolated, or a fit must
// stand in, or nothing can be said.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/local_fit.hpp"

namespace pivnp::np {

struct ElementError;  // reading_error.hpp

/// Nodal values of a pair, not owned; Real is float (measured) or double (NodalIncrements).
template <class Real>
struct Nodes {
  Grid grid;
  Anchor anchor;
  const std::array<Real, 2>* displacement;  // [ny][nx]
  const VectorStatus* status;               // [ny][nx]
  const std::array<float, 3>* cov;          // [ny][nx], or null: not known
  float correlation_length = 0;             // within which errors of vectors are alike; 0: not known, independent
  int step = 1;                             // number of this pair in the path, from 1
  const float* path_factor = nullptr;       // [ny][nx]: what cov counts along a path; null: 1
  const ElementError* errors = nullptr;     // [ny - 1][nx - 1], where cov is known
};

enum class Support : std::uint8_t {
  measured,  // four valid nodes
  replaced,  // four usable nodes, at least one of them replaced
  fitted,    // a node is missing: LocalFit over those around
  none,      // too few usable nodes around
};

/// Buffers are kept from pair to pair.
class SupportMap {
 public:
  /// Sorts the elements of `nodes`. A node counts as usable if its status says so and its value is finite.
  template <class Real>
  void build(const Nodes<Real>& nodes);

  Support at(std::size_t element) const { return support_[element]; }
  const Support* elements() const { return support_.data(); }
  /// 0 valid, 1 replaced, 2 not usable.
  std::uint8_t node_class(std::size_t node) const { return node_class_[node]; }
  /// The fit of an element whose support is `fitted`.
  const LocalFit& fit(std::size_t element) const;

 private:
  std::vector<std::uint8_t> node_class_;      // 0 valid, 1 replaced, 2 not usable
  std::vector<Support> support_;              // per element
  std::vector<std::size_t> fitted_elements_;  // ascending
  std::vector<LocalFit> fits_;                // in the order of fitted_elements_
};

/// Fills the values whose node is not usable, so that a spline can be laid through all nodes: from the local fits of
/// the elements around it; where there are none, the mean of the filled neighbours, ring by ring. No particle reads a
/// stencil with such a node.
void fill_gaps(const Grid& grid, const SupportMap& support, std::vector<std::array<double, 2>>& values);

extern template void SupportMap::build(const Nodes<float>&);
extern template void SupportMap::build(const Nodes<double>&);

}  // namespace pivnp::np

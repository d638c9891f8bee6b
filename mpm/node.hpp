// What a node of the grid carries during a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace pivnp::mpm {

/// Kept in the order in which the kernels add to it: four at once, then two and two (lanes.hpp).
struct alignas(32) Node {
  double mass = 0;          // kg/m
  double vx = 0, vy = 0;    // velocity mapped from the points, m/s (while it is being mapped: momentum)
  double fx = 0, fy = 0;    // force on the node, N/m
  bool held = false;        // by a wall or body
  double ux = 0, uy = 0;    // velocity that strains the material (MUSL: mapped again), restrained
  double nx = 0, ny = 0;    // velocity after the momentum update and the restraints
  double dx = 0, dy = 0;    // damping force, part of the force, N/m; between uses: averages (strain.cpp)
};
static_assert(sizeof(Node) == 96 && std::is_trivially_copyable_v<Node>);

/// The nodes of a grid, all zero. Fresh pages of the system are zero as they are and take no memory until they are
/// written to: nodes far from all material cost nothing.
class Nodes {
 public:
  explicit Nodes(std::size_t n) : memory_(std::calloc(n + 1, sizeof(Node))), size_(n) {
    if (!memory_) throw std::bad_alloc();
    const auto at = reinterpret_cast<std::uintptr_t>(memory_.get());
    node_ = reinterpret_cast<Node*>((at + alignof(Node) - 1) / alignof(Node) * alignof(Node));
  }
  Node& operator[](std::size_t n) { return node_[n]; }
  const Node& operator[](std::size_t n) const { return node_[n]; }
  Node* data() { return node_; }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<void, Free> memory_;
  std::size_t size_;
  Node* node_;
};

}  // namespace pivnp::mpm

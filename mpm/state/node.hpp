// What a node of the grid carries during a step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace pivnp::mpm {

/// One line of the caches, in the order in which the kernels add to it: four numbers at once, or with eight lanes the whole
/// line, the last three as they are (so no other thread may touch it meanwhile).
struct alignas(64) Node {
  double vx = 0, vy = 0;    // velocity mapped from the points, m/s (while it is being mapped: momentum)
  double fx = 0, fy = 0;    // force on the node without the damping, N/m
  double mass = 0;          // kg/m
  double nx = 0, ny = 0;    // velocity after the momentum update and the restraints
  bool held_x = false, held_y = false;  // along the axis, by a wall or body: the motion is given, not driven
  bool apart = false;       // strains the material by a velocity of its own (GridState::separate_strain_velocities())

  void hold() { held_x = held_y = true; }
};
static_assert(sizeof(Node) == 64 && std::is_trivially_copyable_v<Node>);

/// A velocity of a node, m/s.
struct alignas(16) NodeVelocity {
  double x = 0, y = 0;
};

// What the averages of three-node shapes keep (averages.hpp), in little memory: what is done with takes its successor.
/// Over a cell's points: V0 s (1 - s) times the hat across along the lower and upper edge, V0 t (1 - t) along the left and
/// right one; s and t from the cell's lower left corner, in cells. Then the cell's shares of its edges.
struct alignas(32) CellEdges {
  double low = 0, high = 0, left = 0, right = 0;
};
/// Over a corner's points by its hat: V0 a, then the average at the corner; V0, then one over it.
struct alignas(16) CornerSums {
  double value = 0, volume = 0;
};
/// Along x and y.
struct alignas(16) AlongAxes {
  double x = 0, y = 0;
};
struct AverageView {
  CellEdges* edges;
  CornerSums* corners;
};

/// One a node of a grid, all zero. Fresh pages of the system are zero as they are and take no memory until they are
/// written to: nodes far from all material cost nothing.
template <class T>
class OfGrid {
 public:
  using value_type = T;
  OfGrid() = default;
  explicit OfGrid(std::size_t n) : memory_(std::calloc(n + alignof(T) / sizeof(T) + 1, sizeof(T))), size_(n) {
    if (!memory_) throw std::bad_alloc();
    const auto at = reinterpret_cast<std::uintptr_t>(memory_.get());
    first_ = reinterpret_cast<T*>((at + alignof(T) - 1) / alignof(T) * alignof(T));
  }
  T& operator[](std::size_t n) { return first_[n]; }
  const T& operator[](std::size_t n) const { return first_[n]; }
  T* data() { return first_; }
  const T* data() const { return first_; }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<void, Free> memory_;
  std::size_t size_ = 0;
  T* first_ = nullptr;
};
/// Several such arrays.
template <class T, std::size_t count>
class SeveralOfGrid {
 public:
  using value_type = std::array<T, count>;
  SeveralOfGrid() = default;
  explicit SeveralOfGrid(std::size_t n) {
    for (auto& array : arrays_) array = OfGrid<T>(n);
  }
  OfGrid<T>& operator[](std::size_t k) { return arrays_[k]; }
  std::size_t size() const { return arrays_[0].size(); }

 private:
  std::array<OfGrid<T>, count> arrays_;
};
using Nodes = OfGrid<Node>;

}  // namespace pivnp::mpm

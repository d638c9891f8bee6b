// A group of consecutive pairs, smoothed together along the paths of the material.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pivnp/piv/dense/shrink.hpp"
#include "pivnp/piv/dense/spline_field.hpp"
#include "pivnp/piv/method.hpp"
#include "pivnp/piv/sequence.hpp"

namespace pivnp::piv {

// Two components at the points of a lattice.
struct Components {
  std::vector<float> u, v;
  void resize(std::size_t count) { u.resize(count), v.resize(count); }
};

// What is known of a place of the material in a pair.
enum class Source : std::uint8_t { lost, smooth, measured };

struct HeldPair {
  PixelVectors vectors;
  Components measured, smooth, variance;
  std::vector<std::uint8_t> trusted;
  Components on_paths;  // `measured` where the material of the reference lattice is, `smooth` where it is not trusted
  Components about;     // `smooth` there, about which it was measured
  std::vector<Source> known;  // of these
  Components path;            // place of that material at the vectors' instant, pixels of the level
  std::optional<CameraStep> camera;
};

/// The fields of a group of pairs: followed along the material's paths, averaged and shrunk together, then the parts'
/// departures from that, at last each pair's own (docs/theory/piv.md).
class JointSmoothing {
 public:
  JointSmoothing(NodeLattice nodes, Anchor anchor, int threads);
  /// Fields of the pair measured last; `first` of its group.
  void take(const PairCorrelator& pairs, bool first, HeldPair& pair);
  /// Whether all pairs taken have fields on one lattice.
  bool together() const { return together_; }
  void begin() { together_ = true; }
  /// Corrects the vectors of the pairs, and states what they share with each other (path_factor).
  void run(std::vector<HeldPair>& held);

 private:
  struct Field;

  float column(int i) const { return static_cast<float>(lattice_.x0 + i * lattice_.step); }
  float row(int j) const { return static_cast<float>(lattice_.y0 + j * lattice_.step); }
  template <class Function>
  void each_point(Function function) const {
#pragma omp parallel for num_threads(threads_) schedule(static)
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) function(i, j, lattice_.index(i, j));
  }
  SplineField spline(const Components& values) const;
  std::array<float, 2> at_rest(const HeldPair& pair, float x, float y) const;
  void find_paths(std::vector<HeldPair>& held) const;
  void follow(HeldPair& pair, float sign, Components& place) const;
  void smooth_departure(const Components& value, const Field& base, float caution, Components& out) const;
  Field shrunk(const Components& value, const Field& base, float caution, float pairs_sharing, float first,
               bool restored) const;
  void state_bend(float pairs, Field& field) const;
  void depart_smoothly(const Field& base, const std::vector<std::uint8_t>& known, Components& values) const;
  void divide(std::vector<HeldPair>& held, std::size_t begin, std::size_t end, const Field& of_group,
              const Components& group_shown) const;
  Field grown(const Components& part, const Components& group, const Field& base) const;
  std::vector<float> steady_share(const HeldPair& pair, const Field& base, const Field& own) const;
  Components rim_bias(const HeldPair& pair) const;
  void finish_pair(HeldPair& pair, std::size_t place, std::size_t pairs, const Field& group_field) const;

  NodeLattice nodes_;
  Anchor anchor_;
  int threads_;
  CellLattice lattice_;
  int decimation_ = 1;
  std::array<int, 2> origin_{0, 0};
  std::vector<std::uint8_t> wanted_;
  bool together_ = true;
  std::unique_ptr<Shrinker> shrinker_;
};

}  // namespace pivnp::piv

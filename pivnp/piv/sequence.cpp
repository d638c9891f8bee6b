#include "pivnp/piv/sequence.hpp"

#include <algorithm>
#include <utility>

#include "pivnp/piv/joint_smoothing.hpp"

namespace pivnp::piv {

namespace {

std::size_t valid(const PixelVectors& vectors) {
  return std::size_t(std::count(vectors.status.begin(), vectors.status.end(), VectorStatus::valid));
}

}  // namespace

struct SequenceCorrelator::Impl {
  PairCorrelator pairs;
  JointSmoothing joint;
  std::size_t nodes_in_window;
  std::vector<HeldPair> held;

  Impl(const PivOptions& options, NodeLattice nodes, int width, int height, int threads)
      : pairs(options, nodes, width, height, threads), joint(nodes, options.anchor, threads) {
    const double across = options.window_px / std::max(1.0, double(node_spacing(nodes)));
    nodes_in_window = std::max<std::size_t>(4, std::size_t(across * across));
  }
};

int SequenceCorrelator::group_for(const PivOptions& options, std::size_t nodes, int width, int height) {
  constexpr double memory = 800e6, bytes_a_cell = 44, bytes_a_node = 26;  // measured
  const double cell = options.window_px / 4.0;
  const double pair = bytes_a_cell * double(width) * double(height) / (cell * cell) + bytes_a_node * double(nodes);
  return std::clamp(int(memory / pair), 8, group);
}

SequenceCorrelator::SequenceCorrelator(const PivOptions& options, NodeLattice lattice, int width, int height,
                                       int threads)
    : impl_(std::make_unique<Impl>(options, std::move(lattice), width, height, threads)) {}

SequenceCorrelator::~SequenceCorrelator() = default;

void SequenceCorrelator::add(const ImageView& first, const ImageView& second, const MaskView& mask,
                             const CameraStep* camera, const MaskView& material) {
  HeldPair pair;
  if (camera != nullptr) {
    impl_->pairs.place(camera->pixel, impl_->held.empty());
    pair.camera = *camera;
  }
  pair.vectors = impl_->pairs.correlate(first, second, mask, material);
  impl_->joint.take(impl_->pairs, impl_->held.empty(), pair);
  // A pair with fewer vectors than the one before, by two windows' worth, where windows may have been drawn to a false
  // peak, is searched again from there; the better of both counts.
  if (const PixelVectors* before = impl_->held.empty() ? nullptr : &impl_->held.back().vectors;
      before != nullptr && valid(pair.vectors) + 2 * impl_->nodes_in_window <= valid(*before)) {
    HeldPair again;
    again.camera = pair.camera;
    again.vectors = impl_->pairs.correlate(first, second, mask, material, before);
    impl_->joint.take(impl_->pairs, false, again);
    if (valid(again.vectors) >= valid(pair.vectors) + impl_->nodes_in_window) pair = std::move(again);
  }
  impl_->held.push_back(std::move(pair));
}

const PixelVectors& SequenceCorrelator::last() const { return impl_->held.back().vectors; }

void SequenceCorrelator::drop_last() {
  impl_->held.pop_back();
  if (impl_->held.empty()) impl_->joint.begin();
}

int SequenceCorrelator::held() const { return static_cast<int>(impl_->held.size()); }

std::vector<PixelVectors> SequenceCorrelator::finish() {
  if (impl_->joint.together() && impl_->held.size() > 1) impl_->joint.run(impl_->held);
  std::vector<PixelVectors> out;
  for (HeldPair& pair : impl_->held) out.push_back(std::move(pair.vectors));
  impl_->held.clear();
  impl_->joint.begin();
  return out;
}

}  // namespace pivnp::piv

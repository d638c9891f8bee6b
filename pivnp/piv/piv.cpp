#include "pivnp/piv/piv.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/piv/methods.hpp"
#include "pivnp/piv/sampling/anchor_shares.hpp"
#include "pivnp/piv/sampling/extent.hpp"
#include "pivnp/piv/window_passes.hpp"

namespace pivnp::piv {

namespace {

[[noreturn]] void refuse(const std::string& key, const std::string& found, const std::string& expected) {
  throw InputError("piv." + key + ": found " + found + ", expected " + expected);
}

// What ranges of single options cannot say.
void check(const PivOptions& options, const PivMethod& method, const NodeLattice& lattice, int width, int height) {
  if (width < 1 || height < 1) throw InputError("piv: found frames without pixels, expected at least 1 x 1");
  if (std::find(method.anchors.begin(), method.anchors.end(), options.anchor) == method.anchors.end())
    refuse("anchor", "'" + std::string(name_of(options.anchor)) + "'", "an anchor that method " + method.name + " has");
  if (options.window_px < method.least_window_px || options.window_px > std::min(width, height))
    refuse("window_px", std::to_string(options.window_px),
           std::to_string(method.least_window_px) + " to the frames' shorter side (" +
               std::to_string(std::min(width, height)) + " px)");
  if (options.first_window_px != 0 && options.first_window_px < options.window_px)
    refuse("first_window_px", std::to_string(options.first_window_px),
           "0 or at least window_px (" + std::to_string(options.window_px) + ")");
  if (options.passes < 0) refuse("passes", std::to_string(options.passes), "0 or more");
  if (!(options.median_threshold > 0)) refuse("median_threshold", std::to_string(options.median_threshold), "above 0");
  const std::size_t count = std::size_t(lattice.nx) * std::size_t(lattice.ny);
  if (lattice.nx < 1 || lattice.ny < 1 || lattice.pixel.size() != count ||
      (!lattice.on.empty() && lattice.on.size() != count))
    throw InputError("piv: found a lattice whose arrays do not match its size, expected one place a node");
}

}  // namespace

struct PairCorrelator::Impl {
  PivOptions options;
  const PivMethod& row;
  NodeLattice nodes;
  std::vector<std::array<float, 2>> made_at;  // the nodes that the method was made for
  int width = 0, height = 0, threads = 1;
  // Made for a mask:
  std::vector<std::uint8_t> mask;  // [height][width]; empty without one
  std::vector<std::uint8_t> material;  // of the last pair's first frame that had one, and mask
  Box box;                         // what the method sees of the frames
  std::unique_ptr<Method> method;

  Impl(const PivOptions& piv_options, const PivMethod& piv_method, NodeLattice lattice, int frame_width,
       int frame_height, int thread_count)
      : options(piv_options),
        row(piv_method),
        nodes(std::move(lattice)),
        width(frame_width),
        height(frame_height),
        threads(std::max(1, thread_count)) {
    make_method();
  }

  void take_mask(const MaskView& view);
  void take_material(const MaskView& view);
  MaskView usable_material(const MaskView& view, std::vector<std::uint8_t>& bytes) const;
  void leave_material(const MaskView& view, PixelVectors& vectors) const;

  // Takes the mask of a pair; true if it is another than before.
  bool take(const MaskView& view) {
    if (view.data == nullptr) return !std::exchange(mask, {}).empty();
    const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
    bool same = mask.size() == columns * rows;
    mask.resize(columns * rows);
    for (std::size_t r = 0; r < rows; ++r) {
      const std::uint8_t* from = view.data + std::ptrdiff_t(r) * view.stride;
      std::uint8_t* to = mask.data() + r * columns;
      same = same && std::memcmp(from, to, columns) == 0;
      std::memcpy(to, from, columns);
    }
    return !same;
  }

  void place(const std::vector<std::array<float, 2>>& pixel, bool anew) {
    constexpr float near = 8;  // px: the method's lattices reach farther beyond the nodes
    float most = 0;
    for (std::size_t k = 0; k < pixel.size(); ++k)
      for (const std::size_t c : {std::size_t(0), std::size_t(1)})
        if (const float off = std::abs(pixel[k][c] - made_at[k][c]); off > most) most = off;
    nodes.pixel = pixel;
    if (anew || most > near) return make_method();
    const NodeLattice live = live_part();
    if (!method->place(live)) return make_method();
    empty = empty_vectors(live);
  }

  MaskView whole_mask() const { return mask.empty() ? MaskView{} : MaskView{mask.data(), width, height, width}; }

  // The nodes in the frames' part that the method sees.
  NodeLattice live_part() const {
    NodeLattice live = live_nodes(nodes, whole_mask(), 0.5f * static_cast<float>(options.window_px));
    for (auto& [x, y] : live.pixel) x -= static_cast<float>(box.x0), y -= static_cast<float>(box.y0);
    return live;
  }

  void make_method() {
    const MaskView whole = whole_mask();
    box = usable_box(whole, width, height, 3 * options.window_px / 2, 2 * window_sides(options, width, height).front());
    const Extent extent{live_part(), part_of(whole, box), box.width(), box.height()};
    made_at = nodes.pixel;
    method = row.make(options, extent, threads);
    empty = empty_vectors(extent.nodes);
  }

  // As they are before anything is measured: masked where a node is off or nothing is left of its window.
  PixelVectors empty;
  PixelVectors empty_vectors(const NodeLattice& live) const {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const std::size_t count = nodes.pixel.size();
    PixelVectors vectors{options.anchor, {}, {}, {}, {}, nan};
    vectors.displacement.assign(count, {nan, nan});
    vectors.cov.assign(count, {nan, nan, nan});
    vectors.score.assign(count, nan);
    vectors.status.assign(count, VectorStatus::failed);
    for (std::size_t k = 0; k < count; ++k) {
      const auto [x, y] = nodes.pixel[k];
      const bool inside = x >= 0 && y >= 0 && x <= static_cast<float>(width - 1) && y <= static_cast<float>(height - 1);
      if (!switched_on(nodes, k) || (inside && !switched_on(live, k))) vectors.status[k] = VectorStatus::masked;
    }
    return vectors;
  }
};

PairCorrelator::PairCorrelator(const PivOptions& options, NodeLattice lattice, int width, int height, int threads) {
  const PivMethod& method = piv_methods().at(options.method, "piv.method");
  check(options, method, lattice, width, height);
  impl_ = std::make_unique<Impl>(options, method, std::move(lattice), width, height, threads);
}

PairCorrelator::~PairCorrelator() = default;

const DenseField* PairCorrelator::field() const { return impl_->method->field(); }

std::array<int, 2> PairCorrelator::field_origin() const { return {impl_->box.x0, impl_->box.y0}; }

void PairCorrelator::place(const std::vector<std::array<float, 2>>& pixel, bool anew) {
  if (pixel.size() != impl_->nodes.pixel.size())
    throw InputError("piv: found " + std::to_string(pixel.size()) + " places of nodes, expected " +
                     std::to_string(impl_->nodes.pixel.size()));
  anew = anew && pixel != impl_->made_at;
  if (anew || pixel != impl_->nodes.pixel) impl_->place(pixel, anew);
}

namespace {

void check_frames(const FramePair& pair, int width, int height) {
  for (const ImageView* view : {&pair.first, &pair.second})
    if (view->width != width || view->height != height)
      throw InputError("piv: found a frame of " + std::to_string(view->width) + " x " + std::to_string(view->height) +
                       " px, expected " + std::to_string(width) + " x " + std::to_string(height));
}

}  // namespace

void PairCorrelator::Impl::take_mask(const MaskView& view) {
  if (view.data != nullptr && !row.masks)
    throw InputError("piv: found a mask, expected none: method " + row.name + " cannot leave pixels out");
  if (view.data != nullptr && (view.width != width || view.height != height))
    throw InputError("piv: found a mask of " + std::to_string(view.width) + " x " + std::to_string(view.height) +
                     " px, expected " + std::to_string(width) + " x " + std::to_string(height));
  if (take(view)) make_method();
}

// A vector whose start is no material is the neighbours', carried on beyond the surface.
void PairCorrelator::Impl::leave_material(const MaskView& view, PixelVectors& vectors) const {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const float share = shares_of(vectors.anchor).first;
  for (std::size_t k = 0; k < vectors.status.size(); ++k) {
    const float x = nodes.pixel[k][0] + share * vectors.displacement[k][0], y = nodes.pixel[k][1] + share * vectors.displacement[k][1];
    if (!(x >= 0 && y >= 0 && x <= float(width - 1) && y <= float(height - 1))) continue;  // or not measured
    if (view.usable(int(std::lround(x)), int(std::lround(y)))) continue;
    vectors.status[k] = VectorStatus::masked, vectors.score[k] = nan;
    vectors.displacement[k] = {nan, nan}, vectors.cov[k] = {nan, nan, nan};
  }
}

// What is material and not masked.
MaskView PairCorrelator::Impl::usable_material(const MaskView& view, std::vector<std::uint8_t>& bytes) const {
  if (!row.masks || view.width != width || view.height != height)
    throw InputError("piv: found a mask of material of " + std::to_string(view.width) + " x " + std::to_string(view.height) +
                     " px, expected " + std::to_string(width) + " x " + std::to_string(height) + ", and a method that leaves pixels out");
  bytes.resize(std::size_t(width) * std::size_t(height));
  const MaskView whole = whole_mask();
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      bytes[std::size_t(r) * std::size_t(width) + std::size_t(c)] = std::uint8_t(view.usable(c, r) && whole.usable(c, r));
  return {bytes.data(), width, height, width};
}

void PairCorrelator::Impl::take_material(const MaskView& view) {
  method->set_first_mask(view.data != nullptr ? part_of(usable_material(view, material), box) : MaskView{});
}

PixelVectors PairCorrelator::correlate(const ImageView& first, const ImageView& second, const MaskView& mask, const MaskView& material,
                                       const PixelVectors* before) {
  check_frames({first, second}, impl_->width, impl_->height);
  impl_->take_mask(mask);
  impl_->take_material(material);
  if (before != nullptr) {
    std::vector<std::uint8_t> known;
    for (const VectorStatus status : before->status) known.push_back(std::uint8_t(status == VectorStatus::valid));
    impl_->method->start_from(before->displacement, known);
  }
  PixelVectors vectors = impl_->empty;
  impl_->method->correlate(part_of(first, impl_->box), part_of(second, impl_->box), vectors);
  if (material.data != nullptr) impl_->leave_material(material, vectors);
  return vectors;
}

PixelVectors PairCorrelator::correlate_mean(std::span<const FramePair> pairs, const MaskView& mask) {
  for (const FramePair& pair : pairs) check_frames(pair, impl_->width, impl_->height);
  impl_->take_mask(mask);
  impl_->take_material({});
  std::vector<FramePair> parts;
  std::vector<std::vector<std::uint8_t>> material(pairs.size());
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    FramePair& part = parts.emplace_back(FramePair{part_of(pairs[n].first, impl_->box), part_of(pairs[n].second, impl_->box)});
    if (pairs[n].material.data != nullptr) part.material = part_of(impl_->usable_material(pairs[n].material, material[n]), impl_->box);
  }
  PixelVectors vectors = impl_->empty;
  if (!impl_->method->correlate_mean(parts, vectors))
    refuse("ensemble", std::to_string(impl_->options.ensemble),
           "1, as method " + impl_->row.name + " has no correlation to average; fft and ncc have");
  if (!pairs.empty() && pairs[pairs.size() / 2].material.data != nullptr)
    impl_->leave_material(pairs[pairs.size() / 2].material, vectors);
  return vectors;
}

}  // namespace pivnp::piv

// One resolution of the dense Gauss-Newton method: frames, their flags and the lattice of cells.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/shrink.hpp"
#include "pivnp/piv/sampling/extent.hpp"
#include "pivnp/piv/sampling/level.hpp"
#include "pivnp/piv/sampling/pixel_flags.hpp"

namespace pivnp::piv {

class GnLevel {
 public:
  /// Cells of a quarter of `window_px`, in pixels of the level, over the nodes and two cells beyond.
  GnLevel(const Extent& extent, int decimation, int window_px, int passes);

  /// `shared`: the level's images where they have been taken already without smoothing, else null.
  void take(const ImageView& first, const ImageView& second, float smoothing, int threads, const Level* shared);

  /// As Method::set_first_mask.
  void set_first_mask(const MaskView& mask) {
    first_masked_.take_mask(mask, own_.decimation, true);
    has_first_mask_ = mask.data != nullptr;
  }

  const Level& images() const { return *images_; }
  const PixelFlags* first_flags() const { return flags(first_flags_, has_first_mask_ ? first_masked_ : masked_); }
  const PixelFlags* second_flags() const { return flags(second_flags_, masked_); }
  int decimation() const { return own_.decimation; }
  int passes() const { return passes_; }
  const CellLattice& lattice() const { return lattice_; }
  const Shrinker& shrinker() const { return shrinker_; }
  const std::vector<std::uint8_t>& wanted() const { return wanted_; }  // points near nodes that are on; empty: all
  float from_full(float x) const { return own_.from_full(x); }

  /// Place of a point of the lattice in the full image.
  float column(int i) const { return own_.to_full(static_cast<float>(lattice_.x0 + i * lattice_.step)); }
  float row(int j) const { return own_.to_full(static_cast<float>(lattice_.y0 + j * lattice_.step)); }
  EvenLattice even() const;

 private:
  // Saturated pixels are found at the full resolution only.
  const PixelFlags* flags(const PixelFlags& full, const PixelFlags& masked) const {
    const PixelFlags& own = own_.decimation == 1 ? full : masked;
    return own.empty() ? nullptr : &own;
  }

  MaskView mask_;
  Level own_;
  const Level* images_ = nullptr;
  PixelFlags masked_, first_masked_, first_flags_, second_flags_;
  bool has_first_mask_ = false;
  CellLattice lattice_;
  Shrinker shrinker_;
  std::vector<std::uint8_t> wanted_;
  int passes_;
};

}  // namespace pivnp::piv

// The Gauss-Newton equations of one pass: both frames warped once, and their sums over hat-weighted cells.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/spline_field.hpp"
#include "pivnp/piv/spline_image.hpp"

namespace pivnp::piv {

/// Pixels of a frame that must not be used: masked ones, and saturated ones with their neighbours.
class PixelFlags {
 public:
  void clear() { flag_.clear(); }
  bool empty() const { return flag_.empty(); }
  void resize(int width, int height);
  /// Flags the pixels (column - reach ... column + reach, likewise rows) that lie in the image.
  void mark(int column, int row, int reach);
  bool at(int column, int row) const { return flag_[std::size_t(row) * std::size_t(width_) + std::size_t(column)] != 0; }
  /// False if no pixel of the tiles that cover the box is flagged.
  bool any(int column0, int row0, int column1, int row1) const;
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  static constexpr int tile = 16;
  int width_ = 0, height_ = 0, tiles_ = 0;
  std::vector<std::uint8_t> flag_, tile_flag_;
};

/// What a pass knows: frames, the displacement field that they are warped by, and per lattice point what the robust
/// weights and the light correction need.
struct SumsInput {
  const SplineImage* first = nullptr;
  const SplineImage* second = nullptr;
  const PixelFlags* first_flags = nullptr;   // null: all pixels are usable
  const PixelFlags* second_flags = nullptr;
  const SplineField* field = nullptr;        // its lattice is the sums' lattice
  float share_first = -0.5f, share_second = 0.5f;  // f(x) = first(x + share_first d), g(x) = second(x + share_second d)
  // Robust weight of a pixel: 1 / (1 + e^2 / (noise + tolerance |grad|^2))^2 (Geman & McClure 1985). Empty: all 1.
  const std::vector<float>* noise = nullptr;      // grey^2, at lattice points
  const std::vector<float>* tolerance = nullptr;  // px^2
  // Light: e = f - gain g - offset. Empty: gain 1, offset 0.
  const std::vector<float>* gain = nullptr;
  const std::vector<float>* offset = nullptr;
  bool scores = false;  // also the sums that correlation coefficients need
};

/// Sums over the pixels x about each lattice point with hat weights (1 - |dx|/step)(1 - |dy|/step), w the robust weight:
/// of w gx gx, w gx gy, w gy gy, w gx e, w gy e, w e e, w, and usable pixels (1); for scores f, g, ff, gg, fg.
struct CellSums {
  enum Plane { gxx, gxy, gyy, gxe, gye, wee, weight, usable, f, g, ff, gg, fg, planes };
  static constexpr int basic = f;
  CellLattice lattice;
  std::vector<float> plane[planes];
  const std::vector<float>& operator[](Plane p) const { return plane[p]; }
};

/// Gradients are those of the mean of both warped frames, by the five-point derivative that is exact for the spectrum of
/// a 3 px grain; e is first minus second. The same bits for any number of threads.
void accumulate_sums(const SumsInput& input, int threads, CellSums& sums);

/// Name of the instruction set in use ("AVX3", "AVX2", "SSE2" ...).
const char* simd_target();

}  // namespace pivnp::piv

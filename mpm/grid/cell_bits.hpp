// Sets of cells (or nodes) of a grid, a bit each.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pivnp::mpm {

/// Only the rows from the first to the last member are kept, and a margin of empty ones around them.
class CellBits {
 public:
  /// Those of `cells` (ascending; j nx + i) that `keep` wants.
  template <class Keep>
  CellBits(int nx, const std::vector<std::int32_t>& cells, Keep&& keep)
      : nx_(nx), words_(std::size_t(nx) / 64 + 1) {
    if (cells.empty()) return;
    first_ = cells.front() / nx;
    bits_.assign(std::size_t(cells.back() / nx - first_ + 1) * words_, 0);
    std::int32_t start = first_ * nx;  // of the row
    std::uint64_t* row = bits_.data();
    for (const std::int32_t c : cells) {
      for (; c >= start + nx; start += nx) row += words_;
      const auto i = std::size_t(c - start);
      if (keep(c)) row[i / 64] |= std::uint64_t{1} << (i % 64);
    }
  }

  bool has(std::int32_t c) const {
    const auto i = std::size_t(c % nx_), at = std::size_t(std::max(0, c / nx_ - first_)) * words_ + i / 64;
    return c / nx_ >= first_ && at < bits_.size() && (bits_[at] >> (i % 64) & 1);
  }

  /// All within `before` columns to the left and rows below a member, and `after` to the right and above.
  CellBits grown(int before, int after) const {
    CellBits wide = *this;
    for (std::size_t at = 0; at < bits_.size(); at += words_)
      for (std::size_t w = 0; w < words_; ++w) {
        const std::uint64_t here = bits_[at + w], left = w > 0 ? bits_[at + w - 1] : 0,
                            right = w + 1 < words_ ? bits_[at + w + 1] : 0;
        for (int a = 1; a <= after; ++a) wide.bits_[at + w] |= here << a | left >> (64 - a);
        for (int b = 1; b <= before; ++b) wide.bits_[at + w] |= here >> b | right << (64 - b);
      }
    CellBits out = wide;
    const int rows = int(bits_.size() / words_);
    if (rows == 0) return out;
    out.first_ = first_ - std::min(first_, before);
    out.bits_.assign(std::size_t(first_ - out.first_ + rows + after) * words_, 0);
    for (int j = first_; j < first_ + rows; ++j)
      for (int to = std::max(out.first_, j - before); to <= j + after; ++to)
        for (std::size_t w = 0; w < words_; ++w) out.row(to)[w] |= wide.row(j)[w];
    return out;
  }

  /// Calls each(j nx + i), ascending.
  template <class Each>
  void for_all(Each&& each) const {
    for (std::size_t at = 0; at < bits_.size(); at += words_)
      for (std::size_t w = 0; w < words_; ++w)
        for (std::uint64_t rest = bits_[at + w]; rest != 0; rest &= rest - 1) {
          const auto i = 64 * w + std::size_t(std::countr_zero(rest));
          if (i < std::size_t(nx_)) each((std::size_t(first_) + at / words_) * std::size_t(nx_) + i);
        }
  }

 private:
  std::uint64_t* row(int j) { return bits_.data() + std::size_t(j - first_) * words_; }

  int nx_, first_ = 0;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace pivnp::mpm

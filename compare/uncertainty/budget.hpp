// The standard uncertainty u_val of a displacement difference, and its parts (ASME V&V 20-2009, section 1-5).
#pragma once

#include <array>
#include <limits>

#include "compare/data/data_set.hpp"
#include "compare/data/options.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// Variances of the x and y component of d = u2 - u1 at one particle and time. u_val^2 = u_D^2 + u_num^2 + u_input^2.
struct Variance {
  Vec2 measurement = Vec2::Zero();  // NaN: not known
  Vec2 numerical = Vec2::Zero(), input = Vec2::Zero();
  Vec2 grid = Vec2::Zero();  // of `numerical`, what coarser grids tell
  bool grids = false;        // there are coarser grids: a part of zero, as at the start, is known to be so

  Vec2 total() const;  // NaN only if nothing at all is known
};

/// Of those that are known; NaN if neither is.
Vec2 sum_known(const Vec2& a, const Vec2& b);

class Budget {
 public:
  /// `options`: the parts that are given as numbers.
  explicit Budget(const CompareOptions& options);

  /// `cov_first`, `cov_second`: uu, vv of each data set's random error, NaN where one knows none. `frame`: of what was
  /// taken off both data sets (its own error), and of the clock. `numerical`: error from grid refinement; null: no
  /// coarser grids.
  Variance at(const Vec2& cov_first, const Vec2& cov_second, const Vec2& u_first, const Vec2& frame,
              const Vec2* numerical) const;

 private:
  double systematic_, gauge_, numerical_, input_;  // the variances, but gauge_: relative standard uncertainty
};

}  // namespace pivnp::compare

// What became of particles that followed a known motion.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/record/closure_note.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/options.hpp"

namespace pivnp::app {

inline constexpr Bounds path_bounds{0.1, 0.5};        // px
inline constexpr double most_stated_px = 0.25;         // standard error; twice that is wrong
inline constexpr double element_px = 16;

struct KnownPaths {
  np::NpOptions options;
  Grid grid;
  Region region;        // where particles start
  int frames = 10;      // pairs
  Anchor anchor = Anchor::central;
  std::function<Vec2(const Vec2& node, int pair)> increment;           // by the anchor, px
  std::function<VectorStatus(const Vec2& node, int pair)> status = {};  // none: all valid
  std::function<Vec2(const Vec2& x0, double frames)> position;          // of what was at x0 so many frames ago; NaN: nothing can be there
  double error_px = 0.02;      // standard deviation of a component
  double repeated_share = 0;   // of its variance, the same in every pair; known as closing chains of pairs would tell
  bool births_alone = false;   // particles of the start are not judged
};

/// `seed`: of the vectors' errors. Throws Interrupted.
Survival followed(const KnownPaths& paths, std::uint64_t seed, const Progress& progress);

}  // namespace pivnp::app

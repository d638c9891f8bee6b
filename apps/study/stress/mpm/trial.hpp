// One simulation under stress, and what it is held against.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "mpm/scene/options.hpp"
#include "mpm/scene/scene.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

inline constexpr Bounds motion_bounds{0.05, 0.2};  // of the greatest displacement

struct Trial {
  mpm::MpmOptions options;
  mpm::Scene scene;
  double end_s = 0;
};

/// Combinations of one scene: a level along x, and a row.
struct TrialMap {
  std::string name, title, scene_words;
  MapAxis x, y;
  std::vector<LimitLine> theory = {};
  std::function<Trial(double x, std::size_t row)> trial;
  /// The same as well as it can be done; what it does not depend on is simulated once.
  std::function<Trial(double x, std::size_t row)> reference = {};
  bool reference_by_x = true, reference_by_row = false;
  std::function<Vec2(double x, const Vec2& x0)> truth = {};  // displacement at the end, in the place of a reference
  double square_m = 0.04;  // displacements are compared as means over squares of this side
};

MapPlan plan_of(TrialMap map);

/// Options without initial equilibrium that run to their end.
mpm::MpmOptions bare_options();
mpm::MaterialOptions elastic_soil(double young_pa, double poisson, double density_kg_m3);
mpm::BoundaryOptions line_boundary(Pair from, Pair to, mpm::BoundaryType type);
Region box_region(const std::string& name, double x0, double y0, double x1, double y1);
/// Cells from (0, 0) to at least `corner`.
Grid cells_to(const Vec2& corner, double cell);

/// The four pairs of shape functions and transfer that most maps have as rows.
MapAxis scheme_rows();
void take_scheme(mpm::MpmOptions& options, std::size_t row);

}  // namespace pivnp::app

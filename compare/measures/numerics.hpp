// The numerical part of a simulation's uncertainty, from the same simulation on coarser grids.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/sources.hpp"

namespace pivnp::compare {

/// What three (or two) grids say of one number (Celik et al. 2008, J. Fluids Eng. 130, 078001; Roache 1994).
struct GridConvergence {
  double order = 1;    // observed, or the formal 1 with two grids
  double factor = 0;   // u_num = factor |f_fine - f_coarse|
  bool asymptotic = false;  // the changes fall from grid to grid, with an order of 0.5 to 2.1
};

/// `change_fine`: size of f1 - f2 (finest minus next), `change_coarse`: of f2 - f3, or NaN with two grids only.
/// GCI = Fs |f1 - f2| / (r^p - 1) with p = ln(change_coarse / change_fine) / ln r held to 0.5 ... 2 and Fs = 1.25 where
/// it needed no holding, else Fs = 3; with two grids p = 1 and Fs = 3. u_num = GCI / 1.15 (V&V 20, section 2-4, for
/// errors that do not change sign).
GridConvergence grid_convergence(double change_fine, double change_coarse, double ratio);

/// Coarser simulations read beside the second data set, at the first's particles.
class Numerics {
 public:
  /// `first`, `second`: at the common start. The order of convergence is that of the displacements at the last common
  /// time. Throws InputError as DataSet does, or if a coarser simulation covers none of the first or not all of its times.
  Numerics(const Refinement& refinement, const DataSet& first, const DataSet& second, const CommonTimes& common);

  bool given() const { return !sets_.empty(); }
  const GridConvergence& convergence() const { return convergence_; }

  /// Variances of u_num, x and y, of every particle of the first; the others' mean where the coarser grid has no
  /// partner. Empty without coarser grids. `time` not before the one asked for last.
  const std::vector<Vec2>& at(double time, const DataSetState& second, const std::vector<Partner>& partners);

 private:
  struct Coarser {
    std::unique_ptr<DataSet> set;
    std::unique_ptr<Alignment> alignment;
  };
  std::vector<Coarser> sets_;
  GridConvergence convergence_;
  std::vector<Vec2> variance_;
};

}  // namespace pivnp::compare

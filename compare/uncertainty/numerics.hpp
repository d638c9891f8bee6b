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
  double order = 1;         // observed, held to 0.5 ... 2; the formal 1 with two grids
  double factor = 0;        // u_num = factor |f_fine - f_coarse|
  bool asymptotic = false;  // the changes fall from grid to grid, with an order of 0.5 to 2.1
};

/// `change_fine`: size of f1 - f2 (finest minus next), `change_coarse`: of f2 - f3, or NaN with two grids only.
/// In the asymptotic range GCI = Fs |f1 - f2| / (r^p - 1) with p = ln(change_coarse / change_fine) / ln r and Fs
/// = 1.25; u_num = GCI / 1.15 (V&V 20, section 2-4, for errors that do not change sign). Outside it, and with two
/// grids, nothing can be extrapolated: u_num is the range over the grids, |f1 - f2| with two and `range` with three
/// (after Stern et al. 2001, who take half of it for 95 %), which is no bound; `asymptotic` is then false and everyone
/// says so. (A safety factor of 3 on an order that nobody observed hides three degrees of friction.)
GridConvergence grid_convergence(double change_fine, double change_coarse, double ratio, double range = 0);
/// Of one number on two or three grids, the finest first; out of the asymptotic range too where it does not change in
/// one sense.
GridConvergence grid_convergence(const std::vector<double>& values, double ratio);

/// Coarser simulations read beside the second data set, at the first's particles.
class Numerics {
 public:
  /// `first`, `second`: at the common start. The order of convergence is that of the displacements at the last common
  /// time. Throws InputError as DataSet does, or if a coarser simulation covers none of the first or not all of its
  /// times.
  Numerics(const Refinement& refinement, const DataSet& first, const DataSet& second, const CommonTimes& common);

  bool given() const { return !sets_.empty(); }
  const GridConvergence& convergence() const { return convergence_; }

  /// u_num, x and y, of every particle of the first, with the sign of fine minus coarse (so that it can be
  /// differentiated in time); the others' root mean square where the coarser grid has no partner. Empty without coarser
  /// grids. `time` not before the one asked for last.
  const std::vector<Vec2>& at(double time, const DataSetState& second, const std::vector<Partner>& partners);

 private:
  struct Coarser {
    std::unique_ptr<DataSet> set;
    std::unique_ptr<Alignment> alignment;
  };
  std::vector<Coarser> sets_;
  GridConvergence convergence_;
  std::vector<Vec2> error_;
};

}  // namespace pivnp::compare

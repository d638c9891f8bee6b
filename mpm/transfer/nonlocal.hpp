// Softening by the plastic strain of the surroundings, so that a length of the material, not the cells, sets the width
// of a shear band.
//
// Over-nonlocal (Vermeer & Brinkgreve 1994; Galavi & Schweiger 2010, Int. J. Geomech. 10:30; Bazant & Jirasek 2002,
// J. Eng. Mech. 128:1119): strength follows k* = (1 - m) k + m kbar, m = 2, at least 0, kbar the mean of the accumulated
// plastic strain k around the point with the weights V exp(-r^2/l^2), over the points of the same material where they
// are now. With m = 1 a band would still narrow to a cell; with m = 2 its centre counts less than its sides as it
// narrows, which stops it at a width of the order of l. At a free surface or wall the weights of what is there are
// scaled to one.
//
// The mean is taken on the grid: V k and V go to the nodes by hats, both are filtered along the rows and the columns,
// and their quotient comes back by hats. The filter is the n-fold product of (a, 1 - 2a, a) whose second moment, with
// the hats' h^2/3, is the weights' l^2/2 an axis: a Gaussian for l of a few cells, and never below zero. Strength is that
// of the start of the step, so k* is no state: a restart finds it again from k.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "mpm/grid/grid_state.hpp"
#include "mpm/material/material.hpp"
#include "mpm/state/particles.hpp"

namespace pivnp::mpm {

class NonlocalSoftening {
 public:
  /// `materials`: one a label.
  NonlocalSoftening(const std::vector<std::unique_ptr<Material>>& materials, const GridState& g);
  /// Particles::softened_by from the accumulated plastic strain. (Before the first call it is zero: the initial
  /// equilibrium is sought with the peak strength.) Same bits for any number of threads.
  void average(Particles& p, GridState& g, int threads);

 private:
  struct Filter {
    std::vector<double> x, y;  // one side: the middle first; empty: this material is not averaged
  };
  struct Box {
    std::ptrdiff_t first, lines, across;  // its first node, rows, nodes of a row
  };
  static Box box_of(const GridState& g);
  void map(const Particles& p, const Particles::Body& body, const Box& box, GridState& g, int threads);
  void filter(const Filter& f, const Box& box, GridState& g, int threads);
  void gather(Particles& p, const Particles::Body& body, const GridState& g, int threads) const;

  std::vector<Filter> filters_;  // one a material; empty: none is averaged
};

}  // namespace pivnp::mpm

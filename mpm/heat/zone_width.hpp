// The width into which the cells localise, of the points of a shear zone, found without its direction.
//
// Across a zone with the plastic shear g(n) it is (integral g dn)^2/integral g^2 dn. With averages weighted by exp(-r^2/l^2) that is
// sqrt(pi) l <g>^2/<g^2>, as the zone is long against l. Corrected for what the weights lose of a zone of some width and of points off
// its middle: exp(c^2/l^2) (1 + s^2/l^2), c the distance of the sheared neighbours' centre, s^2 their variance across the zone.
// Zones that cross turn in opposite senses as they slip. A point takes no account of what turns against it: with the sense of a point,
// spin over the rate of shear, from -1 to 1, its neighbours have weights 1 + min(0, sense sense').
#pragma once

#include <cstddef>
#include <vector>

#include "mpm/constraint/tied_sides.hpp"
#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

class ZoneWidth {
 public:
  ZoneWidth(const GridState& g, const TiedSides& ties);
  /// A look at the points with shear[k] > 0: Particles::band_width of those. `sense`: of their turning.
  void look(Particles& p, const GridState& g, const std::vector<double>& shear, const std::vector<double>& sense, double time);

 private:
  struct Box {
    std::ptrdiff_t i, j, nx, ny;
  };
  // Of points, at the nodes: moments of the shear of orders 0, 1 along x, 1 along y and 2, and that of its square.
  struct Moments {
    std::vector<double> sum, square, moment[5];
    bool any = false;
  };
  void filter_moments(Moments& of);
  void filter(const std::vector<double>& x_taps, const std::vector<double>& y_taps, const std::vector<double>& in, std::vector<double>& out);

  const TiedSides* ties_;
  double length_;  // l
  std::vector<double> of_x_[3], of_y_[3];  // taps, and those times the distance and its square
  Box box_{};
  std::ptrdiff_t period_x_ = 0, period_y_ = 0;  // of tied sides, in nodes
  std::ptrdiff_t shift_y_ = 0, shift_x_ = 0;    // of the opposite one along itself
};

}  // namespace pivnp::mpm

// How two sets of values are distributed, whatever their places: the area between their cumulative distributions.
#pragma once

#include <string>
#include <vector>

#include "compare/measures/comparison.hpp"
#include "compare/measures/differences.hpp"

namespace pivnp::compare {

/// Integral of |F_first(x) - F_second(x)| over x, in the values' unit (the area metric of Ferson, Oberkampf & Ginzburg
/// 2008, Comput. Methods Appl. Mech. Eng. 197). Values that are not finite are left out; NaN if a side has none.
double area_metric(std::vector<double> first, std::vector<double> second);

/// Adds area_metric_displacement and area_metric_strain_dev at the last common time, and the table of both cumulative
/// distributions at 101 levels. `u_displacement`, `u_strain`: standard uncertainty of a difference of values (NaN: not
/// known); it bounds the area's, since errors e of the values change it by at most the mean of |e|.
void add_distributions(const Snapshot& last, double u_displacement, double u_strain, const std::string& length_unit,
                       Comparison& out);

}  // namespace pivnp::compare

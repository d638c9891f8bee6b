// How two sets of values are distributed, whatever their places: the area between their cumulative distributions.
#pragma once

#include <string>
#include <vector>

#include "compare/measures/differences.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// Integral of |F_first(x) - F_second(x)| over x, in the values' unit (the area metric of Ferson, Oberkampf & Ginzburg
/// 2008, Comput. Methods Appl. Mech. Eng. 197). Values that are not finite are left out; NaN if there are none of one.
double area_metric(std::vector<double> first, std::vector<double> second);

/// Of |u| and of the deviatoric strain (NaN without one) of the particles compared.
struct DistributionMeasures {
  double displacement_area = 0, strain_dev_area = 0;
};
DistributionMeasures measure_distributions(const ComparedParticles& last);

/// The table of both cumulative distributions at 101 levels.
ComparisonTable distribution_table(const ComparedParticles& last, const std::string& length_unit);

}  // namespace pivnp::compare

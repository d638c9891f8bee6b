// All that a comparison has measured, before metrics are read from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/alignment/onset.hpp"
#include "compare/alignment/reference.hpp"
#include "compare/data/rigid.hpp"
#include "compare/measures/bands.hpp"
#include "compare/measures/clocks.hpp"
#include "compare/measures/decomposition.hpp"
#include "compare/measures/differences.hpp"
#include "compare/measures/distribution.hpp"
#include "compare/measures/points.hpp"
#include "compare/measures/pressures.hpp"
#include "compare/measures/shapes.hpp"
#include "compare/uncertainty/numerics.hpp"

namespace pivnp::compare {

struct Findings {
  const Differences& differences;
  const Pressures& pressures;
  std::string length_unit, time_unit;
  std::string at_end;      // "at the last common time (0.5 s)"
  std::string covariance;  // whose covariance the uncertainties rest on; empty: nobody's is known
  std::string floor;       // whose strain floor is known, and from what; empty: nobody's
  std::string strain;      // whose covariance of F the uncertainties of strain rest on; empty: nobody's is known
  PerDataSet<double> coverage{};  // share of each that found a partner, at the common start
  std::size_t particles = 0, times = 0;  // of the first motion
  bool reference_given = false, reference_turns = false;
  std::optional<GridConvergence> convergence;
  ShapeMeasures shapes;
  BandMeasures bands;
  PointMeasures points;
  DistributionMeasures distributions;
  std::vector<FieldDecomposition> decompositions;
  Beginnings beginnings;
  std::optional<Onset> time_offset;  // added to the second's times
  std::optional<RigidFit> place;     // given to the second's coordinates

  const Tally& total() const { return differences.total(); }
  const Tally& last() const { return differences.last(); }
  const Rates& rates() const { return differences.rates(); }
};

}  // namespace pivnp::compare

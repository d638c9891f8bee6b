// The body's shape at the last common time: outline, slope, crest, mobilised material.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/options.hpp"
#include "compare/data/triangulation.hpp"
#include "compare/measures/differences.hpp"
#include "compare/shapes/slope.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// Both data sets at their beginning (as material) and at the last time compared.
struct ShapeSources {
  const MaterialMesh &start_first, &start_second;
  const DataSet &first, &second;
};

/// Lengths in the motions' unit.
struct ShapeMeasures {
  /// Area of the particles displaced by more than the threshold, with what it is uncertain by if |u| has the RMS error of
  /// the data set: half its change when the threshold moves by that both ways (one error shared by all), and the scatter
  /// of a sum of areas that count with the probability of a normal error each (errors of their own), in squares.
  struct Mobilised {
    double threshold = 0;
    PerDataSet<double> area{}, uncertainty{};
    double difference_uncertainty = 0;  // of those that are known; NaN if none is
    /// Of the displacement of these particles' centre of area, in degrees below the horizontal (negative: it rises),
    /// whichever way it goes; NaN where nothing is mobilised. Uncertainty: one error of u shared by all of them.
    PerDataSet<double> travel_angle_deg{}, travel_uncertainty_deg{};
  };
  std::optional<Mobilised> mobilised;  // nothing where nothing moves

  PerDataSet<std::vector<std::vector<Vec2>>> outlines;
  /// How far the particles that either has lost since the common start move its outline there by being away: Hausdorff distance of
  /// the outlines with and without them, its 95th percentile and its greatest value. 0: none is lost.
  struct Lost {
    double usual = 0, greatest = 0;
    double area = 0;  // of these particles
  };
  PerDataSet<Lost> lost{};
  /// To how much the outline of each is known: half a particle spacing (rectangular), the errors of u, where known, and what lost
  /// particles move it by.
  PerDataSet<double> place_uncertainty{};

  /// Of both outlines; nothing where one data set has none.
  struct Outlines {
    double cell = 0;
    double iou = 0, iou_uncertainty = 0;
    double hausdorff_95 = 0, hausdorff_uncertainty = 0;
  };
  std::optional<Outlines> between;

  struct Slope {
    PerDataSet<SlopeShape> shape;
    // How far the crest's edge drew back: the outermost place where the profile reaches 90 % of its greatest value at the
    // common start, then minus at the last common time; NaN where it is nowhere any more.
    PerDataSet<double> crest_retreat{};
    // Outermost point of the outline, on the side the slope faces.
    PerDataSet<double> toe_x{};
    // To how much an outline is known but for the covariance of its particles, and what those of the thin end move its tip by: the
    // error along it, and the one across times the cotangent of its angle (RMS over these particles, one error shared by all).
    // The particles at a thin front move fastest, and are known least.
    PerDataSet<double> drawn_uncertainty{}, tip_uncertainty{};
    bool same_way() const { return shape[0].faces == shape[1].faces; }
  };
  std::optional<Slope> slope;      // with slope_base_m, and where both have material above it
  bool nothing_above_base = false;  // slope_base_m was given, and one data set has none
};

ShapeMeasures measure_shapes(const ShapeSources& sources, const Differences& differences,
                             const CompareOptions& options);

/// 95th percentile of the distances from points a step apart on each outline to the other; the greater of both ways.
/// NaN if one has no points.
double hausdorff_95(const std::vector<std::vector<Vec2>>& first, const std::vector<std::vector<Vec2>>& second,
                    double step);

}  // namespace pivnp::compare

// What the figures and tables show, computed from the content: no drawing here.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apps/plot/numbers.hpp"
#include "apps/plot/raster.hpp"
#include "apps/report/content/content.hpp"
#include "apps/report/content/options.hpp"

namespace pivnp::report {

/// Quality of one pair; shares are of the nodes that are not masked.
struct PairQuality {
  std::array<int, 2> frames{0, 1};
  std::size_t nodes = 0;  // not masked
  std::size_t valid = 0, replaced = 0, rejected = 0, failed = 0;
  double score_median = 0, score_low = 0, score_high = 0;  // of the valid; low, high: 5th and 95th percentile; NaN if none
  double sigma = 0;                                        // RMS standard uncertainty of a valid vector's component
  std::uint8_t flag = 0;                                   // of the second frame
  double share(std::size_t n) const { return nodes == 0 ? 0 : double(n) / double(nodes); }
};
std::vector<PairQuality> pair_quality(const Content& content);

/// Index of the frame nearest to `time`; none if it lies outside the motion's times by more than half a step.
std::optional<std::size_t> frame_at(const MotionSource& motion, double time);

/// The times asked for, or up to three that part the recorded time evenly, the last one included.
std::vector<double> chosen_times(const ReportOptions& options, const Content& content);

/// The material points asked for, or up to three spread over the moving part: particles followed to the end whose final
/// displacement is nearest to the quartiles of those that moved more than a tenth of the 99th percentile.
std::vector<Vec2> chosen_points(const ReportOptions& options, const Content& content);

/// |u| of one material point over time; NaN where it is not followed.
struct History {
  std::vector<double> time, displacement;
  std::vector<double> sigma;  // standard uncertainty of |u|; empty if the source knows none
};

/// The particle at the point, or the affine fit through the six nearest in the material configuration; the covariance
/// is the nearest particle's. All NaN if no particle starts within two particle spacings of the point.
std::vector<History> histories(const MotionSource& motion, const std::vector<Vec2>& points);

/// One field at one time, ready to be coloured.
struct Snapshot {
  double time = 0;
  std::vector<Vec2> position, half_x, half_y;  // of the deformed squares
  std::vector<double> value;                   // NaN: not known
  std::vector<ParticleStatus> status;
};
std::vector<Snapshot> snapshots(const MotionSource& motion, const std::string& field, bool central,
                                const std::vector<double>& times);

/// Difference of a field (second minus first) at the first's particles and at `time`, in their order; empty if the
/// comparison lacks it. |u| from difference_x and _y: |u + d| - |u|; others from the field "difference_NAME".
std::vector<double> field_difference(const Content& content, const std::string& field, double time,
                                     const Snapshot& first);

/// RMS over the compared particles against time.
struct DifferenceHistory {
  std::vector<double> time, rms, median;
  std::vector<double> sigma;  // RMS standard uncertainty of the measured |u| over the same particles; NaN if not known
  std::vector<std::size_t> compared;
};
DifferenceHistory difference_history(const Content& content);

/// Particles that ended, by reason.
struct Ends {
  EndReason reason;
  std::size_t particles = 0;
  double first = 0, median = 0, last = 0;  // times
};
std::vector<Ends> ends_by_reason(const ParticleSet& particles);

/// Box around the positions at the snapshots, but for the outermost `share` on each side, with a margin; never empty.
Box box_around(const std::vector<const std::vector<Vec2>*>& positions, double share);

}  // namespace pivnp::report

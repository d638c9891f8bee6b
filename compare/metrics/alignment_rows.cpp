// Metrics of how the data sets were brought together: partners, frame of reference, coarser grids, clock and coordinates.
#include <numbers>

#include "compare/metrics/rows.hpp"

namespace pivnp::compare {

namespace {

constexpr double deg = 180 / std::numbers::pi;

void add_coverage(Registry<MetricRow>& rows) {
  rows.add({{.name = "coverage_first", .unit = "1",
             .definition = "share of the first's particles that found a partner, at the common start",
             .words = "coverage, measured", .limit = "coverage_min", .levelled = true},
            [](const Findings& f) { return MetricValue{f.coverage[0]}; }});
  rows.add({{.name = "coverage_second", .unit = "1",
             .definition = "share of the second's particles that found a partner, at the common start",
             .words = "coverage, simulated", .levelled = true},
            [](const Findings& f) { return MetricValue{f.coverage[1]}; }});
  rows.add({{.name = "coverage_first_final", .unit = "1",
             .definition = "share of the first's particles that still have a partner",
             .words = "coverage, measured, at the end", .leads = Leads::yes, .levelled = true},
            [](const Findings& f) {
              return MetricValue{double(f.last().displacement.count()) / double(f.particles), not_known, ", " + f.at_end};
            }});
  rows.add({{.name = "coverage_time", .unit = "1",
             .definition = "share of the first's times at which both data sets are known and have particles to compare",
             .words = "coverage time", .levelled = true},
            [](const Findings& f) { return MetricValue{double(f.differences.times().size()) / double(f.times)}; }});
}

// What the reference took off each data set at the last time.
void add_reference(Registry<MetricRow>& rows, DataSetRole role) {
  const auto s = std::size_t(role);
  const std::string name(name_of(role)), words = role == DataSetRole::first ? ", measured" : ", simulated";
  const auto note = [s](const Findings& f) {
    return " subtracted from that data set, " + f.at_end + "; uncertainty: jackknife over blocks of the polygon" +
           (f.last().frame[s].sigma_shift.allFinite() ? "" : ", too few blocks here");
  };
  for (const bool turns : {false, true}) {
    for (int axis = 0; axis < 2; ++axis) {
      const std::string along = axis == 0 ? "x" : "y";
      const std::string definition =
          turns ? "shift in " + along + " of the " + name + "'s particles in compare.fixed_zone_m, at their centre,"
                : "mean u_" + along + " of the " + name + "'s particles in compare.reference_m,";
      rows.add({{.name = (turns ? "fixed_zone_shift_" : "reference_shift_") + name + "_" + along, .unit = "L",
                 .definition = definition,
                 .words = (turns ? "fixed zone, shift " : "reference, shift ") + along + words},
                [=](const Findings& f) -> std::optional<MetricValue> {
                  if (!f.reference_given || f.reference_turns != turns) return std::nullopt;
                  const RigidFit& fit = f.last().frame[s];
                  return MetricValue{fit.motion.shift[axis], fit.sigma_shift[axis], note(f)};
                }});
    }
    if (!turns) continue;
    rows.add({{.name = "fixed_zone_rotation_" + name, .unit = "deg",
               .definition = "rotation of the " + name +
                             "'s particles in compare.fixed_zone_m, counter-clockwise,",
               .words = "fixed zone, rotation" + words},
              [=](const Findings& f) -> std::optional<MetricValue> {
                if (!f.reference_given || !f.reference_turns) return std::nullopt;
                const RigidFit& fit = f.last().frame[s];
                return MetricValue{fit.motion.angle * deg, fit.sigma_angle * deg, note(f)};
              }});
  }
}

}  // namespace

void add_alignment_rows(Registry<MetricRow>& rows) {
  add_coverage(rows);
  for (const DataSetRole role : data_set_roles) add_reference(rows, role);
  rows.add({{.name = "grid_convergence_order", .unit = "1",
             .definition = "order at which displacements of the second data set converge from the coarser grids, over "
                           "all particles at the last common time; held to 0.5 ... 2 (1 with two grids, where it is not observed)",
             .words = "order of grid convergence"},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.convergence) return std::nullopt;
              return MetricValue{f.convergence->order};
            }});
}

void add_offset_rows(Registry<MetricRow>& rows) {
  rows.add({{.name = "onset_difference", .unit = "T",
             .definition = "onset of the mean |u| over the particles, second minus first: zeros of lines through its rise (2 to "
                           "25 %) to the power 1 or 1/2; uncertainty: scatter about the lines, u_val over the speed of the "
                           "rise, and the change with the other power",
             .words = "onset of motion, simulated \u2212 measured"},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.beginnings.difference) return std::nullopt;
              return difference(f.beginnings.difference->time, f.beginnings.difference->sigma, "");
            }});
  rows.add({{.name = "rest_over_u", .unit = "1",
             .definition = "greatest RMS difference of displacement over its uncertainty while the second stands still (mean |u| "
                           "below 2 % of its last): above 2 the first moves already, or errs by more than is stated",
             .words = "difference before the simulation moves, in units of its uncertainty"},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.beginnings.rest_over_u) return std::nullopt;
              return MetricValue{*f.beginnings.rest_over_u};
            }});
  rows.add({{.name = "time_offset", .unit = "T",
             .definition = "added to the second's times so that both motions begin together: difference of the zeros of "
                           "lines through the rise (2 to 25 %) of sum u(t).u(T) / sum u(T)^2 to the power 1 or 1/2; "
                           "uncertainty: scatter about both lines or jackknife over blocks of the material, the error that all "
                           "particles may share, and the change with the other power",
             .words = "offset in time"},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.time_offset) return std::nullopt;
              return MetricValue{f.time_offset->time, f.time_offset->sigma};
            }});
  const std::string how = " given to the second's coordinates so that its outline at the common start lies on the first's "
                          "(least squares across the outline); uncertainty: jackknife over pieces of the outline";
  for (int axis = 0; axis < 2; ++axis) {
    const std::string along = axis == 0 ? "x" : "y";
    rows.add({{.name = "coordinate_shift_" + along, .unit = "L",
               .definition = "shift in " + along + ", at the centre of the matched outline," + how,
               .words = "coordinates, shift " + along},
              [axis](const Findings& f) -> std::optional<MetricValue> {
                if (!f.place) return std::nullopt;
                return MetricValue{f.place->motion.shift[axis], f.place->sigma_shift[axis]};
              }});
  }
  rows.add({{.name = "coordinate_rotation", .unit = "deg", .definition = "rotation, counter-clockwise," + how,
             .words = "coordinates, rotation"},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.place) return std::nullopt;
              return MetricValue{f.place->motion.angle * deg, f.place->sigma_angle * deg};
            }});
}

}  // namespace pivnp::compare

// Metrics of the body's shape at the last common time, and of its shear bands.
#include <cmath>
#include <numbers>

#include "compare/metrics/rows.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

using Values = std::vector<MetricValue>;

void add_mobilised(Registry<MetricRow>& rows) {
  add_for_both(rows, Variants::both_and_difference,
               {.name = "mobilised_area", .unit = "L^2",
                .definition = "area of the particles that are mobilised at the last common time",
                .words = "mobilised area"},
               Leads::no, [](const Findings& f) -> Values {
                 const auto& m = f.shapes.mobilised;
                 if (!m) return {};
                 const std::string note =
                     " (|u| above " + number(m->threshold) + " " + f.length_unit +
                     "); uncertainty: half the change when the threshold moves by the RMS error of u both ways, and the "
                     "scatter if every particle errs by itself, in squares";
                 return {{m->area[0], m->uncertainty[0], note},
                         {m->area[1], m->uncertainty[1], note},
                         difference(m->area[1] - m->area[0], m->difference_uncertainty, note)};
               });
  add_for_both(
      rows, Variants::both_and_difference,
      {.name = "travel_angle",
       .unit = "deg",
       .definition = "angle below the horizontal of the displacement of the mobilised area's centre at the last "
                     "common time; its tangent, fall over travel, is the apparent friction",
       .words = "travel angle"},
      Leads::no, [](const Findings& f) -> Values {
        const auto& m = f.shapes.mobilised;
        if (!m) return {};
        const std::string note = " (|u| above " + number(m->threshold) + " " + f.length_unit +
                                 "); uncertainty: RMS error of a component of u, shared by all particles, over "
                                 "the centre's displacement";
        const auto& [a, b] = m->travel_angle_deg;
        const auto& [u_a, u_b] = m->travel_uncertainty_deg;
        Values out{{a, u_a, note}, {b, u_b, note}};
        const double u = std::isnan(u_a) ? u_b : std::isnan(u_b) ? u_a : std::hypot(u_a, u_b);
        if (std::isfinite(b - a)) out.push_back(difference(b - a, u, note));
        return out;
      });
}

std::string on_cells(const Findings& f) {
  return ", at the last common time, on cells of " + number(f.shapes.between->cell) + " " + f.length_unit;
}

void add_outlines(Registry<MetricRow>& rows) {
  rows.add({{.name = "outline_iou", .unit = "1", .definition = "area common to both outlines over the area of either",
             .words = "outlines, share in common (IoU)", .limit = "outline_iou_min", .leads = Leads::yes},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.shapes.between) return std::nullopt;
              const double iou = f.shapes.between->iou, u = f.shapes.between->iou_uncertainty;
              return MetricValue{iou, u,
                                 on_cells(f) +
                                     "; uncertainty, a bound: length of each outline times what it is uncertain by "
                                     "(half a particle spacing, rectangular, the error of u, where known, and what lost particles "
                                     "move it by) over the area of either"};
            }});
  rows.add({{.name = "outline_hausdorff_95", .unit = "L",
             .definition = "Hausdorff distance of the outlines, 95 %: of points a cell apart on each, the 95th percentile "
                           "of the distance to the other, the greater of both ways",
             .words = "outlines, Hausdorff distance (95 %)", .limit = "hausdorff_m", .leads = Leads::yes},
            [](const Findings& f) -> std::optional<MetricValue> {
              if (!f.shapes.between) return std::nullopt;
              return difference(f.shapes.between->hausdorff_95, f.shapes.between->hausdorff_uncertainty,
                                on_cells(f) + "; uncertainty: half a particle spacing of each data set (rectangular), "
                                              "the errors of u, where known, and what lost particles move the outlines by");
            }});
}

// Both, and their difference where the slopes can be compared. An outline is known to within half a particle spacing
// (rectangular distribution), and as its particles are.
Values placed(const Findings& f, const PerDataSet<double>& value, bool comparable) {
  const std::string how = "; uncertainty: half a particle spacing (rectangular) and the error of u, where known";
  const PerDataSet<double>& u = f.shapes.place_uncertainty;
  Values out{{value[0], u[0], how}, {value[1], u[1], how}};
  if (comparable) out.push_back(difference(value[1] - value[0], std::hypot(u[0], u[1]), how));
  return out;
}

// What is read off a thin end moves by `times` what its outline is off by, and with its particles.
// `k`: from so many uncertainties on it counts; more than two for what the outermost of many particles decide.
Values at_thin_end(const Findings& f, const PerDataSet<double>& value, const std::string& more, const PerDataSet<double>& times, double k) {
  const std::string how = "; uncertainty: half a particle spacing (rectangular) and what is given of u" + more +
                          "; and the covariance of the particles there, along and, times cot of that angle, across";
  PerDataSet<double> u;
  for (std::size_t s = 0; s < 2; ++s)
    u[s] = std::hypot(times[s] * f.shapes.slope->drawn_uncertainty[s], f.shapes.slope->tip_uncertainty[s]);
  const bool comparable = f.shapes.slope->same_way();
  Values out{{value[0], u[0], how}, {value[1], u[1], how}};
  if (comparable) out.push_back(difference(value[1] - value[0], std::hypot(u[0], u[1]), how, k));
  return out;
}

void add_slope(Registry<MetricRow>& rows) {
  add_for_both(rows, Variants::both_and_difference,
               {.name = "run_out_x", .unit = "L",
                .definition = "x within which 99.5 % of the area above the base lies, on the side the slope faces, at "
                              "the last common time",
                .words = "run-out", .limit = "run_out_m", .leads = Leads::yes},
               Leads::yes, [](const Findings& f) -> Values {
                 if (!f.shapes.slope) return {};
                 const auto& [a, b] = f.shapes.slope->shape;
                 // A surface that moves out by d adds d times its length beyond to a wedge as thick as the profile is there.
                 return at_thin_end(f, {a.run_out_x, b.run_out_x}, ", times 1 + cot of the angle of the thin end",
                                    {1 + a.thinness, 1 + b.thinness}, 2);
               });
  add_for_both(rows, Variants::both_and_difference,
               {.name = "toe_x", .unit = "L",
                .definition = "x of the outermost point of the outline, on the side the slope faces, at the last common "
                              "time (thin slopes run on beyond 99.5 % of their area)",
                .words = "toe"},
               Leads::no, [](const Findings& f) -> Values {
                 if (!f.shapes.slope) return {};
                 // The tip of a wedge whose surface moves by d across itself moves by d over the sine of its angle; the
                 // outermost of some twenty particles makes it.
                 const auto& [a, b] = f.shapes.slope->shape;
                 return at_thin_end(f, f.shapes.slope->toe_x, ", over the sine of the angle of the thin end",
                                    {std::hypot(1, a.thinness), std::hypot(1, b.thinness)}, greatest_factor(20));
               });
  add_for_both(rows, Variants::both_and_difference,
               {.name = "crest_height", .unit = "L",
                .definition = "height above the base below which 99.5 % of the area lies, at the last common time",
                .words = "crest height"},
               Leads::no, [](const Findings& f) -> Values {
                 if (!f.shapes.slope) return {};
                 const auto& [a, b] = f.shapes.slope->shape;
                 return placed(f, {a.crest_height, b.crest_height}, true);
               });
  add_for_both(rows, Variants::both_and_difference,
               {.name = "slope_angle", .unit = "deg",
                .definition = "angle of the line fitted to the area-height profile (area of a column over its width) "
                              "between 10 and 90 % of the crest height, on the side the slope faces, at the last common "
                              "time",
                .words = "slope angle", .limit = "slope_angle_deg", .leads = Leads::yes},
               Leads::yes, [](const Findings& f) -> Values {
                 if (!f.shapes.slope) return {};
                 const auto& [a, b] = f.shapes.slope->shape;
                 const std::string how =
                     "; uncertainty: scatter about the line, one independent point a particle spacing, and what both ends "
                     "of the face are uncertain by (half a particle spacing, rectangular, and the error of u, where known) "
                     "over its length";
                 PerDataSet<double> u;
                 for (std::size_t s = 0; s < 2; ++s) {
                   const SlopeShape& shape = f.shapes.slope->shape[s];
                   const double turn = std::sqrt(2.0) * f.shapes.place_uncertainty[s] / shape.face_length * 180 / std::numbers::pi;
                   u[s] = std::hypot(std::isfinite(shape.angle_uncertainty_deg) ? shape.angle_uncertainty_deg : 0, turn);
                 }
                 Values out{{a.angle_deg, u[0], how}, {b.angle_deg, u[1], how}};
                 if (f.shapes.slope->same_way())
                   out.push_back(difference(b.angle_deg - a.angle_deg, std::hypot(u[0], u[1]), how));
                 return out;
               });
  add_for_both(rows, Variants::both_and_difference,
               {.name = "crest_retreat", .unit = "L",
                .definition = "how far the crest's edge drew back: the outermost place where the area-height profile "
                              "reaches 90 % of its greatest value at the common start, then minus at the last common "
                              "time (not a number: nowhere any more)",
                .words = "crest retreat", .leads = Leads::yes},
               Leads::no, [](const Findings& f) -> Values {
                 if (!f.shapes.slope) return {};
                 const PerDataSet<double>& retreat = f.shapes.slope->crest_retreat;
                 return placed(f, retreat, std::isfinite(retreat[1] - retreat[0]) && f.shapes.slope->same_way());
               });
}

void add_bands(Registry<MetricRow>& rows) {
  add_for_both(rows, Variants::both_and_difference,
               {.name = "band_number", .unit = "1", .definition = "number of shear bands",
                .words = "number of shear bands"},
               Leads::no, [](const Findings& f) -> Values {
                 const BandMeasures& b = f.bands;
                 const std::string note =
                     ": " + b.words() +
                     (std::isfinite(b.floor_dev)
                          ? "; uncertainty: half the change when the threshold moves by the noise floor both ways"
                          : "; uncertainty not known: noise floor not measured");
                 const double n1 = double(b.bands[0].size()), n2 = double(b.bands[1].size());
                 const PerDataSet<double>& u = b.number_uncertainty;
                 return {{n1, u[0], note}, {n2, u[1], note}, difference(n2 - n1, std::hypot(u[0], u[1]), note)};
               });
  using Strongest = BandMeasures::Difference;
  const auto of_strongest = [&](MetricFacts facts, const std::string& how, double Strongest::*value,
                                double Strongest::*uncertainty) {
    facts.definition += " of the first's strongest shear band (length times strain) and the nearest of the second's that is "
                        "at least half as strong as its strongest, over the stretch that both show" + how;
    rows.add({std::move(facts), [=](const Findings& f) -> std::optional<MetricValue> {
                // A band that reaches the material's edge has no such value.
                if (!f.bands.strongest || !std::isfinite((*f.bands.strongest).*value)) return std::nullopt;
                return difference((*f.bands.strongest).*value, (*f.bands.strongest).*uncertainty, "");
              }});
  };
  const std::string half = "; uncertainty: half a particle spacing of each data set and half the gauge length "
                                       "that is stated (rectangular)";
  of_strongest({.name = "band_offset", .unit = "L", .definition = "mean distance between the ridges",
                .words = "shear bands, distance of the ridges"},
               half, &Strongest::offset, &Strongest::place_uncertainty);
  of_strongest({.name = "band_inclination_difference", .unit = "deg", .definition = "inclination, second minus first,",
                .words = "shear bands, inclination, simulated \u2212 measured"},
               "; uncertainty: half a spacing and half the gauge length over its length (rectangular)", &Strongest::inclination_deg,
               &Strongest::inclination_uncertainty_deg);
  of_strongest({.name = "band_thickness_difference", .unit = "L",
                .definition = "thickness (width at half height), second minus first,",
                .words = "shear bands, thickness, simulated \u2212 measured"},
               half, &Strongest::thickness, &Strongest::place_uncertainty);
  const std::string by_floor = "; uncertainty: covariances of F along the ridges, else the noise floor of the strain";
  of_strongest({.name = "band_peak_difference", .unit = "1",
                .definition = "median deviatoric strain along the ridge (a measured band is at least as wide as its gauge "
                              "length, and so much lower), second minus first,",
                .words = "shear bands, strain of the ridge, simulated \u2212 measured"},
               by_floor, &Strongest::peak, &Strongest::peak_uncertainty);
  of_strongest({.name = "band_slip_difference", .unit = "L",
                .definition = "displacement across the band (sqrt(3) times the integral of deviatoric strain across the "
                              "ridge, out to a tenth of its height, median along it), second minus first,",
                .words = "shear bands, displacement across, simulated \u2212 measured"},
               by_floor + " over both thicknesses, and a tenth of the ridge's strain times the gauge length that is stated",
               &Strongest::slip, &Strongest::slip_uncertainty);
  of_strongest({.name = "band_onset_difference", .unit = "T",
                .definition = "onset (half of its particles above the threshold), second minus first,",
                .words = "shear bands, onset, simulated \u2212 measured"},
               "; uncertainty: the longest step between two times on each data set (rectangular), and, where a gauge length is "
               "stated, what averaging takes off the strain there over its rate", &Strongest::onset,
               &Strongest::onset_uncertainty);
}

}  // namespace

void add_shape_rows(Registry<MetricRow>& rows) {
  add_mobilised(rows);
  add_outlines(rows);
  add_slope(rows);
  add_bands(rows);
}

}  // namespace pivnp::compare

#include "compare/metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

std::string uncertainty_text(const Wording& wording, const std::string& how) {
  if (wording.covariance.empty()) return "; uncertainty not known: neither motion carries a covariance";
  return "; uncertainty: " + how + ", " + wording.covariance;
}

struct Value {
  const char* name;
  double value, uncertainty;
  std::string definition, how;
  double k = 2;  // how many uncertainties are told apart
  double over_u = not_known;  // in units of the uncertainty; NaN: value / uncertainty
};

// Bias, RMS, 95th percentile and maximum of a vector's difference; `of`: "u".
std::vector<Value> vector_values(const DisplacementStatistics& d, const std::string& of) {
  const std::string same_error = "all errors taken as one and the same",
                    size = "|" + of + "_second - " + of + "_first|";
  const ScalarStatistics& scaled = d.over_uncertainty();
  const bool any = scaled.count() > 0;
  const auto mean = [&](const char* axis) { return "mean of " + of + axis + " of the second minus that of the first"; };
  const auto variance = [&](const char* axis) { return "root mean variance of " + of + axis + ", " + same_error; };
  return {{"bias_x", d.bias().x(), d.bias_uncertainty().x(), mean("_x"), variance("_x")},
          {"bias_y", d.bias().y(), d.bias_uncertainty().y(), mean("_y"), variance("_y")},
          {"rms", d.rms(), d.rms_uncertainty(), "root mean square of " + size, "root mean trace of its variance", 2,
           any ? scaled.rms() : not_known},
          {"p95", d.p95(), d.p95_uncertainty(), "95th percentile of " + size + " (nearest rank)",
           "95th percentile of the root trace of its variance; told apart only beyond " +
               number(percentile_factor(d.count()), 3) + " of them",
           percentile_factor(d.count()), scaled.p95()},
          {"max", d.max(), d.max_uncertainty(), "greatest " + size,
           "root trace of its variance where it occurs; of so many errors the greatest is told apart only beyond " +
               number(greatest_factor(d.count()), 3) + " of them",
           greatest_factor(d.count()), any ? scaled.max() : not_known}};
}

void add_values(const std::vector<Value>& values, const std::string& prefix, const Wording& w, const std::string& unit,
                const std::string& per_particle, std::vector<Metric>& metrics) {
  for (const Value& v : values)
    metrics.push_back(difference_metric(prefix + v.name + w.suffix, v.value, unit, v.uncertainty,
                                        v.definition + ", " + w.when + uncertainty_text(w, v.how), v.k));
  for (const Value& v : values) {
    const bool own = std::isfinite(v.over_u);
    if (!own && !(v.uncertainty > 0)) continue;
    metrics.push_back({prefix + v.name + w.suffix + "_over_u", own ? v.over_u : v.value / v.uncertainty, "1", not_known,
                       v.definition + ", " + w.when + (own ? per_particle : ", over its standard uncertainty"), ""});
  }
}

}  // namespace

void add_displacement_metrics(const Tally& tally, const Wording& w, double peak_first, std::vector<Metric>& metrics) {
  const auto values = vector_values(tally.displacement, "u");
  add_values(values, "displacement_", w, w.length_unit,
             ", each divided first by the particle's own standard uncertainty at that time", metrics);
  if (!(peak_first > 0)) return;
  for (const Value& d : values)
    metrics.push_back(difference_metric("displacement_" + std::string(d.name) + w.suffix + "_relative",
                                        d.value / peak_first, "1", d.uncertainty / peak_first,
                                        d.definition + ", " + w.when +
                                            ", over the greatest displacement of the first (displacement_peak_first)" +
                                            uncertainty_text(w, d.how + ", over the same"),
                                        d.k));
}

void add_velocity_metrics(const Rates& rates, const Wording& w, const std::string& unit, std::vector<Metric>& metrics) {
  if (rates.velocity().count() == 0) return;
  Wording here = w;
  here.when += ", velocities by central differences of u over the common times on both sides";
  add_values(vector_values(rates.velocity(), "v"), "velocity_", here, unit,
             ", each divided first by the particle's own standard uncertainty at that time", metrics);
  metrics.push_back({"velocity_peak_first" + w.suffix, rates.peak_first(), unit, not_known,
                     "greatest |v| of the first, " + here.when, ""});
}

void add_strain_metrics(const Tally& tally, const Wording& w, std::vector<Metric>& metrics) {
  const auto add = [&](const std::string& name, const ScalarStatistics& s, double floor, const std::string& of) {
    if (s.count() == 0) return;
    const std::string how =
        std::isnan(floor)
            ? "; uncertainty not known: noise floor not measured (no zone of known error that stayed still)"
        : w.floor.empty()
            ? "; uncertainty: root mean square of this strain where |u| is below 2 of its standard uncertainties, the "
              "noise floor of the still zone" + std::string(w.suffix.empty() ? ", greatest over the times" : "")
            : "; uncertainty: noise floor at the last frame as the record states it for " + w.floor +
                  ", added in squares to that of the other side's still zone, if it carries a covariance";
    const std::vector<Value> values{{"bias", s.bias(), floor, "mean of " + of, ""},
                                    {"rms", s.rms(), floor, "root mean square of " + of, ""},
                                    {"p95", s.p95(), floor, "95th percentile (nearest rank) of the size of " + of, "",
                                     percentile_factor(s.count())},
                                    {"max", s.max(), floor, "greatest size of " + of, "", greatest_factor(s.count())}};
    for (const Value& v : values)
      metrics.push_back(difference_metric(name + "_" + v.name + w.suffix, v.value, "1", v.uncertainty,
                                          v.definition + ", " + w.when + how, v.k));
    for (const Value& v : values)
      if (floor > 0)
        metrics.push_back({name + "_" + v.name + w.suffix + "_over_u", v.value / floor, "1", not_known,
                           v.definition + ", " + w.when + ", over the noise floor", ""});
  };
  add("strain_dev", tally.strain_dev, tally.floor_dev, "deviatoric log strain of the second minus that of the first");
  add("strain_vol", tally.strain_vol, tally.floor_vol,
      "volumetric log strain ln J of the second minus that of the first");
  add("strain_dev_path", tally.strain_path, tally.floor_path,
      "deviatoric strain along the path (sum of sqrt(2/3 de:de) over the common times) of the second minus that of the "
      "first");
}

void add_uncertainty_metrics(const Tally& tally, const Wording& w, std::vector<Metric>& metrics) {
  const auto add = [&](const char* name, double sum, const char* definition) {
    metrics.push_back({name + w.suffix, tally.rms_part(sum), w.length_unit, not_known,
                       std::string(definition) + ", root mean square over particles of the root trace, " + w.when, ""});
  };
  metrics.push_back({"u_val" + w.suffix, tally.displacement.rms_uncertainty(), w.length_unit, not_known,
                     "standard uncertainty of E = u_second - u_first (ASME V&V 20): u_val^2 = u_measurement^2 + "
                     "u_numerical^2 + u_input^2, of those parts that are known; root mean square over particles of the "
                     "root trace, " + w.when, ""});
  add("u_measurement", tally.sum_measurement,
      "part of u_val from the measurements: random error of the displacements, camera, gauge and the frame of "
      "reference");
  add("u_numerical", tally.sum_numerical,
      "part of u_val from the simulation's grid and time step: GCI / 1.15 by coarser grids, or as given; 0 where "
      "neither was given");
  add("u_input", tally.sum_input, "part of u_val from the model's inputs, as given; 0 where it was not");
}

void add_peak_metrics(const Tally& total, const Wording& w, std::vector<Metric>& metrics) {
  const std::string how = "; uncertainty: root trace of the covariance of u there, where known";
  metrics.push_back({"displacement_peak_first", total.peak_first, w.length_unit, total.peak_first_sigma,
                     "greatest |u| of the first, " + w.when + how, ""});
  metrics.push_back({"displacement_peak_second", total.peak_second, w.length_unit, total.peak_second_sigma,
                     "greatest |u| of the second, " + w.when + how, ""});
}

void add_slope_metrics(const SlopeShape& first, const SlopeShape& second, const std::array<double, 2>& spacing,
                       const std::array<double, 2>& sigma, const std::string& unit, std::vector<Metric>& metrics) {
  // An outline is known to within half a particle spacing (rectangular distribution), and as its particles are.
  std::array<double, 2> place;
  for (std::size_t s = 0; s < 2; ++s) place[s] = std::hypot(spacing[s] / std::sqrt(12.0), sigma[s]);
  const std::string place_text = "; uncertainty: half a particle spacing (rectangular) and the error of u, where known";
  const std::string angle_text = "; uncertainty: scatter about the line, one independent point a particle spacing";

  auto both = [&](const std::string& name, double a, double b, const std::string& in, double ua, double ub,
                  const std::string& definition, const std::string& how, bool comparable) {
    metrics.push_back({name + "_first", a, in, ua, definition + ", first" + how, ""});
    metrics.push_back({name + "_second", b, in, ub, definition + ", second" + how, ""});
    if (comparable)
      metrics.push_back(difference_metric(name + "_difference", b - a, in, std::hypot(ua, ub),
                                          definition + ", second minus first" + how));
  };
  const bool same_way = first.faces == second.faces;
  both("run_out_x", first.run_out_x, second.run_out_x, unit, place[0], place[1],
       "x within which 99.5 % of the area above the base lies, on the side the slope faces, at the last common time",
       place_text, same_way);
  both("crest_height", first.crest_height, second.crest_height, unit, place[0], place[1],
       "height above the base below which 99.5 % of the area lies, at the last common time", place_text, true);
  both("slope_angle", first.angle_deg, second.angle_deg, "deg", first.angle_uncertainty_deg,
       second.angle_uncertainty_deg,
       "angle of the line fitted to the area-height profile (area of a column over its width) between 10 and 90 % of "
       "the crest height, on the side the slope faces, at the last common time",
       angle_text, same_way);
}

std::vector<LimitResult> apply_limits(const LimitOptions& limits, std::vector<Metric>& metrics) {
  struct Demand {
    const char* key;
    std::optional<double> limit;
    std::vector<std::string> names;  // the one furthest from the limit counts
    bool least = false;
  };
  const std::vector<Demand> demands = {
      {"displacement_rms_m", limits.displacement_rms_m, {"displacement_rms"}},
      {"displacement_p95_m", limits.displacement_p95_m, {"displacement_p95"}},
      {"displacement_max_m", limits.displacement_max_m, {"displacement_max"}},
      {"displacement_bias_m", limits.displacement_bias_m, {"displacement_bias_x", "displacement_bias_y"}},
      {"velocity_rms_m_s", limits.velocity_rms_m_s, {"velocity_rms"}},
      {"strain_rms", limits.strain_rms, {"strain_dev_rms"}},
      {"strain_p95", limits.strain_p95, {"strain_dev_p95"}},
      {"displacement_over_u", limits.displacement_over_u, {"displacement_rms_over_u"}},
      {"outline_iou_min", limits.outline_iou_min, {"outline_iou"}, true},
      {"hausdorff_m", limits.hausdorff_m, {"outline_hausdorff_95"}},
      {"run_out_m", limits.run_out_m, {"run_out_x_difference"}},
      {"slope_angle_deg", limits.slope_angle_deg, {"slope_angle_difference"}},
      {"coverage_min", limits.coverage_min, {"coverage_first"}, true},
      {"history_rms", limits.history_rms, {"history_rms"}}};
  std::vector<LimitResult> results;
  for (const Demand& d : demands) {
    if (!d.limit) continue;
    LimitResult result{d.key, *d.limit, d.least ? std::numeric_limits<double>::infinity() : 0.0, true};
    std::size_t found = 0;
    for (Metric& m : metrics) {
      if (std::find(d.names.begin(), d.names.end(), m.name) == d.names.end()) continue;
      ++found;
      const double size = d.least ? m.value : std::abs(m.value);
      const bool within = d.least ? size >= *d.limit : size <= *d.limit;  // a value that is not a number is over
      m.verdict = within ? within_limit : over_limit;
      result.within = result.within && within;
      if (std::isnan(size) || (d.least ? size < result.reached : size > result.reached)) result.reached = size;
    }
    if (found == 0) {
      result.within = false;
      result.reached = not_known;
    }
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace pivnp::compare

#include "compare/metrics.hpp"

#include <cmath>
#include <utility>

namespace pivnp::compare {

namespace {

std::string uncertainty_text(const Wording& wording, const std::string& how) {
  if (wording.covariance.empty()) return "; uncertainty not known: neither motion carries a covariance";
  return "; uncertainty: " + how + ", " + wording.covariance;
}

struct Displacement {
  const char* name;
  double value, uncertainty;
  std::string definition, how;
};

std::vector<Displacement> displacement_values(const DisplacementStatistics& d) {
  const std::string same_error = "all errors taken as one and the same";
  return {{"bias_x", d.bias().x(), d.bias_uncertainty().x(), "mean of u_x of the second minus that of the first",
           "root mean variance of u_x, " + same_error},
          {"bias_y", d.bias().y(), d.bias_uncertainty().y(), "mean of u_y of the second minus that of the first",
           "root mean variance of u_y, " + same_error},
          {"rms", d.rms(), d.rms_uncertainty(), "root mean square of |u_second - u_first|",
           "root mean trace of the covariance of u"},
          {"p95", d.p95(), d.p95_uncertainty(), "95th percentile of |u_second - u_first| (nearest rank)",
           "95th percentile of the root trace of the covariance of u"},
          {"max", d.max(), d.max_uncertainty(), "greatest |u_second - u_first|",
           "root trace of the covariance of u where it occurs (the greatest of many errors is several times that)"}};
}

}  // namespace

Metric difference_metric(std::string name, double value, std::string unit, double uncertainty,
                         std::string definition) {
  const bool lost = std::abs(value) < 2 * uncertainty;  // false where the uncertainty is not known
  return {std::move(name), value, std::move(unit), uncertainty, std::move(definition), lost ? not_distinguishable : ""};
}

void add_displacement_metrics(const Tally& tally, const Wording& w, double peak_first, std::vector<Metric>& metrics) {
  const auto values = displacement_values(tally.displacement);
  for (const Displacement& d : values)
    metrics.push_back(difference_metric("displacement_" + std::string(d.name) + w.suffix, d.value, w.length_unit,
                                        d.uncertainty, d.definition + ", " + w.when + uncertainty_text(w, d.how)));
  if (!(peak_first > 0)) return;
  for (const Displacement& d : values)
    metrics.push_back(difference_metric("displacement_" + std::string(d.name) + w.suffix + "_relative",
                                        d.value / peak_first, "1", d.uncertainty / peak_first,
                                        d.definition + ", " + w.when +
                                            ", over the greatest displacement of the first (displacement_peak_first)" +
                                            uncertainty_text(w, d.how + ", over the same")));
}

void add_strain_metrics(const Tally& tally, const Wording& w, std::vector<Metric>& metrics) {
  auto add = [&](const char* name, double value, double floor, const std::string& definition) {
    const std::string how =
        std::isnan(floor)
            ? "; uncertainty not known: noise floor not measured (no zone of known error that stayed still)"
            : "; uncertainty: root mean square of this strain where |u| is below 2 of its standard uncertainties, the "
              "noise floor of the still zone" + std::string(w.suffix.empty() ? ", greatest over the times" : "");
    metrics.push_back(difference_metric(name + w.suffix, value, "1", floor, definition + ", " + w.when + how));
  };
  const std::string dev = "deviatoric log strain of the second minus that of the first";
  const std::string vol = "volumetric log strain ln J of the second minus that of the first";
  add("strain_dev_bias", tally.strain_dev.bias(), tally.floor_dev, "mean of " + dev);
  add("strain_dev_rms", tally.strain_dev.rms(), tally.floor_dev, "root mean square of " + dev);
  add("strain_dev_p95", tally.strain_dev.p95(), tally.floor_dev,
      "95th percentile (nearest rank) of the size of " + dev);
  add("strain_dev_max", tally.strain_dev.max(), tally.floor_dev, "greatest size of " + dev);
  add("strain_vol_bias", tally.strain_vol.bias(), tally.floor_vol, "mean of " + vol);
  add("strain_vol_rms", tally.strain_vol.rms(), tally.floor_vol, "root mean square of " + vol);
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

bool apply_limits(const LimitOptions& limits, std::vector<Metric>& metrics) {
  bool over = false;
  auto judge = [&](const std::string& name, const std::optional<double>& limit) {
    if (!limit) return;
    for (Metric& m : metrics) {
      if (m.name != name) continue;
      const bool within = m.value <= *limit;  // a value that is not a number is over
      m.verdict = within ? within_limit : over_limit;
      over = over || !within;
    }
  };
  judge("displacement_rms", limits.displacement_rms_m);
  judge("strain_dev_rms", limits.strain_rms);
  return over;
}

}  // namespace pivnp::compare

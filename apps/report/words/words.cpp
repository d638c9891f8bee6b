#include "apps/report/words/words.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "apps/plot/numbers.hpp"

#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

namespace {

std::string capitalised(std::string s) {
  if (!s.empty() && s[0] >= 'a' && s[0] <= 'z') s[0] = char(s[0] - 'a' + 'A');
  return s;
}

}  // namespace

std::string field_words(std::string_view name) {
  for (const DerivedField& field : derived_fields())
    if (field.name == name) return field.label;
  std::string s(name);
  std::replace(s.begin(), s.end(), '_', ' ');
  return s;
}

namespace {

struct Phrase {
  const char* words;
  bool statistic = false;  // stands after the subject, set off by a comma
};

// Parts of the metrics' names; the longest that fits counts.
const std::map<std::string, Phrase, std::less<>>& metric_phrases() {
  static const std::map<std::string, Phrase, std::less<>> phrases = {
      {"strain_dev", {"deviatoric strain"}},
      {"strain_vol", {"volumetric strain"}},
      {"strain_dev_path", {"deviatoric strain along the path"}},
      {"u_val", {"uncertainty of a difference, u_val"}},
      {"u_measurement", {"part of u_val from the measurement"}},
      {"u_numerical", {"part of u_val from the numerics"}},
      {"u_input", {"part of u_val from the inputs"}},
      {"outline_iou", {"outlines, share in common (IoU)"}},
      {"outline_hausdorff_95", {"outlines, Hausdorff distance (95 %)"}},
      {"area_metric", {"area metric of the"}},
      {"run_out_x", {"run-out"}},
      {"slope_angle", {"slope angle"}},
      {"crest_height", {"crest height"}},
      {"crest_retreat", {"crest retreat"}},
      {"mobilised_area", {"mobilised area"}},
      {"band_number", {"number of shear bands"}},
      {"band_offset", {"shear bands, distance of the ridges"}},
      {"band_inclination", {"shear bands, inclination"}},
      {"band_thickness", {"shear bands, thickness"}},
      {"band_onset", {"shear bands, onset"}},
      {"decomposition", {"decomposition of the"}},
      {"displacement_x", {"displacement x"}},
      {"displacement_y", {"displacement y"}},
      {"time_offset", {"offset in time"}},
      {"grid_convergence_order", {"order of grid convergence"}},
      {"fixed_zone_shift", {"fixed zone, shift"}},
      {"fixed_zone_rotation", {"fixed zone, rotation"}},
      {"reference_shift", {"reference, shift"}},
      {"coordinate_shift", {"coordinates, shift"}},
      {"coordinate_rotation", {"coordinates, rotation"}},
      {"peak_rate", {"greatest rate", true}},
      {"onset", {"onset", true}},
      {"rest", {"time to rest", true}},
      {"terms", {"coefficients", true}},
      {"outside", {"share of coefficients outside the band", true}},
      {"distance_rms", {"RMS distance", true}},
      {"distance", {"distance of the coefficients", true}},
      {"residual", {"residual", true}},
      {"cluster", {"share of the greatest cluster of residuals", true}},
      {"peak", {"greatest", true}},
      {"rms", {"RMS", true}},
      {"p95", {"95th percentile", true}},
      {"max", {"maximum", true}},
      {"min", {"minimum", true}},
      {"mean", {"mean", true}},
      {"median", {"median", true}},
      {"bias", {"mean difference", true}},
      {"bias_x", {"mean difference in x", true}},
      {"bias_y", {"mean difference in y", true}},
      {"first", {"measured", true}},
      {"second", {"simulated", true}},
      {"final", {"at the end", true}},
      {"relative", {"relative to the greatest displacement", true}},
      {"over_u", {"in units of its uncertainty", true}},
      {"difference", {"simulated \u2212 measured", true}}};
  return phrases;
}

}  // namespace

std::string metric_words(const std::string& name) {
  std::string rest = name, text, statistics;
  const bool levelled = rest.starts_with("levelled_");
  if (levelled) rest.erase(0, 9);
  while (!rest.empty()) {
    std::size_t to = rest.size();
    auto found = metric_phrases().find(rest);
    while (found == metric_phrases().end() && (to = rest.rfind('_', to - 1)) != std::string::npos && to > 0)
      found = metric_phrases().find(rest.substr(0, to));
    const bool known = found != metric_phrases().end();
    if (!known) to = std::min(rest.find('_'), rest.size());
    const std::string words = known ? found->second.words : rest.substr(0, to);
    if (known && found->second.statistic) statistics += ", " + words;
    else if (!words.empty()) text += (text.empty() ? "" : " ") + words;
    rest.erase(0, to + 1);
  }
  if (text.empty() && statistics.size() > 2) text = std::exchange(statistics, "").substr(2);
  return capitalised(text + statistics + (levelled ? ", levelled" : ""));
}

std::string strain_statement(const StrainNote& note, const std::string& length_unit) {
  const DisplayUnit unit = display_unit(length_unit, note.gauge_length);
  std::string text = "Gauge length of measured strains: " + number(note.gauge_length * unit.factor, 3) +
                     unit_suffix(unit.name) + " (shape function and interrogation window). ";
  if (note.floor_source == "not measured")
    return text + "Noise floor: not measured (np.still_zone_px, np.still_zone_m or np.still_frames would tell it).";
  return text + "Noise floor at the last frame, RMS, measured on " +
         (note.floor_source == "still zone" ? "a zone at rest" : "frames at rest, carried on by the square root of the steps") +
         ": deviatoric " + number(note.floor_dev, 2) + ", volumetric " + number(note.floor_vol, 2) +
         ", summed along the path " + number(note.floor_path, 2) + ".";
}

}  // namespace pivnp::report

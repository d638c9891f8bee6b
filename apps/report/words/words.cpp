#include "apps/report/words/words.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp::report {

using namespace plot;

std::string field_words(std::string_view name) {
  for (const DerivedField& field : derived_fields())
    if (field.name == name) return field.label;
  std::string s(name);
  std::replace(s.begin(), s.end(), '_', ' ');
  return s;
}

std::string field_unit(const DerivedField& field, const Content& content) {
  std::string unit = unit_in(field.unit, content.length_unit, content.time_unit);
  if (unit.ends_with("^2")) unit.replace(unit.size() - 2, 2, "\u00b2");
  return unit;
}

std::string frame_words(const Content& content, int frame) {
  const auto n = std::size_t(frame);
  const bool named = frame >= 0 && n < content.frames.size() && !content.frames[n].name.empty();
  return named ? content.frames[n].name : "frame " + std::to_string(frame);
}

namespace {

struct Phrase {
  std::string words;
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
      {"final", {"at the end", true}},
      {"relative", {"relative to the greatest displacement", true}},
      {"over_u", {"in units of its uncertainty", true}}};
  return phrases;
}

std::optional<Phrase> phrase_of(const std::string& part, const DataSetNames& names) {
  if (part == "first") return Phrase{names.first, true};
  if (part == "second") return Phrase{names.second, true};
  if (part == "difference") return Phrase{names.second + " \u2212 " + names.first, true};
  const auto found = metric_phrases().find(part);
  return found == metric_phrases().end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

std::string metric_words(const std::string& name, const DataSetNames& names) {
  std::string rest = name, text, statistics;
  const bool levelled = rest.starts_with("levelled_");
  if (levelled) rest.erase(0, 9);
  while (!rest.empty()) {
    std::size_t to = rest.size();
    std::optional<Phrase> found = phrase_of(rest, names);
    while (!found && (to = rest.rfind('_', to - 1)) != std::string::npos && to > 0)
      found = phrase_of(rest.substr(0, to), names);
    if (!found) to = std::min(rest.find('_'), rest.size());
    const std::string words = found ? found->words : rest.substr(0, to);
    if (found && found->statistic) statistics += ", " + words;
    else if (!words.empty()) text += (text.empty() ? "" : " ") + words;
    rest.erase(0, to + 1);
  }
  if (text.empty() && statistics.size() > 2) text = std::exchange(statistics, "").substr(2);
  return capitalised(text + statistics + (levelled ? ", levelled" : ""));
}

std::string strain_statement(const StrainNote& note, const std::string& length_unit) {
  const DisplayUnit unit = display_unit(length_unit, note.gauge_length);
  std::string text = "Gauge length of measured strains: " + significant(note.gauge_length * unit.factor, 3) +
                     unit_suffix(unit.name) + " (shape function and interrogation window). ";
  if (note.floor_source == "not measured")
    return text + "Noise floor: not measured (np.still_zone_px, np.still_zone_m or np.still_frames would tell it).";
  return text + "Noise floor at the last frame, RMS, measured on " +
         (note.floor_source == "still zone" ? "a zone at rest" : "frames at rest, carried on by the square root of the steps") +
         ": deviatoric " + significant(note.floor_dev, 2) + ", volumetric " + significant(note.floor_vol, 2) +
         ", summed along the path " + significant(note.floor_path, 2) + ".";
}

}  // namespace pivnp::report

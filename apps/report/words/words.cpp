#include "apps/report/words/words.hpp"

#include <algorithm>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "compare/metrics/words.hpp"
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

std::string metric_words(const std::string& name, const DataSetNames& names) {
  std::string text = compare::words_of(name);
  if (!names.alike) return text;
  const DataSetNames apart = data_set_names({});
  for (const auto& [from, to] : {std::pair{apart.first, names.first}, {apart.second, names.second}})
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  return text;
}

std::string strain_statement(const Content& content) {
  if (!content.strain_note) return "";
  const StrainNote& note = *content.strain_note;
  const DisplayUnit unit = display_unit(content.length_unit, note.gauge_length);
  std::string text = "Gauge length of measured strains: " + significant(note.gauge_length * unit.factor, 3) +
                     unit_suffix(unit.name) + " (shape function and interrogation window). ";
  const Metric* compared = content.comparison ? find(content.comparison->metrics, "strain_dev_rms") : nullptr;
  if (note.floor_source == StrainFloor::not_measured && compared != nullptr && compared->uncertainty > 0 &&
      compared->definition.find("compare.") != std::string::npos && compared->definition.find("covariance") == std::string::npos)
    return text + "Noise floor, RMS, in the zone that the comparison declares to stand still: deviatoric " +
           significant(compared->uncertainty, 2) + ".";
  if (note.floor_source == StrainFloor::not_measured)
    return text + "Noise floor: not measured (np.still_zone_px, np.still_zone_m or np.still_frames would give it).";
  return text + "Noise floor at the last frame, RMS, measured on " +
         (note.floor_source == StrainFloor::still_zone
              ? "a zone at rest"
              : "frames at rest, extrapolated by the square root of the number of steps") +
         ": deviatoric " + significant(note.floor_dev, 2) + ", volumetric " + significant(note.floor_vol, 2) +
         ", summed along the path " + significant(note.floor_path, 2) + ".";
}

}  // namespace pivnp::report

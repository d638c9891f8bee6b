#include "apps/report/words/words.hpp"

#include <algorithm>

#include "apps/plot/numbers.hpp"
#include "compare/metrics/words.hpp"
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

std::string metric_words(const std::string& name) { return capitalised(compare::words_of(name)); }

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

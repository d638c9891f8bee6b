#include "apps/report/words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

namespace {

// Decimals without a locale, with a true minus sign.
std::string fixed(double value, int decimals) {
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, std::max(decimals, 0)).ptr;
  std::string s(text.begin(), end);
  const bool zero = s.find_first_of("123456789") == std::string::npos;
  if (s[0] == '-') s = zero ? s.substr(1) : "\u2212" + s.substr(1);
  return s;
}

std::string superscript(int n) {
  static const std::array<const char*, 10> digit = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                                    "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string s;
  for (char c : std::to_string(n)) s += c == '-' ? "\u207b" : digit[std::size_t(c - '0')];
  return s;
}

// Power of ten of the first significant digit after rounding to `digits` of them.
int exponent(double value, int digits) {
  if (value == 0) return 0;
  int e = int(std::floor(std::log10(std::abs(value))));
  if (std::abs(value) / std::pow(10.0, e - digits + 1) >= std::pow(10.0, digits) - 0.5) ++e;
  return e;
}

bool plain_range(int e) { return e >= -4 && e <= 5; }

std::string capitalised(std::string s) {
  if (!s.empty() && s[0] >= 'a' && s[0] <= 'z') s[0] = char(s[0] - 'a' + 'A');
  return s;
}

}  // namespace

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "n/a";
  if (value == 0) return "0";
  const int e = exponent(value, digits);
  if (plain_range(e)) return fixed(value, digits - 1 - e);
  return fixed(value / std::pow(10.0, e), digits - 1) + " \u00d7 10" + superscript(e);
}

std::string value_with_uncertainty(double value, double uncertainty) {
  if (!std::isfinite(value)) return "n/a";
  if (!std::isfinite(uncertainty) || uncertainty <= 0) return number(value);
  const int e_u = exponent(uncertainty, 2);
  const int e = std::max(exponent(value, 3), e_u);  // of the larger of the two
  if (plain_range(e) && e_u >= -6) return fixed(value, 1 - e_u) + " \u00b1 " + fixed(uncertainty, 1 - e_u);
  const double scale = std::pow(10.0, e);
  std::string text = "(";
  text += fixed(value / scale, 1 - e_u + e) + " \u00b1 " + fixed(uncertainty / scale, 1 - e_u + e);
  return text + ") \u00d7 10" + superscript(e);
}

std::string plain(double value) {
  std::string s = number(value, 4);
  if (s.find('.') == std::string::npos) return s;
  const std::size_t end = std::min(s.find(' '), s.size());  // before a power of ten
  std::size_t last = end;
  while (s[last - 1] == '0') --last;
  if (s[last - 1] == '.') --last;
  return s.erase(last, end - last);
}

std::string percent(double share) {
  if (!std::isfinite(share)) return "n/a";
  if (share > 0 && share < 0.0005) return "< 0.1 %";
  if (share < 1 && share > 0.9995) return "> 99.9 %";
  return fixed(100 * share, share == 0 || share == 1 ? 0 : 1) + " %";
}

std::string count(std::size_t n, std::string_view singular, std::string_view plural) {
  std::string digits = std::to_string(n), grouped;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && digits.size() > 4 && (digits.size() - k) % 3 == 0) grouped += "\u202f";
    grouped += digits[k];
  }
  const std::string noun = n == 1           ? std::string(singular)
                           : plural.empty() ? std::string(singular) + "s"
                                            : std::string(plural);
  return grouped + " " + noun;
}

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

std::string unit_suffix(const std::string& unit) { return unit.empty() || unit == "1" ? "" : " " + unit; }

DisplayUnit display_unit(const std::string& unit, double largest) {
  if (unit == "m" && largest > 0 && largest < 2e-4) return {1e6, "\u00b5m"};
  if (unit == "m" && largest > 0 && largest < 0.5) return {1e3, "mm"};
  return {1, unit};
}

std::string clean_utf8(std::string_view text) {
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    const auto c = static_cast<unsigned char>(text[k]);
    const std::size_t length = c < 0x80                ? 1
                               : c >= 0xc2 && c < 0xe0 ? 2
                               : c >= 0xe0 && c < 0xf0 ? 3
                               : c >= 0xf0 && c < 0xf5 ? 4
                                                       : 0;
    bool good = length > 0 && k + length <= text.size();
    for (std::size_t j = 1; good && j < length; ++j) good = (static_cast<unsigned char>(text[k + j]) & 0xc0) == 0x80;
    if (good && length >= 3) {  // overlong forms, surrogates, beyond U+10FFFF
      const auto d = static_cast<unsigned char>(text[k + 1]);
      good =
          !((c == 0xe0 && d < 0xa0) || (c == 0xed && d >= 0xa0) || (c == 0xf0 && d < 0x90) || (c == 0xf4 && d >= 0x90));
    }
    if (!good) {
      out += "\ufffd";
      ++k;
      continue;
    }
    if (length > 1 || c == '\n' || c == '\t' || (c >= 0x20 && c != 0x7f)) out.append(text.substr(k, length));
    k += length;
  }
  return out;
}

std::string escape_html(std::string_view text) {
  std::string out;
  for (char c : clean_utf8(text)) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
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

// Numbers and names as a reader expects them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "pivnp/core/record/strain_note.hpp"

namespace pivnp::report {

/// The value with as many digits as two significant digits of `uncertainty` support: "0.01234 ± 0.00056", or
/// "(1.234 ± 0.056) × 10⁻⁵" away from 1. An uncertainty that is NaN or not positive leaves three significant
/// digits and no ±. Not finite: "n/a".
std::string value_with_uncertainty(double value, double uncertainty);

/// `digits` significant digits, powers of ten written out, true minus sign. Not finite: "n/a".
std::string number(double value, int digits = 3);

/// A time or a coordinate: four significant digits at most, no zeros at the end.
std::string plain(double value);

/// "12.3 %" of a share; "n/a" if not finite. A share that is not 0 or 1 is not rounded to it.
std::string percent(double share);

/// "1 particle", "26 frames", "12 345 particles".
std::string count(std::size_t n, std::string_view singular, std::string_view plural = "");

/// displacement_rms -> "Displacement, RMS"; an unknown name keeps its words.
std::string metric_words(const std::string& name);

/// displacement_magnitude -> "displacement", strain_dev -> "deviatoric strain".
std::string field_words(std::string_view name);

/// `unit` as printed beside a number: "" and "1" vanish.
std::string unit_suffix(const std::string& unit);

/// A unit that suits numbers up to `largest`: metres become mm or µm where they are small; other units stay.
struct DisplayUnit {
  double factor = 1;  // shown = stored * factor
  std::string name;
};
DisplayUnit display_unit(const std::string& unit, double largest);

/// The sentence that goes with every measured strain: gauge length and noise floor, or that it was not measured.
std::string strain_statement(const StrainNote& note, const std::string& length_unit);

/// Text safe between tags and in quoted attributes. Bytes that are not UTF-8 become U+FFFD, control characters (but
/// tab and newline) vanish.
std::string escape_html(std::string_view text);

/// The same cleaning without the escaping: what Qt and a reader can take.
std::string clean_utf8(std::string_view text);

}  // namespace pivnp::report

// Numbers and units as a reader expects them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pivnp::plot {

/// The value with as many digits as two significant digits of `uncertainty` support: "0.01234 ± 0.00056", or
/// "(1.234 ± 0.056) × 10⁻⁵" away from 1. An uncertainty that is NaN or not positive leaves three significant
/// digits and no ±. Not finite: "n/a".
std::string value_with_uncertainty(double value, double uncertainty);

/// `digits` significant digits, powers of ten written out, true minus sign. Not finite: "n/a".
std::string significant(double value, int digits = 3);

/// A time or a coordinate: four significant digits at most, no zeros at the end.
std::string plain(double value);

/// "12.3 %" of a share; "n/a" if not finite. A share that is not 0 or 1 is not rounded to it.
std::string percent(double share);

/// "1 particle", "26 frames", "12 345 particles".
std::string count(std::size_t n, std::string_view singular, std::string_view plural = "");

/// `unit` as printed in a column of its own: "" and "1" vanish.
std::string unit_words(const std::string& unit);
/// The same beside a number, after a space.
std::string unit_suffix(const std::string& unit);

/// A unit that suits numbers up to `largest`: metres become mm or µm where they are small, pascals kPa or MPa where
/// they are large; other units stay.
struct DisplayUnit {
  double factor = 1;  // shown = stored * factor
  std::string name;
};
DisplayUnit display_unit(const std::string& unit, double largest);

/// Quantile q of the finite values; NaN if there is none.
double quantile(std::vector<double> values, double q);

}  // namespace pivnp::plot

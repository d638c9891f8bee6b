#include "apps/plot/numbers.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace pivnp::plot {

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

}  // namespace

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "n/a";
  if (value == 0) return "0";
  const int e = exponent(value, digits);
  if (plain_range(e)) return fixed(value, digits - 1 - e);
  return fixed(value / std::pow(10.0, e), digits - 1) + " \u00d7 10" + superscript(e);
}

std::string value_with_uncertainty(double value, double uncertainty) {
  if (!std::isfinite(value)) return "n/a";
  if (!std::isfinite(uncertainty) || uncertainty <= 0) return significant(value);
  const int e_u = exponent(uncertainty, 2);
  const int e = std::max(exponent(value, 3), e_u);  // of the larger of the two
  if (plain_range(e) && e_u >= -6) return fixed(value, 1 - e_u) + " \u00b1 " + fixed(uncertainty, 1 - e_u);
  const double scale = std::pow(10.0, e);
  std::string text = "(";
  text += fixed(value / scale, 1 - e_u + e) + " \u00b1 " + fixed(uncertainty / scale, 1 - e_u + e);
  return text + ") \u00d7 10" + superscript(e);
}

std::string plain(double value) {
  std::string s = significant(value, 4);
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

std::string unit_words(const std::string& unit) { return unit == "1" ? "" : unit; }
std::string unit_suffix(const std::string& unit) {
  if (unit == "frame") return " frames";  // times that are counted, for want of a rate
  return unit_words(unit).empty() ? "" : " " + unit;
}

DisplayUnit display_unit(const std::string& unit, double largest) {
  if (unit == "m" && largest > 0 && largest < 2e-4) return {1e6, "\u00b5m"};
  if (unit == "m" && largest > 0 && largest < 0.5) return {1e3, "mm"};
  if (unit == "Pa" && largest >= 2e6) return {1e-6, "MPa"};
  if (unit == "Pa" && largest >= 2e3) return {1e-3, "kPa"};
  return {1, unit};
}

double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = values.begin() + std::ptrdiff_t(std::lround(q * double(values.size() - 1)));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace pivnp::plot

#include "pivnp/core/options.hpp"

#include <charconv>
#include <cmath>

namespace pivnp {

namespace {

std::string shortest(double value) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

}  // namespace

bool excludes_max(const OptionInfo& info) {
  const double whole = std::round(info.max);
  return info.max < whole && std::nextafter(info.max, whole) == whole;
}

std::string range_text(const OptionInfo& info) {
  const bool low = std::isfinite(info.min), high = std::isfinite(info.max);
  const std::string above = info.above_min ? "more than " : "at least ";
  if (low && high && !info.above_min) return shortest(info.min) + " to " + shortest(info.max);
  if (low && high && excludes_max(info)) return above + shortest(info.min) + " and less than " + shortest(std::round(info.max));
  if (low && high) return above + shortest(info.min) + " and at most " + shortest(info.max);
  if (low) return above + shortest(info.min);
  if (high) return "at most " + shortest(info.max);
  return "";
}

}  // namespace pivnp

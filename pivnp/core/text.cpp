#include "pivnp/core/text.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace pivnp {

namespace {

// Levenshtein distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(const std::string& found, const std::vector<std::string>& known) {
  if (known.empty()) return "";
  // A name whose beginning was typed counts as near: window -> window_px.
  auto cost = [&](const std::string& k) {
    const std::size_t d = edit_distance(found, k);
    return found.size() >= 3 && k.starts_with(found) ? std::min<std::size_t>(d, 1) : d;
  };
  const auto best = std::min_element(known.begin(), known.end(),
                                     [&](const std::string& a, const std::string& b) { return cost(a) < cost(b); });
  if (cost(*best) <= std::max<std::size_t>(2, found.size() / 3)) return "; did you mean '" + *best + "'?";
  constexpr std::size_t most = 20;
  std::string list = "; known: ";
  for (std::size_t k = 0; k < std::min(most, known.size()); ++k) list += (k ? ", " : "") + known[k];
  if (known.size() > most) list += " ... (" + std::to_string(known.size()) + ")";
  return list;
}

std::string one_of(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k)
    list += (k == 0 ? "" : k + 1 < names.size() ? ", " : " or ") + names[k];
  return list;
}

std::string number(double value, int digits) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
  return buffer;
}

}  // namespace pivnp

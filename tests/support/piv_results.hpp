// Figures of a row of the table over seeds and groups, against what is asked.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/piv_rows.hpp"
#include "tests/support/piv_score.hpp"

namespace pivnp::piv {

struct Figures {
  Errors e;
  double width = NAN, rate = 0;
};

/// Worst and mean of a row, or of a group of rows, over the seeds.
struct RowResult {
  std::string name = {};
  RowKind kind = RowKind::clean;
  RowLimits limits = {};
  std::string clean_row = {};
  double true_width = NAN;
  double rms = 0, rms_sum = 0, bias = 0, valid = 1, gain = NAN, width = NAN, one = 0, two = 0, sigma = 0;
  std::vector<double> rates = {};
  int count = 0;

  void add(const Figures& f) {
    // a row without a valid vector has no rms: it must not pass
    const auto worst = [](double a, double b) { return std::isnan(b) ? HUGE_VAL : std::max(a, b); };
    rms = worst(rms, f.e.rms), bias = worst(bias, f.e.bias), valid = std::min(valid, f.e.valid);
    rms_sum += f.e.rms, one += f.e.within_one, two += f.e.within_two, sigma += f.e.sigma;
    if (limits.gain > 0 || name.starts_with("sine")) gain = std::isnan(gain) ? f.e.gain : std::min(gain, f.e.gain);
    if (!std::isnan(f.width) && (std::isnan(width) || std::abs(f.width - true_width) > std::abs(width - true_width)))
      width = f.width;
    rates.push_back(f.rate), ++count;
  }
};

/// Largest figure over its limit; at most 1 if the row is met. Shares are compared by what is lacking.
inline double excess(const RowResult& j, double slack) {
  double worst = 0;
  if (j.limits.rms > 0) worst = std::max(worst, j.rms / (slack * j.limits.rms));
  if (j.limits.bias > 0) worst = std::max(worst, j.bias / (slack * j.limits.bias));
  if (j.limits.gain > 0 && !(j.gain >= 1 - slack * (1 - j.limits.gain)))
    worst = std::max(worst, std::isnan(j.gain) ? HUGE_VAL : (1 - j.gain) / (slack * (1 - j.limits.gain)));
  if (j.valid < j.limits.valid)
    worst = std::max(worst, j.limits.valid < 1 ? (1 - j.valid) / (1 - j.limits.valid) : HUGE_VAL);
  return worst;
}

inline RowResult& result_of(std::vector<RowResult>& all, const Row& row) {
  const std::string& name = row.group.empty() ? row.name : row.group;
  for (RowResult& j : all)
    if (j.name == name) return j;
  RowResult j{.name = name, .kind = row.kind, .limits = row.limits, .clean_row = row.clean_row};
  if (row.band_half_width > 0) j.true_width = 2 * std::atanh(0.8) * row.band_half_width;
  all.push_back(j);
  return all.back();
}

/// Limits that are multiples of another row's figure become px, where that row was run; else nothing is asked.
inline void resolve(RowResult& j, const std::vector<RowResult>& all, double slack) {
  if (j.clean_row.empty()) return;
  const auto clean = std::find_if(all.begin(), all.end(), [&](const RowResult& o) { return o.name == j.clean_row; });
  j.limits.rms = clean == all.end() ? 0 : j.limits.rms * clean->rms / slack;
}

/// Shares of errors within one and two stated standard deviations, over the rows of one kind of image.
struct Coverage {
  const char* kind = "";
  double one = 0, two = 0;
  bool met() const { return one >= .60 && one <= .76 && two >= .90 && two <= .98; }
};

inline std::vector<Coverage> coverage(const std::vector<RowResult>& rows) {
  constexpr const char* names[] = {"clean", "gradient", "noise", "loss", "illumination"};
  std::vector<Coverage> kinds;
  for (int kind = 0; kind < 5; ++kind) {
    Coverage c{.kind = names[kind]};
    int count = 0;
    for (const RowResult& j : rows)
      if (static_cast<int>(j.kind) == kind) c.one += j.one, c.two += j.two, count += j.count;
    if (count == 0) continue;
    c.one /= count, c.two /= count;
    kinds.push_back(c);
  }
  return kinds;
}

}  // namespace pivnp::piv

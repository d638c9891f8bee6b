// Words agree with numbers: 200 comparisons are made up, and what their reports say is read back.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <regex>

#include "apps/report/document/tables.hpp"
#include "apps/report/words/flags.hpp"
#include "apps/report/words/summary.hpp"
#include "compare/metrics/significance.hpp"
#include "tests/unit/report/synthetic.hpp"

namespace pivnp::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// "14.0 mm", "1.2 × 10⁻⁴ m": the number in m, or as it stands without a unit of length.
double number_in(std::string text) {
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from)) text.replace(at, from.size(), to);
  };
  replace("\u2212", "-");
  const char* const digits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074", "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  replace("\u207b", "-");
  for (int d = 0; d < 10; ++d) replace(digits[d], std::to_string(d));
  replace(" \u00d7 10", "e");
  std::size_t used = 0;
  const double value = std::stod(text, &used);
  const std::string unit = text.substr(used);
  return unit.starts_with(" mm") ? value * 1e-3 : unit.starts_with(" \u00b5m") || unit.starts_with(" \u03bcm") ? value * 1e-6 : value;
}

std::string after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == std::string::npos ? "" : text.substr(at + words.size());
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

struct Drawn {
  Content content;
  double rms, u, strain, floor;
  std::size_t limits = 0, missed = 0;
};

Drawn draw(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const auto log_between = [&](double low, double high) { return low * std::pow(high / low, share(random)); };
  // A third near the edge of two, some not known.
  const auto uncertainty = [&](double value) {
    const double kind = share(random);
    if (kind < 0.15) return nan;
    if (kind < 0.2) return 0.0;
    return value / (kind < 0.5 ? 1.9 + 0.2 * share(random) : log_between(0.05, 300));
  };
  Drawn d;
  d.rms = log_between(2e-5, 0.5), d.u = uncertainty(d.rms);
  d.strain = log_between(1e-4, 0.9), d.floor = uncertainty(d.strain);
  Comparison c;
  const auto add = [&](const char* name, double value, const char* unit, double u) {
    c.metrics.push_back({name, value, unit, u, "", Verdict::none, std::isnan(u) ? nan : 2.0});
  };
  add("displacement_rms", d.rms, "m", d.u);
  add("displacement_peak_first", d.rms * log_between(1, 100), "m", nan);
  add("displacement_rms_final", d.rms * 1.5, "m", d.u * 1.5);
  add("strain_dev_rms", d.strain, "1", d.floor);
  add("strain_dev_rms_final", 2 * d.strain, "1", d.floor);
  add("u_val", d.u, "m", nan);
  add("u_numerical", share(random) < 0.5 ? 0 : d.u * share(random), "m", nan);
  for (const char* name : {"run_out_x", "slope_angle", "crest_retreat"}) {
    if (share(random) < 0.3) continue;
    const double first = log_between(0.01, 40), apart = (share(random) < 0.5 ? -1 : 1) * log_between(1e-3, 1) * first;
    const char* unit = name == std::string("slope_angle") ? "deg" : "m";
    add((std::string(name) + "_first").c_str(), first, unit, nan);
    add((std::string(name) + "_second").c_str(), first + apart, unit, nan);
    add((std::string(name) + "_difference").c_str(), apart, unit, uncertainty(std::abs(apart)));
  }
  compare::judge(c.metrics, {}, "m");
  for (const char* key : {"displacement_rms_m", "strain_rms", "run_out_m"}) {
    if (share(random) < 0.5) continue;
    const bool met = share(random) < 0.5;
    c.limits.push_back({key, 0.02, met ? 0.01 : 0.03, met});
    ++d.limits;
    d.missed += !met;
  }
  d.content.comparison = std::move(c);
  return d;
}

// What is said goes with the numbers, and nothing is "real" or "by chance".
void expect_judgement(const std::string& sentence, double value, double u) {
  const bool known = std::isfinite(u) && u > 0;
  const auto says = [&](const char* words) { return sentence.find(words) != std::string::npos; };
  EXPECT_EQ(says("There is no verdict") || says("without a verdict"), !known) << sentence;
  EXPECT_EQ(says("times the measurement") || says("times the errors") || says("times their uncertainty"), known && value >= 2 * u)
      << sentence << value / u;
  EXPECT_EQ(says("agree within") || says("not resolved"), known && value < 2 * u) << sentence << value / u;
  EXPECT_FALSE(says("real") || says("chance")) << sentence;
}

TEST(Summary, SentencesSayWhatTheNumbersSay) {
  std::mt19937 random(20261123);
  const DataSetNames names{false, "measured", "simulated", "the measurement", "the simulation"};
  for (int run = 0; run < 200; ++run) {
    const Drawn d = draw(random);
    DifferenceCurve curve;
    std::size_t worst = 0;
    for (int k = 0; k < 6; ++k) {
      curve.time.push_back(0.25 * k);
      curve.rms.push_back(d.rms * std::uniform_real_distribution<double>(0.5, 2)(random));
      if (curve.rms.back() > curve.rms[worst]) worst = std::size_t(k);
    }
    const std::string text = summary(d.content, names, curve);
    const std::string when = after(text, "largest at ");
    EXPECT_NEAR(number_in(when), curve.time[worst], 1e-9);
    EXPECT_NEAR(number_in(after(when, " s, ")), curve.rms[worst], 0.006 * curve.rms[worst]);
    SCOPED_TRACE(std::to_string(run) + ": " + text);
    EXPECT_NEAR(number_in(after(text, "differ by ")), d.rms, 0.006 * d.rms);
    const std::size_t strain_at = text.find(" The deviatoric strains"), end = text.find("Not in these");
    ASSERT_NE(strain_at, std::string::npos);
    expect_judgement(text.substr(0, strain_at), d.rms, d.u);
    std::string strain = text.substr(strain_at, (end == std::string::npos ? text.find("limit", strain_at) : end) - strain_at);
    expect_judgement(strain, d.strain, d.floor);
    EXPECT_NEAR(number_in(after(strain, "differ by ")), d.strain, 0.006 * d.strain);
    if (const std::string stated = after(text.substr(0, strain_at), "u_val is "); !stated.empty()) {
      EXPECT_NEAR(number_in(stated), d.u, 0.06 * d.u);
    }
    const bool numerics = find(d.content.comparison->metrics, "u_numerical")->value > 0;
    EXPECT_EQ(text.find("compare.mesh_study") == std::string::npos, numerics);
    EXPECT_NE(text.find("compare.input_uncertainty_m"), std::string::npos);
    EXPECT_EQ(text.find("No limit was stated") != std::string::npos, d.limits == 0);
    EXPECT_EQ(text.find(" exceeded.") != std::string::npos, d.missed > 0);
    if (d.missed > 0) {
      const std::string words = d.limits == 1 ? " The limit that was stated is exceeded"
                                              : " " + std::to_string(d.missed) + " of " + std::to_string(d.limits) + " limits";
      EXPECT_NE(text.find(words), std::string::npos);
    }
    std::size_t flagged = 0;
    for (const std::string& flag : flags(d.content)) flagged += count_of(flag, "is exceeded");
    EXPECT_EQ(flagged, d.missed);
  }
}

// What is lost particle by particle may be plain on average; what is withheld is neither; a limit that is met may be so by
// chance.
TEST(Summary, AveragesToleranceAndWhatIsWithheld) {
  const DataSetNames names{false, "measured", "simulated", "the measurement", "the simulation"};
  const double nan = std::nan("");
  Content content;
  Comparison c;
  c.metrics = {{"displacement_rms", 0.003, "m", 0.002, "", Verdict::agrees, 2},
               {"displacement_field_x", 1e-4, "m", 2e-4, "", Verdict::agrees, 2},
               {"displacement_field_y", -2e-3, "m", 4e-4, "", Verdict::larger, 2}};
  LimitResult limit{"displacement_rms_m", 0.005, 0.003, true};
  limit.within = 0.00629;
  c.limits = {limit};
  content.comparison = c;
  std::string text = summary(content, names, {});
  EXPECT_NE(text.find("They agree within 6.3 mm (95 %)"), std::string::npos) << text;
  EXPECT_NE(text.find("a difference of 7.3 mm would have been found in 95 of 100 cases"), std::string::npos) << text;
  EXPECT_NE(text.find("the difference is \u22122.0 mm in y, 5.0 times"), std::string::npos) << text;
  EXPECT_NE(text.find("Not shown with 95 % is displacement_rms_m (only 0.00629 is)"), std::string::npos) << text;
  content.comparison->metrics[0].verdict = Verdict::withheld;
  content.comparison->metrics[0].uncertainty = nan;
  text = summary(content, names, {});
  EXPECT_NE(text.find("Too little of the material was compared"), std::string::npos) << text;
  EXPECT_EQ(text.find("on average"), std::string::npos) << text;
}

TEST(Summary, TheTablesVerdictsFollowItsCells) {
  std::mt19937 random(20261124);
  const DataSetNames names{false, "measured", "simulated", "the measurement", "the simulation"};
  std::size_t rows = 0;
  for (int run = 0; run < 200; ++run) {
    const Drawn d = draw(random);
    const auto table = summary_table(d.content, names);
    ASSERT_TRUE(table);
    EXPECT_LE(table->rows.size(), 8u);
    for (const std::vector<std::string>& row : table->rows) {
      ++rows;
      SCOPED_TRACE(row[0] + " | " + row[3] + " | " + row[4] + " | " + row[5]);
      if (row[4] == "not known") {
        EXPECT_TRUE(row[5].starts_with("no uncertainty"));
        continue;
      }
      const double apart = std::abs(number_in(row[3])), counts_from = number_in(row[4]);
      if (std::abs(apart / counts_from - 1) < 0.07) continue;  // two digits do not show on which side it lies
      EXPECT_EQ(row[5].starts_with("larger") || row[5].starts_with("differs"), apart > counts_from);
      if (row[1] != "\u2013" && row[0] != table->rows[0][0]) {
        EXPECT_NEAR(number_in(row[2]) - number_in(row[1]), number_in(row[3]), 0.011 * (std::abs(number_in(row[1])) + std::abs(number_in(row[2]))));
      }
    }
  }
  EXPECT_GT(rows, 800u);
}

// One curve ends before the other: only what both cover was compared.
TEST(Summary, HistoriesAreComparedWhereBothAreKnown) {
  Content content;
  Comparison c;
  c.metrics.push_back({"history_rms", 0.01, "m", nan, ""});
  c.tables = {{history_table(DataSetRole::first), "a", {{"time", "s", {0.43, 1.0, 1.929}}, {"value", "m", {0, 1, 2}}}},
              {history_table(DataSetRole::second), "b", {{"time", "s", {0.1, 1.2}}, {"value", "m", {0, 1}}}}};
  content.comparison = c;
  const std::string text = histories_summary(content);
  EXPECT_NE(text.find("between 0.43 and 1.2 s"), std::string::npos) << text;
}

}  // namespace
}  // namespace pivnp::report

// Metrics and limits are listed once: what is added there arrives everywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "compare/metrics/rows.hpp"
#include "compare/metrics/words.hpp"
#include "pivnp/core/error.hpp"
#include "tests/unit/compare/motions.hpp"
#include "tests/support/added.hpp"

namespace pivnp::compare {
namespace {

const MotionMemory still = motion_of("a", block(), {0, 1}, [](const Vec2&, double) { return Vec2(0, 0); });

TEST(MetricRegistry, EveryRowIsWhole) {
  std::set<std::string> limits;
  for (const MetricRow& row : metric_rows()) {
    for (const std::string* text : {&row.name, &row.unit, &row.definition, &row.words}) EXPECT_FALSE(text->empty()) << row.name;
    EXPECT_TRUE(row.value) << row.name;
    EXPECT_EQ(words_of(row.name), row.words);
    if (!row.limit.empty()) limits.insert(row.limit);
  }
  for (const HistoryMetricRow& row : history_metric_rows()) {
    EXPECT_EQ(words_of("history_" + row.name), "history, " + row.words);
    EXPECT_EQ(words_of("point_12_" + row.name), "point 12, " + row.words);
    EXPECT_EQ(limit_of("point_12_" + row.name), "");
    if (!row.limit.empty()) limits.insert(row.limit);
  }
  std::set<std::string> keys;
  for (const LimitRow& row : limit_rows()) keys.insert(row.name);
  EXPECT_EQ(limits, keys);  // every limit holds a metric, and every metric names one that is there
}

TEST(MetricRegistry, EveryMetricOfAComparisonHasItsRow) {
  CompareOptions options;
  options.points_m = {{2.5, 2.5}};
  options.slope_base_m = -1;
  options.fixed_zone_m = {{0, 0}, {3, 0}, {3, 5}, {0, 5}};
  const Comparison c = compared(motion_of("a", block(), {0, 0.5, 1}, shear, shear_F), still, options);
  for (const Metric& m : c.metrics) {
    const auto known = known_metric(m.name);
    ASSERT_TRUE(known) << m.name;
    EXPECT_EQ(m.definition.find("{}"), std::string::npos) << m.name;
  }
}

TEST(MetricRegistry, ARowThatIsAddedArrives) {
  {
    const test::Added limit_row(limit_rows(), {.name = "slant_max", .unit = "", .text = "greatest slant"});
    const test::Added row(metric_rows(), MetricRow{{.name = "slant", .unit = "L/T", .definition = "made up by a test", .words = "slant of a test",
                        .limit = "slant_max", .leads = Leads::yes},
                       [](const Findings& f) { return difference(0.5 * f.total().peak_first, 0.1, ", with a note"); }});
    LimitOptions limits;
    bool listed = false;
    LimitOptions::fields(limits, [&](std::string_view key, std::optional<double>& limit, const OptionInfo& info) {
      if (key != "slant_max") return;
      listed = info.text == "greatest slant";
      limit = 0.2;
    });
    EXPECT_TRUE(listed);
    const Comparison c = compared(motion_of("a", block(), {0, 1}, shear, shear_F), still, {}, limits);
    const Metric* found = find(c.metrics, "slant");
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->value, 0.5 * metric(c, "displacement_peak_first").value);
    EXPECT_EQ(found->unit, "m/s");
    EXPECT_EQ(found->uncertainty, 0.1);
    EXPECT_EQ(found->definition, "made up by a test, with a note");
    EXPECT_EQ(found->limit, LimitFate::exceeded);
    ASSERT_EQ(c.limits.size(), 1U);
    EXPECT_EQ(c.limits[0].key, "slant_max");
    EXPECT_EQ(c.limits[0].reached, found->value);
    EXPECT_EQ(words_of("slant"), "slant of a test");
    EXPECT_TRUE(leads("slant"));
  }
  EXPECT_FALSE(known_metric("slant"));
}

TEST(MetricRegistry, ARowOfHistoriesThatIsAddedArrives) {
  const test::Added row(history_metric_rows(), HistoryMetricRow{{.name = "sway", .unit = "L", .definition = "made up by a test",
                                                                 .words = "sway of a test"},
                                                                [](const HistoryMeasures&) { return difference(3, 0.1, ""); }});
  HistoryMeasures measures;
  measures.subject = "history";
  const std::vector<Metric> metrics = metrics_of(measures);
  const Metric* found = find(metrics, "history_sway");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->value, 3);
  EXPECT_EQ(found->definition, "made up by a test");
  EXPECT_NE(words_of("history_sway").find("sway of a test"), std::string::npos);
}

TEST(Limits, AnUnknownKeyIsRefused) {
  LimitOptions limits;
  EXPECT_THROW(limits["displacment_rms_m"], InputError);
  EXPECT_FALSE(limits.any());
  limits["strain_rms"] = 0.1;
  EXPECT_TRUE(limits.any());
}

}  // namespace
}  // namespace pivnp::compare

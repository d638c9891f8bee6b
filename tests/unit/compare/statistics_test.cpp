// Sums and quantiles against values worked by hand.
#include "compare/data/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "compare/metrics/significance.hpp"

namespace pivnp::compare {
namespace {

TEST(Quantile, NearestRank) {
  Quantile q;
  EXPECT_TRUE(std::isnan(q.at(0.95)));
  for (int k = 20; k >= 1; --k) q.add(k);
  EXPECT_EQ(q.at(0.95), 19);  // 19 of 20 values are at most 19
  EXPECT_EQ(q.at(0.951), 20);
  EXPECT_EQ(q.at(0.5), 10);
  EXPECT_EQ(q.at(1), 20);
}

TEST(Quantile, BinsAgreeWithExactValuesToTheirWidth) {
  Quantile q;
  const std::size_t count = Quantile::exact_limit + 100000;
  for (std::size_t k = 0; k < count; ++k) q.add(1e-5 * double((k * 2654435761ULL) % count));  // each of 0..count-1 once
  for (double share : {0.05, 0.5, 0.95, 0.999}) {
    const double exact = 1e-5 * (std::ceil(share * double(count)) - 1);
    EXPECT_NEAR(q.at(share) / exact, 1, 1.0 / 4096) << share;
  }
}

TEST(VectorStatistics, WorkedByHand) {
  VectorStatistics d;
  d.add(Vec2(3, 4), 0.09, 0.16);   // |d| = 5, sigma 0.5
  d.add(Vec2(-3, 0), 0.01, 0.04);  // |d| = 3
  d.add(Vec2(0, -1), 0.02, 0.01);
  EXPECT_NEAR(d.bias().x(), 0, 1e-15);
  EXPECT_NEAR(d.bias().y(), 1, 1e-15);
  EXPECT_NEAR(d.rms(), std::sqrt(35.0 / 3), 1e-14);
  EXPECT_EQ(d.p95(), 5);
  EXPECT_EQ(d.max(), 5);
  EXPECT_NEAR(d.bias_uncertainty().x(), std::sqrt(0.12 / 3), 1e-15);
  EXPECT_NEAR(d.bias_uncertainty().y(), std::sqrt(0.21 / 3), 1e-15);
  EXPECT_NEAR(d.rms_uncertainty(), std::sqrt(0.33 / 3), 1e-15);
  EXPECT_NEAR(d.max_uncertainty(), 0.5, 1e-15);
  EXPECT_NEAR(d.p95_uncertainty(), 0.5, 1e-15);
  d.add(Vec2(0, 0), not_known, not_known);
  EXPECT_TRUE(std::isnan(d.rms_uncertainty()));
  EXPECT_TRUE(std::isnan(d.p95_uncertainty()));
}

TEST(ScalarStatistics, SignedBiasUnsignedRest) {
  ScalarStatistics s;
  for (double v : {-2.0, 1.0, -2.0}) s.add(v);
  EXPECT_EQ(s.bias(), -1);
  EXPECT_NEAR(s.rms(), std::sqrt(3.0), 1e-15);
  EXPECT_EQ(s.p95(), 2);
  EXPECT_EQ(s.max(), 2);
}

TEST(StillZone, NeedsEnoughParticlesThatHaveStrain) {
  StillZone zone;
  for (std::size_t k = 0; k < StillZone::least - 1; ++k) zone.add(0.003, -0.002, 0.005);
  zone.add(not_known, 1, 1);
  EXPECT_TRUE(std::isnan(zone.dev()));
  zone.add(0.003, -0.002, 0.005);
  EXPECT_NEAR(zone.dev(), 0.003, 1e-15);
  EXPECT_NEAR(zone.vol(), 0.002, 1e-15);
  EXPECT_NEAR(zone.path(), 0.005, 1e-15);
}

// No word is stronger than what is known. Units do not matter, nor does the sign.
TEST(Verdict, Words) {
  const auto judged = [](double value, double u, KnownParts known = {}, double mesh = not_known, double inputs = not_known,
                         double scale = not_known) {
    const auto in_unit = [&](double unit) {
      Metric m{"", unit * value, "m", std::abs(unit) * u, "", Verdict::none, 2};
      m.numerical = std::abs(unit) * mesh;
      m.input = std::abs(unit) * inputs;
      m.scale = std::abs(unit) * scale;
      judge(m, known);
      return std::pair(m.verdict, m.lost_in);
    };
    for (const double unit : {-1.0, 1e-3, 7.0}) EXPECT_EQ(in_unit(unit), in_unit(1));
    return in_unit(1);
  };
  const auto word = [](Verdict verdict, LostIn lost = LostIn::nothing) { return std::pair(verdict, lost); };
  EXPECT_EQ(judged(1.9, 1), word(Verdict::agrees));
  EXPECT_EQ(judged(2.1, 1), word(Verdict::larger));
  EXPECT_EQ(judged(2.1, 1, {.numerical = true}), word(Verdict::larger));
  EXPECT_EQ(judged(2.1, 1, {true, true}), word(Verdict::differs));
  // Nothing is said where the uncertainty is not known, nor of zero against zero.
  EXPECT_EQ(judged(3, not_known), word(Verdict::none));
  EXPECT_EQ(judged(0, 0), word(Verdict::none));
  EXPECT_EQ(judged(3, 0), word(Verdict::none));
  // 61 mm beside 5 mm of the measurement: the mesh is no chance.
  EXPECT_EQ(judged(61, std::hypot(5, 60), {true, true}, 60), word(Verdict::not_resolved, LostIn::mesh));
  EXPECT_EQ(judged(61, std::hypot(5, 60), {true, true}, 1, 60), word(Verdict::not_resolved, LostIn::inputs));
  EXPECT_EQ(judged(4, std::hypot(5, 60), {true, true}, 60), word(Verdict::agrees));
  // An uncertainty that would hide half of what is compared is no agreement.
  EXPECT_EQ(judged(0.01, 0.3, {}, not_known, not_known, 0.2), word(Verdict::not_resolved, LostIn::measurement));
  EXPECT_EQ(judged(0.01, 0.02, {}, not_known, not_known, 0.2), word(Verdict::agrees));
}

}  // namespace
}  // namespace pivnp::compare

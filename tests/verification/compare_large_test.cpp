// Criterion: 1,000 frames of 100,000 particles a side are compared within 2 GiB; by identity, and by material position while particles end. Peak memory is the process's own (Linux: VmHWM).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "compare/compare.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::compare {
namespace {

// Frames made when they are asked for: what a record on disk is to the comparison.
class Formula final : public MotionSource {
 public:
  Formula(std::string name, int nx, int ny, double spacing, std::size_t frames, double factor, bool ending)
      : name_(std::move(name)), factor_(factor), ending_(ending) {
    set_.label_names = {"soil"};
    for (int p = 0; p < nx * ny; ++p) {
      set_.id.push_back(p);
      set_.label.push_back(0);
      set_.x0.push_back(spacing * Vec2(p % nx + 0.5, p / nx + 0.5));
      set_.area.push_back(float(spacing * spacing));
      set_.born.push_back(0);
      set_.end.push_back(std::numeric_limits<double>::quiet_NaN());
      set_.end_reason.push_back(EndReason::none);
    }
    for (std::size_t k = 0; k < frames; ++k) times_.push_back(0.01 * double(k));
  }
  const std::string& name() const override { return name_; }
  const std::string& length_unit() const override { return metre_; }
  const std::string& time_unit() const override { return second_; }
  const ParticleSet& particles() const override { return set_; }
  const std::vector<double>& times() const override { return times_; }
  MotionFrame frame(std::size_t k) const override {
    MotionFrame f;
    f.time = times_[k];
    const double t = f.time;
    for (std::size_t p = 0; p < set_.size(); ++p) {
      const Vec2& X = set_.x0[p];
      f.u.push_back({float(factor_ * 0.02 * t * X.y()), float(-0.005 * t * X.x())});
      f.F.push_back({1, float(factor_ * 0.02 * t), float(-0.005 * t), 1});
      // Every tenth frame one more column of the right edge is lost.
      const bool lost = ending_ && X.x() > 1.0 - 0.0003 * double(k / 10);
      f.status.push_back(lost ? ParticleStatus::ended : ParticleStatus::active);
      f.cov_u.push_back({float(1e-8 * t), float(1e-8 * t), 0});
    }
    return f;
  }

 private:
  std::string name_, metre_ = "m", second_ = "s";
  double factor_;
  bool ending_;
  ParticleSet set_;
  std::vector<double> times_;
};

double peak_mebibytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "VmHWM:") {
      double kib = 0;
      status >> kib;
      return kib / 1024;
    }
  return std::numeric_limits<double>::quiet_NaN();
}

void compare_within(const Formula& a, const Formula& b, const std::string& how) {
  SilentProgress progress;
  const Comparison c = compare(a, b, {}, {}, progress);
  EXPECT_EQ(c.times().size(), 1000U);
  EXPECT_LT(c.fields[0].time.size(), 100U);  // of each field at most 2^23 values
  EXPECT_EQ(c.fields[0].time.front(), c.times().front());
  EXPECT_EQ(c.fields[0].time.back(), c.times().back());
  EXPECT_EQ(c.fields[0].values.size(), c.fields[0].time.size() * c.fields[0].id.size());
  const double peak = peak_mebibytes();
  EXPECT_LT(peak, 2048);
  test::verification_row("1,000 frames of 100,000 particles, " + how, "2 GiB",
                         number(peak, 3) + " MiB");
}

TEST(Large, ByIdentity) {
  compare_within(Formula("np", 400, 250, 0.0025, 1000, 1, false), Formula("mpm", 400, 250, 0.0025, 1000, 1.1, false),
                 "by identity");
}

TEST(Large, ByMaterialPositionWithLosses) {
  compare_within(Formula("np", 400, 250, 0.0025, 1000, 1, false),
                 Formula("mpm", 380, 263, 0.00263, 1000, 1.1, true), "by material position, particles ending");
}

}  // namespace
}  // namespace pivnp::compare

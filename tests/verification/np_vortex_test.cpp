// A vortex that winds up and unwinds (ReversingVortex: closed form for places, F and the vectors of both anchors).
//   published: none for PIV-NP; the reversing vortex is the usual test of particle transport (LeVeque 1996; deal.II
//     step-68), bilinear interpolation is of second order.
//   criteria: halving the spacing, alone and with the time step, lowers the rms error of the places at least by 2^1.9,
//     wound up (against the closed form, both anchors) and returned (forward anchor); that of F at least by 4 in two
//     halvings (a bilinear gradient is of first order off the element's centre). Central vectors are symmetric in time:
//     unwinding undoes every step, and particles return to 1e-10 whatever the spacing.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/verification/np_testing.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

// Wound up, the circle at r = q radius is sheared by gamma = 2 q^2 exp(-q^2) turn: 0.88 at q = 1.
const ReversingVortex vortex({0.5, 0.5}, 0.25, 1.2, 2);

struct Errors {
  double place = 0, F = 0;  // rms over the particles
};

Grid grid_of(int elements) { return {{0, 0}, {1.0 / elements, 1.0 / elements}, elements + 1, elements + 1}; }

// The same particles whatever the grid, off its lines.
ParticleSet cloud() {
  const Grid coarse{{0.1, 0.1}, {0.0321, 0.0319}, 26, 26};
  return block(coarse, {0.1, 0.1}, {0.9, 0.89}, 1);
}

Errors errors(const Tracker& tracker, double t) {
  Errors sum;
  const std::size_t count = tracker.state().size();
  for (std::size_t p = 0; p < count; ++p) {
    const auto now = tracker.state()[p];
    EXPECT_EQ(now.status, ParticleStatus::active);
    const Vec2& X = tracker.particles().x0[p];
    sum.place += (now.x - vortex.position(X, t)).squaredNorm() / double(count);
    sum.F += (now.F - vortex.deformation(X, t)).squaredNorm() / double(count);
  }
  return {std::sqrt(sum.place), std::sqrt(sum.F)};
}

struct Result {
  Errors wound, returned;
};

Result run(int elements, int steps, Anchor anchor, GradientPlace gradient) {
  NpOptions options = bilinear();
  options.gradient = gradient;
  Tracker tracker(options, cloud(), 0);
  Result result;
  track(tracker, vortex, grid_of(elements), anchor, 0, 1, steps);
  result.wound = errors(tracker, 1);
  track(tracker, vortex, grid_of(elements), anchor, 1, 2, steps);
  result.returned = errors(tracker, 2);
  return result;
}

double order(double coarse, double fine) { return std::log2(coarse / fine); }

class Vortex : public ::testing::TestWithParam<Anchor> {};

TEST_P(Vortex, SecondOrderInSpaceAndTogetherWithTime) {
  const bool central = GetParam() == Anchor::central;
  for (const bool refine_time : {false, true}) {
    std::vector<Result> results;
    for (const int elements : {40, 80, 160})
      results.push_back(run(elements, refine_time ? elements / 4 : 16, GetParam(), GradientPlace::particle));
    for (std::size_t n = 0; n + 1 < results.size(); ++n) {
      const Result &coarse = results[n], &fine = results[n + 1];
      const double wound = order(coarse.wound.place, fine.wound.place), F = order(coarse.wound.F, fine.wound.F);
      std::printf("%s anchor, %s: places %.3g -> %.3g (order %.2f), F %.3g -> %.3g (order %.2f)\n",
                  central ? "central" : "forward", refine_time ? "h and dt halved" : "h halved", coarse.wound.place,
                  fine.wound.place, wound, coarse.wound.F, fine.wound.F, F);
      EXPECT_GE(wound, 1.9);
      pivnp::test::verification_row("reversing vortex, wound up", "order in place at least 1.9", number(wound, 3));
      if (central) {
        EXPECT_LT(coarse.returned.place, 1e-10);
        EXPECT_LT(coarse.returned.F, 1e-10);
      } else {
        const double back = order(coarse.returned.place, fine.returned.place);
        std::printf("  returned: places %.3g -> %.3g (order %.2f)\n", coarse.returned.place, fine.returned.place, back);
        EXPECT_GE(back, 1.9);
      }
    }
    // Where in its element a particle passes changes with the grid: the order of F is taken over both halvings.
    EXPECT_GE(order(results.front().wound.F, results.back().wound.F) / 2, 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Anchors, Vortex, ::testing::Values(Anchor::forward, Anchor::central),
                         [](const auto& chosen) { return chosen.param == Anchor::central ? "central" : "forward"; });

TEST(VortexGradient, AtTheParticleOrAtTheCentre) {
  // The reason for the default: without noise the gradient at the particle is the better one.
  for (const int elements : {16, 32, 64}) {
    const Result at = run(elements, 16, Anchor::central, GradientPlace::particle);
    const Result centre = run(elements, 16, Anchor::central, GradientPlace::element);
    std::printf("%d elements: F at the particle %.3g, at the centre %.3g\n", elements, at.wound.F, centre.wound.F);
    EXPECT_LT(at.wound.F, centre.wound.F);
    EXPECT_EQ(at.wound.place, centre.wound.place);  // the gradient does not move particles
  }
}

}  // namespace
}  // namespace pivnp::np

// Short form of the table in docs/verdicts.md: frames drawn from a simulation's own material points, measured, and compared
// with that simulation and with others.
// Criterion: of the same soil no displacement, no shape is told apart (of all metrics at most one in ten, by chance); other
// friction or cohesion is found.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/bench/verdict/twins.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::twins {
namespace {

TEST(VerdictTwins, TheSameSoilIsNotToldApartAndAnotherIs) {
  const test::Scratch folder;
  SilentProgress progress;
  Bench bench(folder.path, progress);
  int said_of = 0, alarms = 0, found = 0, others = 0;
  std::string which;
  for (const Scene& scene : scenes()) {
    const Look how = look(0);
    SCOPED_TRACE(scene.name + ", " + how.text());
    const std::filesystem::path measured = bench.measured(scene, how);
    const Comparison same = bench.against(scene, measured, scene.soil);
    EXPECT_EQ(said_of_displacement(same), Said::lost);
    for (const Metric& m : same.metrics) {
      const Said what = said(m);
      if (what == Said::nothing) continue;
      ++said_of;
      if (what == Said::found) ++alarms, which += " " + scene.name + ":" + m.name;
    }
    for (const char* shape : {"run_out_x_difference", "slope_angle_difference", "outline_hausdorff_95"})
      if (const Metric* m = find(same.metrics, shape)) {
        EXPECT_NE(said(*m), Said::found) << shape;
      }
    for (const Change& change : scene.changes) {
      ++others;
      found += said_of_displacement(bench.against(scene, measured, change.soil)) == Said::found;
    }
  }
  EXPECT_LE(alarms, said_of / 10) << which;
  EXPECT_GE(found, 0.7 * others);
  test::verification_row("twin experiments, same soil", "told apart by at most one metric in ten",
                         std::to_string(alarms) + " of " + std::to_string(said_of));
  test::verification_row("twin experiments, other friction, cohesion, base friction", "found", std::to_string(found) + " of " + std::to_string(others));
}

// Coarser grids change no verdict that was right.
TEST(VerdictTwins, CoarserGridsChangeNoVerdictThatWasRight) {
  const test::Scratch folder;
  SilentProgress progress;
  Bench bench(folder.path, progress);
  const Scene& column = scenes()[0];
  const std::filesystem::path measured = bench.measured(column, look(0));
  const Soil& cohesive = column.changes.back().soil;
  for (const int grids : {1, 2}) {
    EXPECT_EQ(said_of_displacement(bench.against(column, measured, column.soil, grids)), Said::lost) << grids;
    EXPECT_EQ(said_of_displacement(bench.against(column, measured, cohesive, grids)), Said::found) << grids;
  }
}

}  // namespace
}  // namespace pivnp::twins

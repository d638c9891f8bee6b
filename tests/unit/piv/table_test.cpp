// The default method on every row of the table, at the size the limits are stated for (1024 px, nodes 8 px apart), on a
// seed that nothing was tuned on. `piv_table` prints the same rows for any method, texture and seeds.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/piv_results.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

constexpr int side = 1024, seed = 4711;

void measure_row(const Row& row, std::vector<RowResult>& all) {
  image::TextureOptions texture = row.texture({});
  texture.seed = seed;
  const Scene scene = make_scene(row.motion, side, side, texture);
  const NodeLattice nodes = even_nodes(side, side, 8, 48);
  result_of(all, row).add({.e = errors(scene, nodes, measure(scene, nodes, {}, 2), row.scored)});
}

// The figures of a row that something is asked of.
std::string text(const RowLimits& asked, const RowLimits& figures) {
  char part[48];
  std::snprintf(part, sizeof part, "rms %.4f px, valid %.1f %%", figures.rms, 100 * figures.valid);
  std::string all = part;
  if (asked.bias > 0) std::snprintf(part, sizeof part, ", bias %.4f px", figures.bias), all += part;
  if (asked.gain > 0) std::snprintf(part, sizeof part, ", gain %.3f", figures.gain), all += part;
  return all;
}

// Criterion: every limit met, but for at most three rows that miss by at most a quarter.
TEST(PivTable, DefaultMeetsTheLimits) {
  std::vector<RowResult> all;
  for (const Row& row : piv_rows(side)) measure_row(row, all);
  int missed = 0;
  for (RowResult& j : all) {
    resolve(j, all, 1);
    const std::string asked = text(j.limits, {j.limits.rms, j.limits.valid, j.limits.bias, j.limits.gain}),
                      reached = text(j.limits, {j.rms, j.valid, j.bias, j.gain});
    test::verification_row("PIV, " + j.name, asked, reached);
    EXPECT_GT(excess(j, 1), 0) << j.name << ": nothing is asked";
    EXPECT_LE(excess(j, 1), 1.25) << j.name << ": asked " << asked << ", reached " << reached;
    missed += excess(j, 1) > 1;
  }
  EXPECT_LE(missed, 3);
  // Asked: 60 to 76 % within one, 90 to 98 % within two. Held here: that errors are not understated.
  for (const Coverage& c : coverage(all)) {
    char reached[64];
    const bool outside = c.one < 0.60 || c.one > 0.76 || c.two < 0.90 || c.two > 0.98;
    std::snprintf(reached, sizeof reached, "%.0f %% and %.0f %%%s", 100 * c.one, 100 * c.two, outside ? ", missed" : "");
    test::verification_row(
        "PIV, errors within one and two stated standard deviations, " + std::string(c.kind) + " images",
        "60 to 76 % and 90 to 98 %", reached);
    EXPECT_GE(c.one, 0.60) << c.kind;
    EXPECT_GE(c.two, 0.90) << c.kind;
  }
}

}  // namespace
}  // namespace pivnp::piv

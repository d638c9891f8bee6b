// Numerical choices that are added from outside arrive in the options, the case, its reference and a run, which steps by
// the kernel that they name.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "apps/study/study.hpp"
#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/added.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

using mpm::Locking;
using mpm::ShapeKind;
using mpm::TransferKind;

std::string case_of(const std::string& scheme) {
  return R"(
[grid]
spacing_m = 0.05
area_m = [[0.0, 0.0], [0.4, 0.4]]
[region.block]
polygon_m = [[0.1, 0.0], [0.3, 0.0], [0.3, 0.2], [0.1, 0.2]]
[material.block]
model = "linear_elastic"
density_kg_m3 = 1000.0
young_pa = 1e5
[boundary.base]
line_m = [[0.0, 0.0], [0.4, 0.0]]
[mpm]
end_s = 0.01
output_rate_hz = 100.0
initial_equilibrium = false
)" + scheme;
}

std::string refusal(const std::string& scheme, const std::filesystem::path& out) {
  SilentProgress silent;
  RunSettings settings;
  settings.out = out;
  settings.threads = 1;
  try {
    run_case(parse_case(case_of(scheme), "case.toml", "."), settings, Stages::simulate, silent);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

MotionFrame last_frame(const std::string& scheme) {
  const test::Scratch there;
  EXPECT_EQ(refusal(scheme, there.path / "out"), "");
  const io::RecordReader record(there.path / "out" / "record.h5");
  return record.motion("mpm")->frame(1);
}

template <class E>
bool chosen_from(const char* name) {
  const std::vector<std::string> names = choice_names<E>();
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(OwnScheme, AnAddedChoiceArrivesAndRunsItsKernel) {
  const test::Scratch there;
  const std::string own = "shape = \"spline_of_test\"\ntransfer = \"flip_of_test\"\nlocking = \"none_of_test\"\n";
  EXPECT_NE(refusal(own, there.path / "out").find("case.toml:17: mpm.shape"), std::string::npos);
  const test::Added shape(mpm::shapes(), {{{"spline_of_test", ShapeKind(77)}, "a test's", ShapeKind::bspline}, 3});
  const test::Added transfer(mpm::transfers(), {{{"flip_of_test", TransferKind(77)}, "a test's", TransferKind::flip}, false, false});
  const test::Added locking(mpm::lockings(), {{{"none_of_test", Locking(77)}, "a test's", Locking::none}});
  EXPECT_TRUE(chosen_from<ShapeKind>("spline_of_test"));
  EXPECT_TRUE(chosen_from<TransferKind>("flip_of_test"));
  EXPECT_TRUE(chosen_from<Locking>("none_of_test"));
  for (const char* name : {"spline_of_test", "flip_of_test", "none_of_test"})
    EXPECT_NE(case_reference().find(name), std::string::npos) << name;
  const Case c = parse_case(case_of(own), "case.toml", ".");
  EXPECT_EQ(parse_case(write_case(c), "again.toml", ".").mpm->transfer, TransferKind(77));

  const MotionFrame added = last_frame(own),
                    listed = last_frame("shape = \"bspline\"\ntransfer = \"flip\"\nlocking = \"none\"\n"),
                    other = last_frame("shape = \"bspline\"\ntransfer = \"apic\"\nlocking = \"none\"\n");
  EXPECT_EQ(added.u, listed.u);
  EXPECT_EQ(added.v, listed.v);
  EXPECT_NE(added.v, other.v);
  // Its own properties hold, not those of the row whose kernel it runs.
  EXPECT_NE(refusal(own + "pic_per_s = 1.0\n", there.path / "out").find("mpm.pic_per_s"), std::string::npos);
  EXPECT_EQ(refusal("transfer = \"flip\"\npic_per_s = 1.0\n", there.path / "out"), "");
}

}  // namespace
}  // namespace pivnp::app

// A hundred thousand particles and frames of twelve megapixels: a page that can be sent.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>

#include "apps/report/write.hpp"
#include "tests/unit/report/synthetic.hpp"

namespace pivnp::report {
namespace {

TEST(LargeReport, StaysSmall) {
  SyntheticOptions o;
  o.spacing_m = 0.0008;
  o.frames = 4;
  o.width_px = 4000;
  o.height_px = 3000;
  const Synthetic s = make_synthetic(o);
  ASSERT_GT(s.content.measured->particles().size(), 95'000u);
  const auto folder = std::filesystem::temp_directory_path() / ("pivnp_report_large_" + std::to_string(::getpid()));
  write_content({}, s.content, folder);
  EXPECT_LT(std::filesystem::file_size(folder / "report.html"), 10'000'000u);
  EXPECT_LT(std::filesystem::file_size(folder / "report.pdf"), 15'000'000u);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace pivnp::report

// Every reason for which particles end is told in remarks and in the report: those listed, one that a record of a later
// version holds, and one added to the list.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "apps/report/report.hpp"
#include "apps/study/pipeline/record/remarks.hpp"
#include "apps/study/study.hpp"
#include "pivnp/core/particles/end_reason.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/added.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A record of one motion with three particles for each reason.
fs::path record_of(const fs::path& folder, const std::vector<EndReason>& reasons) {
  ParticleSet set;
  MotionFrame frame;
  for (std::size_t p = 0; p < 3 * reasons.size(); ++p) {
    const EndReason reason = reasons[p / 3];
    set.id.push_back(std::int64_t(p));
    set.label.push_back(0);
    set.x0.emplace_back(0.1 * double(p % 3), 0.1 * double(p / 3));
    set.area.push_back(0.01);
    set.born.push_back(0);
    set.end.push_back(reason == EndReason::none ? std::numeric_limits<double>::quiet_NaN() : 0.0);
    set.end_reason.push_back(reason);
    frame.u.push_back({0, 0});
    frame.F.push_back({1, 0, 0, 1});
    frame.status.push_back(reason == EndReason::none ? ParticleStatus::active : ParticleStatus::ended);
  }
  set.label_names = {"sand"};
  io::RecordHead head;
  head.case_text = "name = \"ends\"\n";
  io::RecordWriter writer(folder, head, false);
  writer.begin_motion("mpm", set);
  writer.add_frame("mpm", frame);
  frame.time = 1;
  writer.add_frame("mpm", frame);
  writer.end_stage("motion/mpm", &set);
  writer.finish();
  return folder / "record.h5";
}

TEST(EndReasons, EveryOneIsTold) {
  const test::Added added(end_reasons(), {"of_a_test", EndReason(200), "were ended by a test"});
  std::vector<EndReason> reasons;
  for (const EndReasonRow& row : end_reasons()) reasons.push_back(row.value);
  reasons.push_back(EndReason(250));
  test::Scratch scratch;
  const io::RecordReader record(record_of(scratch.path, reasons));
  EXPECT_EQ(record.motion("mpm")->particles().end_reason.back(), EndReason(250));

  const std::vector<Remark> remarks = remarks_of(record);
  EXPECT_EQ(remarks.size(), reasons.size() - 1);  // all but `none`
  report::ReportInput input;
  input.name = "ends";
  input.record = &record;
  report::write_report({}, input, scratch.path);
  const std::string html = read(scratch.path / "report.html");
  for (const EndReason reason : reasons) {
    if (reason == EndReason::none) continue;
    const auto told = [&](const Remark& remark) { return holds(remark.text, words(reason)); };
    EXPECT_EQ(std::count_if(remarks.begin(), remarks.end(), told), 1) << words(reason);
    EXPECT_TRUE(holds(html, words(reason))) << words(reason);
  }
}

}  // namespace
}  // namespace pivnp::app

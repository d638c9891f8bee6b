// Reports of every kind of content: what must be in the files, and what must not.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <unistd.h>

#include "pivnp/core/error.hpp"
#include "tests/unit/report/synthetic.hpp"

namespace pivnp::report {
namespace {

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

// A folder that is removed afterwards; PIVNP_REPORT_OUT keeps the reports in there, to be looked at.
class Report : public testing::Test {
 protected:
  void SetUp() override {
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    const char* keep = std::getenv("PIVNP_REPORT_OUT");
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    kept_ = keep != nullptr;
    folder_ = kept_ ? std::filesystem::path(keep) / name
                    : std::filesystem::temp_directory_path() / ("pivnp_report_" + name + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override {
    if (!kept_) std::filesystem::remove_all(folder_);
  }
  void write(const Synthetic& s, const ReportOptions& options = {}) {
    write_content(options, s.content, folder_);
    html_ = read(folder_ / "report.html");
    pdf_ = read(folder_ / "report.pdf");
    EXPECT_EQ(pdf_.substr(0, 5), "%PDF-");
    EXPECT_TRUE(std::regex_search(pdf_, std::regex("/Type\\s*/Page\\b")));
    // Self-contained: whatever a browser would fetch is embedded.
    EXPECT_FALSE(std::regex_search(html_, std::regex("(src|href)=\"(?!data:|#)")));
    EXPECT_EQ(html_.find("url("), std::string::npos);
    EXPECT_EQ(html_.find("<script"), std::string::npos);
    EXPECT_EQ(html_.find("@import"), std::string::npos);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      EXPECT_EQ(entry.path().string().find(".tmp"), std::string::npos) << entry.path();
  }
  bool has_figure(const std::string& name) const {
    return std::filesystem::exists(folder_ / "figures" / (name + ".png")) &&
           std::filesystem::exists(folder_ / "figures" / (name + ".svg")) &&
           html_.find("<figure id=\"" + name + "\">") != std::string::npos;
  }
  std::filesystem::path folder_;
  std::string html_, pdf_;
  bool kept_ = false;
};

TEST_F(Report, Full) {
  write(make_synthetic({}));
  for (const char* name : {"vectors_1", "displacement", "deviatoric_strain", "histories", "difference", "outline", "energy", "quality"})
    EXPECT_TRUE(has_figure(name)) << name;
  for (const char* section : {"Comparison", "Measurement", "Simulation", "What was flagged", "How this was made", "Settings"})
    EXPECT_NE(html_.find(std::string(">") + section + "</h2>"), std::string::npos) << section;
  EXPECT_EQ(occurrences(html_, "data:image/png;base64,"), 8u);
  EXPECT_LT(html_.size(), 10'000'000u);
}

}  // namespace
}  // namespace pivnp::report

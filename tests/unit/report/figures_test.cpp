// The list of figures: a row that is added arrives in the HTML, in the PDF and in figures/, and nowhere by hand.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "apps/plot/canvas.hpp"
#include "apps/report/figures/figure.hpp"
#include "apps/report/write.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "tests/unit/report/synthetic.hpp"
#include "tests/support/added.hpp"

namespace pivnp::report {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class Figures : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("pivnp_figures_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  bool file(const std::string& name) const { return fs::exists(folder_ / "figures" / name); }

  fs::path folder_;
};

int times_drawn = 0;

std::vector<Figure> draw_dummy(const FigureInput&) {
  auto canvas = std::make_shared<plot::Canvas>(100, 30);
  canvas->paint_over([](plot::Painter&) { ++times_drawn; });
  return {{"A caption of its own.", canvas}};
}

TEST_F(Figures, ANewRowArrivesEverywhere) {
  const test::Added row(figures(), {.name = "dummy",
                                    .shows = "a figure that a test added",
                                    .section = Section::simulation,
                                    .applies = [](const FigureInput& i) { return !i.content.energy.empty(); },
                                    .draw = draw_dummy});
  SyntheticOptions o;
  o.measured = o.pairs = o.pictures = false;
  o.spacing_m = 0.02;
  o.frames = 3;
  Synthetic s = make_synthetic(o);
  times_drawn = 0;
  write_content({}, s.content, folder_);
  EXPECT_TRUE(file("dummy.png") && file("dummy.svg"));
  EXPECT_EQ(times_drawn, 3);  // as PNG, as SVG, and on a page of the PDF
  const std::string html = read(folder_ / "report.html");
  EXPECT_NE(html.find("<figure id=\"dummy\">"), std::string::npos);
  EXPECT_NE(html.find("A figure that a test added\""), std::string::npos);
  EXPECT_NE(html.find("A caption of its own."), std::string::npos);

  s.content.energy.clear();  // it no longer applies, and goes
  write_content({}, s.content, folder_);
  EXPECT_FALSE(file("dummy.png") || file("dummy.svg"));
  EXPECT_TRUE(file("displacement.png"));
}

TEST_F(Figures, EveryNameHasOneRow) {
  for (const FigureRow& row : figures()) {
    EXPECT_FALSE(row.shows.empty()) << row.name;
    if (row.owns == nullptr) {
      EXPECT_EQ(row_of(row.name), &row) << row.name;
    }
  }
  for (const DerivedField& field : derived_fields()) {
    const FigureRow* row = row_of(field.name);
    ASSERT_NE(row, nullptr) << field.name;
    EXPECT_EQ(row->name, "fields");
  }
  EXPECT_EQ(row_of("displacement")->name, "fields");
  EXPECT_EQ(row_of("vectors_12")->name, "vectors");
  for (const char* none : {"vectors_", "vectors_a", "mine", ""}) EXPECT_EQ(row_of(none), nullptr) << none;
}

// Two histories, then a report of a simulation in the same folder: what only the first had is gone.
TEST_F(Figures, ThoseOfAnotherComparisonGo) {
  Content histories;
  histories.comparison.emplace();
  histories.comparison->tables = {
      {"history_first", "front of history=one.csv", {{"time", "s", {0, 1, 2}}, {"value", "m", {0, 1, 3}}}},
      {"history_second", "front of history=two.csv", {{"time", "s", {0, 1, 2}}, {"value", "m", {0, 2, 3}}}},
      {"decomposition_displacement_x",
       "coefficients",
       {{"first", "m", {1, 2}}, {"second", "m", {1, 3}}, {"uncertainty", "m", {0.1, 0.1}}}}};
  write_content({}, histories, folder_);
  EXPECT_TRUE(file("curves.png") && file("decomposition.svg"));
  SyntheticOptions o;
  o.measured = o.pairs = o.pictures = false;
  o.spacing_m = 0.02;
  o.frames = 3;
  const Synthetic s = make_synthetic(o);
  write_content({}, s.content, folder_);
  for (const char* stale : {"curves.png", "curves.svg", "decomposition.png", "decomposition.svg"})
    EXPECT_FALSE(file(stale)) << stale;
  EXPECT_TRUE(file("energy.png"));
}

// What a figure draws, for those who draw it again.
TEST_F(Figures, TheirDataAreWritten) {
  SyntheticOptions o;
  o.frames = 4;
  o.spacing_m = 0.02;
  const Synthetic s = make_synthetic(o);
  const ReportOptions options;
  const FigureInput input = figure_input(options, s.content);
  std::size_t drawn = 0;
  for (const Section section : {Section::summary, Section::comparison, Section::measurement, Section::simulation})
    for (const Figure& figure : draw_section(section, input)) {
      SCOPED_TRACE(figure.name);
      const std::string text = csv(figure.data);
      EXPECT_GT(std::count(text.begin(), text.end(), '\n'), 2) << text.substr(0, 200);
      ++drawn;
      if (figure.name != "difference") continue;
      ASSERT_EQ(figure.data.size(), 4u);
      EXPECT_EQ(figure.data[1].values, input.differences.rms);
      EXPECT_TRUE(text.starts_with("time (s),RMS (m),median (m),standard uncertainty (m)\n0,0,0,"));
    }
  EXPECT_GE(drawn, 8u);
}

// Strains of points are drawn where the measurement states a covariance of F, and only there.
TEST_F(Figures, StrainHistoriesNeedACovarianceOfF) {
  SyntheticOptions o;
  o.frames = 5;
  o.spacing_m = 0.02;
  Synthetic s = make_synthetic(o);
  ReportOptions options;
  const auto drawn = [&] {
    const FigureInput input = figure_input(options, s.content);
    for (const Figure& figure : draw_section(Section::comparison, input))
      if (figure.name == "strain_histories") return figure.data.size();
    return std::size_t(0);
  };
  EXPECT_EQ(drawn(), 0u);
  auto motion = std::make_shared<MotionMemory>("np", "m", "s", s.content.measured->particles());
  for (std::size_t k = 0; k < s.content.measured->times().size(); ++k) {
    MotionFrame f = s.content.measured->frame(k);
    for (float& v : f.add("cov_F", f.F.size())) v = 1e-4f * float(k);
    motion->add(f);
  }
  s.content.measured = motion;
  EXPECT_GE(drawn(), 3u);
}

}  // namespace
}  // namespace pivnp::report

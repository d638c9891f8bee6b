// Reports of every kind of content: what must be in the files, and what must not.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <string>

#include <QImage>

#include "apps/report/write.hpp"
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
    // As on a server: nothing to show a window on, and a platform that cannot be reached.
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    ::setenv("QT_QPA_PLATFORM", "xcb", 1);
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
    EXPECT_NE(pdf_.rfind("%%EOF"), std::string::npos);
    pages_ = occurrences(pdf_, "/Type /Page\n");
    EXPECT_GE(pages_, 1u);
    // Self-contained: whatever a browser would fetch is embedded.
    for (const char* attribute : {"src=\"", "href=\""})
      for (std::size_t at = html_.find(attribute); at != std::string::npos; at = html_.find(attribute, at + 1)) {
        const std::string target = html_.substr(at + std::string(attribute).size(), 5);
        EXPECT_TRUE(target == "data:" || target[0] == '#') << target;
      }
    for (const char* foreign : {"url(", "<script src", "@import", "http:", "https:", "<link"})
      EXPECT_EQ(html_.find(foreign), std::string::npos) << foreign;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
  }
  bool has_figure(const std::string& name) const {
    return std::filesystem::exists(folder_ / "figures" / (name + ".png")) &&
           std::filesystem::exists(folder_ / "figures" / (name + ".svg")) &&
           std::filesystem::exists(folder_ / "figures" / (name + ".csv")) &&
           html_.find("<figure id=\"" + name + "\">") != std::string::npos;
  }
  std::size_t colours_of(const std::string& figure) const {
    const QImage image(QString::fromStdString((folder_ / "figures" / (figure + ".png")).string()));
    std::set<QRgb> found;
    for (int r = 0; r < image.height(); r += 2)
      for (int c = 0; c < image.width(); c += 2) found.insert(image.pixel(c, r));
    return found.size();
  }

  std::filesystem::path folder_;
  std::string html_, pdf_;
  std::size_t pages_ = 0;
  bool kept_ = false;
};

TEST_F(Report, Full) {
  const std::string locale = std::setlocale(LC_ALL, nullptr);
  write(make_synthetic({}));
  EXPECT_EQ(std::setlocale(LC_ALL, nullptr), locale);  // Qt would set the user's
  for (const char* name :
       {"verdict", "vectors_1", "displacement", "deviatoric_strain", "histories", "difference", "outline", "energy", "quality"}) {
    EXPECT_TRUE(has_figure(name)) << name;
    EXPECT_GT(colours_of(name), 20u) << name;  // black and white alone have 256 with their smoothing; blank has 1
    const QImage image(QString::fromStdString((folder_ / "figures" / (std::string(name) + ".png")).string()));
    const double width = 25.4 * image.width() / 300;
    EXPECT_TRUE(std::abs(width - 170) < 0.2 || std::abs(width - 82) < 0.2) << name << ": " << width << " mm";
    EXPECT_NE(read(folder_ / "figures" / (std::string(name) + ".svg")).find("<svg"), std::string::npos) << name;
  }
  EXPECT_GT(colours_of("displacement"), 300u);  // a whole colour map
  for (const char* section :
       {"Comparison", "Measurement", "Simulation", "What was flagged", "How this was made", "Settings"})
    EXPECT_NE(html_.find(std::string(">") + section + "</h2>"), std::string::npos) << section;
  EXPECT_EQ(occurrences(html_, "data:image/png;base64,"), 11u);
  EXPECT_LT(html_.size(), 10'000'000u);
  EXPECT_GE(pages_, 4u);
  EXPECT_LE(pages_, 7u);
  EXPECT_NE(html_.find("<dt>displacement</dt>"), std::string::npos);
  EXPECT_NE(html_.find(name_of(LimitFate::exceeded)), std::string::npos);
  EXPECT_NE(html_.find("The node column nearest to the gate"), std::string::npos);
  EXPECT_NE(html_.find(words(EndReason::left_image)), std::string::npos);
  EXPECT_NE(html_.find("mohr_coulomb"), std::string::npos);
  EXPECT_NE(html_.find("pivnp run datasets/gate_slope"), std::string::npos);
}

// Page one shows the motion where nothing is compared, and says plainly where most particles were lost; those that left the view
// were not.
TEST_F(Report, PageOneOfAMeasurement) {
  SyntheticOptions o;
  o.simulated = o.comparison = o.energy = false;
  o.spacing_m = 0.02;
  o.frames = 4;
  Synthetic s = make_synthetic(o);
  const auto page_one = [&] { return html_.substr(0, html_.find(">What was flagged</h2>")); };
  const auto ending = [&](EndReason reason, double share) {
    ParticleSet set = s.content.measured->particles();
    const std::size_t lost = std::size_t(share * double(set.size()));
    for (std::size_t p = 0; p < lost; ++p) set.end_reason[p] = reason, set.end[p] = s.content.measured->times()[1];
    auto motion = std::make_shared<MotionMemory>("np", "m", "s", set);
    for (std::size_t k = 0; k < s.content.measured->times().size(); ++k) {
      MotionFrame f = s.content.measured->frame(k);
      for (std::size_t p = 0; k > 1 && p < lost; ++p) f.status[p] = ParticleStatus::ended;
      motion->add(f);
    }
    return motion;
  };
  const auto whole = s.content.measured;
  write(s);
  EXPECT_EQ(occurrences(page_one(), "<img"), 1u);
  EXPECT_TRUE(has_figure("motion"));
  EXPECT_NE(page_one().find("Displacement at "), std::string::npos);
  EXPECT_EQ(page_one().find("not usable"), std::string::npos);
  const auto lost = ending(EndReason::no_vectors, 0.7), left = ending(EndReason::left_image, 0.7);
  s.content.measured = lost;
  write(s);
  EXPECT_NE(page_one().find("This measurement is not usable as it is: only "), std::string::npos);
  EXPECT_NE(page_one().find("% of the particles were followed to the end"), std::string::npos);
  s.content.measured = left;
  write(s);
  EXPECT_EQ(page_one().find("not usable"), std::string::npos);
}

TEST_F(Report, MeasurementOnly) {
  SyntheticOptions o;
  o.simulated = o.energy = false;
  o.spacing_m = 0.01;
  write(make_synthetic(o));
  EXPECT_TRUE(has_figure("displacement") && has_figure("histories") && has_figure("quality") &&
              has_figure("vectors_1"));
  EXPECT_FALSE(has_figure("difference") || has_figure("energy") || has_figure("outline"));
  EXPECT_NE(html_.find("No simulation was compared"), std::string::npos);
}

TEST_F(Report, SimulationOnly) {
  SyntheticOptions o;
  o.measured = o.pairs = o.pictures = false;
  o.spacing_m = 0.01;
  o.reactions = true;
  write(make_synthetic(o));
  EXPECT_TRUE(has_figure("displacement") && has_figure("energy") && has_figure("reactions"));
  EXPECT_GT(colours_of("reactions"), 20u);
  EXPECT_NE(read(folder_ / "figures" / "reactions.csv").find("body.plate displacement x (m)"), std::string::npos);
  EXPECT_FALSE(has_figure("quality") || has_figure("vectors_1"));
  EXPECT_EQ(html_.find(">Measurement</h2>"), std::string::npos);
  EXPECT_NE(html_.find("Nothing was flagged"), std::string::npos);
}

TEST_F(Report, BothSidesNotCompared) {
  SyntheticOptions o;
  o.pictures = false;
  o.comparison = false;
  o.spacing_m = 0.01;
  write(make_synthetic(o));
  EXPECT_TRUE(has_figure("displacement"));
  EXPECT_NE(html_.find("The two were not compared"), std::string::npos);
}

TEST_F(Report, OnePair) {
  SyntheticOptions o;
  o.frames = 2;
  o.spacing_m = 0.01;
  write(make_synthetic(o));
  EXPECT_TRUE(has_figure("displacement") && has_figure("quality") && has_figure("difference"));
}

TEST_F(Report, VectorsAlone) {
  SyntheticOptions o;
  o.measured = o.simulated = false;
  o.frames = 3;
  write(make_synthetic(o));
  EXPECT_TRUE(has_figure("quality") && has_figure("vectors_1"));
  EXPECT_FALSE(has_figure("displacement"));
}

TEST_F(Report, Nothing) {
  write(Synthetic{});
  EXPECT_NE(html_.find("neither vectors nor a motion"), std::string::npos);
}

TEST_F(Report, NothingMoves) {
  SyntheticOptions o;
  o.amplitude = 0;
  o.frames = 4;
  o.spacing_m = 0.01;
  Synthetic s = make_synthetic(o);
  s.content.measured.reset();
  s.content.comparison.reset();  // the simulation alone is exactly still
  write(s);
  EXPECT_TRUE(has_figure("displacement") && has_figure("deviatoric_strain"));
}

// Two simulations, and two measurements, are called first and second; a measurement beside a simulation keeps its name.
TEST_F(Report, LikeWithLike) {
  const auto says = [&](const char* text) { return html_.find(text) != std::string::npos; };
  SyntheticOptions o;
  o.frames = 3;
  o.spacing_m = 0.02;
  o.pairs = false;
  Synthetic s = make_synthetic(o);
  write(s);
  EXPECT_TRUE(says("simulated minus measured") && says("Measurement and simulation compared"));
  EXPECT_FALSE(says("Second minus first"));
  const auto np = s.content.measured, mpm = s.content.simulated;
  for (const auto& motion : {mpm, np}) {
    s.content.measured = s.content.simulated = motion;
    write(s);
    EXPECT_TRUE(says("Second minus first. Counts from") && says("Two motions compared")) << motion->name();
    EXPECT_FALSE(says("Simulated") || says("simulated minus") || says("of the measured")) << motion->name();
  }
}

// Everything that a bad run can hold: NaN in every field, all particles ended, all vectors masked or failed.
TEST_F(Report, NotANumber) {
  SyntheticOptions o;
  o.frames = 3;
  o.spacing_m = 0.02;
  Synthetic s = make_synthetic(o);
  static constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  auto broken = std::make_shared<MotionMemory>("np", "m", "s", s.content.measured->particles());
  for (std::size_t k = 0; k < 3; ++k) {
    MotionFrame f = s.content.measured->frame(k);
    if (k > 0)
      for (std::size_t p = 0; p < f.u.size(); ++p) {
        f.u[p] = {nan, nan};
        f.F[p] = {nan, 0, 0, nan};
        f.cov_u[p] = {nan, nan, nan};
        if (k == 2) f.status[p] = ParticleStatus::ended;
      }
    broken->add(f);
  }
  s.content.measured = broken;
  for (ComparisonField& f : s.content.comparison->fields) f.values.assign(f.values.size(), nan);
  for (Metric& m : s.content.comparison->metrics) m.value = m.uncertainty = std::numeric_limits<double>::quiet_NaN();
  for (EnergyRow& e : s.content.energy) e.residual = e.kinetic = std::numeric_limits<double>::quiet_NaN();
  const auto pair = s.content.pair;
  s.content.pair = [pair](std::size_t k) {
    VectorField f = pair(k);
    f.status.assign(f.status.size(), k == 0 ? VectorStatus::masked : VectorStatus::failed);
    f.displacement.assign(f.displacement.size(), {nan, nan});
    f.score.assign(f.score.size(), nan);
    return f;
  };
  write(s);
  EXPECT_TRUE(has_figure("displacement"));
  // Base64 may spell anything.
  std::string text;
  for (std::size_t from = 0; from < html_.size();) {
    const std::size_t picture = std::min(html_.find("data:image/png", from), html_.size());
    text += html_.substr(from, picture - from);
    from = picture == html_.size() ? picture : html_.find('"', picture);
  }
  for (const char* id : {"player-values", "player-data"}) {
    const std::size_t at = text.find(std::string("id=\"") + id), end = text.find("</script>", at);
    ASSERT_NE(at, std::string::npos);
    const std::string data = text.substr(at, end - at);
    if (std::string(id) == "player-data") {
      EXPECT_EQ(data.find("nan"), std::string::npos);
    }
    text.erase(at, end - at);
  }
  EXPECT_LT(text.size(), 100'000u);
  EXPECT_EQ(text.find("nan"), std::string::npos);
}

TEST_F(Report, NamesAreText) {
  SyntheticOptions o;
  o.pictures = false;
  o.spacing_m = 0.02;
  o.frames = 4;
  Synthetic s = make_synthetic(o);
  s.content.name = "<b>sand & clay</b> \"1 g\" \xff";
  s.content.frames[0].name = "a<script>.png";
  s.content.command = "pivnp run 'x & <y>'";
  s.content.remarks = {{"frame a<b&c>d", RemarkWeight::doubt}, {"", RemarkWeight::doubt}, {"all <well>"}, {"none & nothing", RemarkWeight::unusable}};
  ReportOptions options;
  write(s, options);
  EXPECT_NE(html_.find("&lt;b&gt;sand &amp; clay&lt;/b&gt; &quot;1 g&quot; \ufffd"), std::string::npos);
  EXPECT_NE(html_.find("frame a&lt;b&amp;c&gt;d"), std::string::npos);
  const auto at = [&](const char* text) { return html_.find(text); };  // what is not usable leads, notes are no flags
  const auto head = [&](const char* text) { return html_.rfind(text); };  // (the list of sections stands before them)
  EXPECT_LT(at("none &amp; nothing"), head(">What was flagged<"));
  EXPECT_LT(head(">What was flagged<"), at("frame a&lt;b&amp;c&gt;d"));
  EXPECT_LT(head(">How this was made<"), at("all &lt;well&gt;"));
  EXPECT_EQ(occurrences(html_, "all &lt;well&gt;"), 1u);
  EXPECT_NE(html_.find("pivnp run &#39;x &amp; &lt;y&gt;&#39;"), std::string::npos);
}

TEST_F(Report, OptionsAreFollowed) {
  SyntheticOptions o;
  o.pictures = false;
  o.spacing_m = 0.02;
  Synthetic s = make_synthetic(o);
  ReportOptions options;
  options.title = "A title of its own";
  options.times_s = {0.1, 0.2, 0.3, 0.4, 9.0};  // the last is beyond the record
  options.points_m = {{0.1, 0.2}, {5.0, 5.0}};  // the second is far from all material
  options.fields_drawn = {"velocity_x"};
  write(s, options);
  EXPECT_NE(html_.find("<h1>A title of its own</h1>"), std::string::npos);
  EXPECT_TRUE(has_figure("velocity_x") && has_figure("histories"));
  EXPECT_FALSE(has_figure("displacement"));
  options.fields_drawn = {"strain_deviatoric"};
  EXPECT_THROW(write_content(options, s.content, folder_), InputError);
}

// What only the owner of the camera knows is in the table as given; lines are figures of their own, and go again.
TEST_F(Report, HardwareLinesAndGauge) {
  SyntheticOptions o;
  o.spacing_m = 0.01;
  Synthetic s = make_synthetic(o);
  s.content.hardware = {{"Camera", "an old <film> camera"}};
  s.content.setup = {{"Interpolant of the images", "quintic B-spline"}};
  s.content.simulated_setup = {{"Material sand", "mohr coulomb; friction 37.5 deg"}};
  s.content.gauge = 0.03;
  ReportOptions options;
  options.lines = {{"crest", {LineType::extensometer, Pair{0.05, 0.2}, Pair{0.15, 0.2}, "displacement_magnitude"}},
                   {"toe", {LineType::section, Pair{0.0, 0.05}, Pair{0.3, 0.05}, "strain_dev"}},
                   {"nowhere", {LineType::section, Pair{7.0, 7.0}, Pair{8.0, 8.0}, "strain_dev"}}};
  write(s, options);
  EXPECT_TRUE(has_figure("line_crest") && has_figure("line_toe") && has_figure("uncertainty") && has_figure("geometry"));
  EXPECT_FALSE(has_figure("line_nowhere"));
  for (const char* text : {"an old &lt;film&gt; camera", "mohr coulomb; friction 37.5 deg", "quintic B-spline", "0.500 mm a pixel", "0.080 px = 40 \u00b5m", "Strains over circles of 30.0 mm"})
    EXPECT_NE(html_.find(text), std::string::npos) << text;
  write(s);
  EXPECT_FALSE(has_figure("line_crest"));
}

TEST_F(Report, FiguresOfAnEarlierReportGo) {
  SyntheticOptions o;
  o.pictures = false;
  o.spacing_m = 0.02;
  o.frames = 4;
  write(make_synthetic(o));
  EXPECT_TRUE(has_figure("energy"));
  std::ofstream(folder_ / "figures" / "mine.png") << "kept";
  o.simulated = false;
  write(make_synthetic(o));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "figures" / "energy.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "figures" / "displacement.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "figures" / "mine.png"));
}

TEST_F(Report, CannotBeWritten) {
  Synthetic s;
  EXPECT_THROW(write_content({}, s.content, "/dev/null/report"), RunError);
  write(s);
  const std::string before = html_;
  // A file that grows too large fails as a full disk does: what was there stays.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  rlimit low = old;
  low.rlim_cur = 1000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &low), 0);
  std::string message;
  try {
    write_content({}, s.content, folder_);
  } catch (const RunError& e) {
    message = e.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_NE(message.find("cannot write " + (folder_ / "report.").string()), std::string::npos) << message;
  EXPECT_EQ(read(folder_ / "report.html"), before);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
    EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
}

}  // namespace
}  // namespace pivnp::report

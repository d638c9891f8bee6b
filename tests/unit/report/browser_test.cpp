// The report as its readers open it: tidy and a headless Chromium read the HTML, pdftotext the PDF. Each test is skipped,
// saying so, where its program is not installed (Debian: tidy, chromium, poppler-utils).
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "apps/plot/numbers.hpp"
#include "apps/report/document/tables.hpp"
#include "apps/report/write.hpp"
#include "tests/unit/report/synthetic.hpp"

namespace pivnp::report {
namespace {

namespace fs = std::filesystem;

bool installed(const std::string& program) { return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0; }

std::string output_of(const std::string& command, int& code) {
  std::string text;
  FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  char buffer[65536];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  code = ::pclose(pipe);
  return text;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class Browser : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("pivnp_browser_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    SyntheticOptions o;
    o.spacing_m = 0.008;
    made_ = new Synthetic(make_synthetic(o));
    write_content({}, made_->content, folder_);
  }
  static void TearDownTestSuite() {
    delete made_;
    fs::remove_all(folder_);
  }
  // What `script` returns, run in the page once it is there; errors of the page's own script come before it.
  std::string in_page(const std::string& script, const std::string& flags = "") {
    std::string html = read(folder_ / "report.html");
    html.insert(html.find("<style>"), "<script>window.problems='';window.addEventListener('error',function(e){problems+=e.message+' ';});</script>");
    html.insert(html.rfind("</body>"), "<pre id=\"probe\">none</pre><script>document.getElementById('probe').textContent='['+problems+(function(){" +
                                            script + "})()+']';</script>");
    const fs::path file = folder_ / "probed.html";
    std::ofstream(file, std::ios::binary) << html;
    int code = 0;
    const std::string dom = output_of("timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir=" + (folder_ / "profile").string() +
                                          " --window-size=1000,800 " + flags + " --dump-dom file://" + file.string(), code);
    const std::size_t at = dom.find("<pre id=\"probe\">["), from = at + 16, end = dom.find("]</pre>", at);
    return at == std::string::npos ? "no answer" : dom.substr(from + 1, end - from - 1);
  }
  static double number_after(const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    return at == std::string::npos ? std::nan("") : std::atof(text.c_str() + at + words.size());
  }

  static fs::path folder_;
  static Synthetic* made_;
};
fs::path Browser::folder_;
Synthetic* Browser::made_ = nullptr;

TEST_F(Browser, TidyHasNothingToSay) {
  if (!installed("tidy")) GTEST_SKIP() << "tidy is not installed";
  int code = 0;
  const std::string said = output_of("tidy -e -q " + (folder_ / "report.html").string() + " 2>&1", code);
  EXPECT_EQ(code, 0) << said;
}

// The slider moves, and what is read under the pointer is the record's number.
TEST_F(Browser, TheSliderShowsTheRecordsNumbers) {
  if (!installed("chromium")) GTEST_SKIP() << "chromium is not installed";
  const MotionSource& motion = *made_->content.measured;
  const std::size_t particle = 321;
  const std::string said = in_page(R"JS(
    var meta = JSON.parse(document.getElementById("player-data").textContent), s = document.querySelector("#player input");
    var before = document.querySelector("#player output").textContent, c = document.querySelector("#player canvas"), r = c.getBoundingClientRect();
    s.value = 9; s.dispatchEvent(new Event("input"));
    var x = )JS" + std::to_string(motion.particles().x0[particle].x()) + ", y = " + std::to_string(motion.particles().x0[particle].y()) + R"JS(;
    c.dispatchEvent(new PointerEvent("pointermove", {clientX: r.left + (x - meta.box[0]) / (meta.box[2] - meta.box[0]) * r.width,
                                                     clientY: r.top + (meta.box[3] - y) / (meta.box[3] - meta.box[1]) * r.height}));
    var text = document.querySelector("#player .said").textContent, ink = 0;
    var pixels = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
    for (var k = 3; k < pixels.length; k += 4) ink += pixels[k] > 0;
    c.dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowLeft"}));
    return "was " + before + "; now " + document.querySelector("#player output").textContent + "; " + text + "; ink " + ink / (c.width * c.height) +
           "; moved " + (document.querySelector("#player .said").textContent !== text);)JS");
  SCOPED_TRACE(said);
  ASSERT_EQ(said.find("was "), 0u);  // no error before it
  const double time = number_after(said, "now ");
  EXPECT_GT(number_after(said, "was "), time);
  std::size_t frame = motion.times().size();
  for (std::size_t k = 0; k < motion.times().size(); ++k)
    if (std::abs(motion.times()[k] - time) < 1e-6) frame = k;
  ASSERT_LT(frame, motion.times().size());
  // The particle that is named by its place is one of the record's, with its displacement.
  const std::size_t at = said.find(" mm at (");
  ASSERT_NE(at, std::string::npos);
  const double value = 1e-3 * number_after(said, "measured: ");
  const double x = number_after(said, " at ("), y = number_after(said.substr(at), ", ");
  const MotionFrame state = motion.frame(frame);
  double nearest = 1, found = 0;
  for (std::size_t p = 0; p < motion.particles().size(); ++p) {
    const Vec2 u(double(state.u[p][0]), double(state.u[p][1]));
    const double d = (motion.particles().x0[p] + u - Vec2(x, y)).norm();
    if (d < nearest) nearest = d, found = u.norm();
  }
  EXPECT_LT(nearest, 1e-5);
  EXPECT_NEAR(value, found, 2e-5 * found);
  EXPECT_GT(number_after(said, "ink "), 0.2);
  EXPECT_NE(said.find("moved true"), std::string::npos);
}

TEST_F(Browser, ItFitsATelephoneAndTheDark) {
  if (!installed("chromium")) GTEST_SKIP() << "chromium is not installed";
  const std::string narrow = in_page("return document.documentElement.scrollWidth+' in '+window.innerWidth;", "--window-size=400,800");
  EXPECT_LE(std::atof(narrow.c_str()), number_after(narrow, " in ")) << narrow;
  EXPECT_LE(number_after(narrow, " in "), 520) << narrow;
  const std::string colour = "var s=getComputedStyle(document.body);return s.color+' on '+s.backgroundColor;";
  const std::string light = in_page(colour, "--blink-settings=preferredColorScheme=1"), dark = in_page(colour, "--blink-settings=preferredColorScheme=0");
  EXPECT_NE(light, dark);
  EXPECT_NE(light.find("on rgb(255, 255, 255)"), std::string::npos) << light;
}

// Each number of the first page's table is text of the PDF.
TEST_F(Browser, ThePdfHoldsTheNumbersAsText) {
  if (!installed("pdftotext")) GTEST_SKIP() << "pdftotext is not installed";
  int code = 0;
  const std::string text = output_of("pdftotext -layout " + (folder_ / "report.pdf").string() + " -", code);
  ASSERT_EQ(code, 0);
  const auto table = summary_table(made_->content, data_set_names(made_->content));
  ASSERT_TRUE(table && !table->rows.empty());
  for (const auto& row : table->rows) EXPECT_NE(text.find(row[3]), std::string::npos) << row[0] << ": " << row[3];
  const Metric& rms = *find(made_->content.comparison->metrics, "displacement_rms");
  const std::string cell = plot::value_with_uncertainty(rms.value, rms.uncertainty), shown = cell.substr(0, cell.find(" \u00b1"));
  EXPECT_NE(text.find(shown), std::string::npos) << shown;
}

}  // namespace
}  // namespace pivnp::report

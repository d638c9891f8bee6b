// The options of single commands, and what they print.
#include <cmath>
#include <fstream>
#include <sstream>

#include "apps/cli/command_line.hpp"
#include "apps/cli/commands.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "tests/unit/cli/command_line.hpp"

namespace pivnp::app {
namespace {

using testing::HasSubstr;
using CommandOptions = CommandLine;

TEST_F(CommandOptions, SetWinsOverTheCase) {
  const std::string x = folder.write("set.toml", "[frames]\npath = 'a'\n[piv]\nwindow_px = 64\n").string();
  EXPECT_EQ(run_program({"track", x, "--set", "piv.window_px=24", "--set", "np.per_element=9"}).code, 0);
  EXPECT_EQ(fake_study().c.piv->window_px, 24);
  EXPECT_EQ(fake_study().c.np->per_element, 9);
  expect_error(run_program({"track", x, "--set", "piv.window_px=7"}), 2, "--set:1: piv.window_px: found 7, ");
}

TEST_F(CommandOptions, CompareTakesItsOptionsFromFlagsAndCases) {
  const std::string c =
      folder.write("c.toml", "[compare]\nslope_base_m = 0.1\n[compare.limits]\nstrain_rms = 0.2\n").string();
  const Ran ran = run_program({"compare", "a.h5:np", "b.h5:mpm", "--case", c, "--slope-base-m", "-0.5",
                               "--displacement-rms-m", "1e-3", "--reference-m", "[[0, 0], [1, 0], [1, 1]]"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  const FakeStudy& study = fake_study();
  EXPECT_EQ(study.first, "a.h5:np");
  EXPECT_EQ(study.second, "b.h5:mpm");
  EXPECT_EQ(study.options.slope_base_m, -0.5);
  EXPECT_EQ(study.options.reference_m.size(), 3u);
  EXPECT_EQ(study.limits["strain_rms"], 0.2);
  EXPECT_EQ(study.limits["displacement_rms_m"], 1e-3);
  EXPECT_EQ(study.settings.out, "out/compare");
  expect_error(run_program({"compare", "a", "b", "--slope-base-m", "low"}), 2,
               "command line: --slope-base-m: found a string \"low\", expected a number (m)\n");
  expect_error(run_program({"compare", "a", "b", "--strain-rms", "-1"}), 2,
               "command line: --strain-rms: found -1, expected at least 0\n");
  expect_error(run_program({"compare", "a", "b", "--slope-base-m", "1\n[x]"}), 2, "command line: --slope-base-m: ");
  expect_error(run_program({"compare", "a"}), 2, "SECOND is required");
  // Keys by their names in a case; those of other sections are not this command's.
  EXPECT_EQ(run_program({"compare", "a", "b", "--set", "compare.slope_base_m=0.25", "--set",
                         "compare.limits.strain_rms=0.3", "--no-report"})
                .code,
            0);
  EXPECT_EQ(study.options.slope_base_m, 0.25);
  EXPECT_EQ(study.limits["strain_rms"], 0.3);
  EXPECT_FALSE(study.settings.report);
  expect_error(run_program({"compare", "a", "b", "--set", "compare.slope_base=1"}), 2,
               "--set compare.slope_base=1: this command takes no key ");
  expect_error(run_program({"compare", "a", "b", "--set", "nonsense"}), 2, "--set nonsense: expected KEY=VALUE");
  EXPECT_EQ(run_program({"report", "r.h5", "--set", "report.title=A slope"}).code, 0);
  EXPECT_EQ(study.report.title, "A slope");
}

TEST_F(CommandOptions, ReportTakesLinesOfItsOwn) {
  EXPECT_EQ(run_program({"report", "r.h5", "--set", "report.line.toe.from_m=[0.3, 0.01]", "--set", "report.line.toe.to_m=[0.45, 0.01]", "--set",
                         "report.line.toe.field=strain_vol"}).code, 0);
  ASSERT_EQ(fake_study().report.lines.size(), 1u);
  EXPECT_EQ(fake_study().report.lines[0].first, "toe");
  EXPECT_EQ((*fake_study().report.lines[0].second.to_m)[0], 0.45);
  EXPECT_EQ(fake_study().report.lines[0].second.field, "strain_vol");
  expect_error(run_program({"report", "r.h5", "--set", "report.line.toe.from_m=[0.3, 0.01]"}), 2,
               "--set report.line.toe: to_m: missing, expected [x, y]\n");
  expect_error(run_program({"report", "r.h5", "--set", "report.line.toe.form_m=[0.3, 0.01]"}), 2,
               "--set report.line.toe.form_m=[0.3, 0.01]: this command takes no key 'report.line.toe.form_m'; did you mean 'report.line.toe.from_m'?\n");
}

TEST_F(CommandOptions, QueryPrintsWhatItIsAskedFor) {
  const Ran ran = run_program({"query", "r.h5:np", "--points", "[[0.3, 0.01], [0.4, 0.02]]", "--fields", "strain_vol,velocity_x", "--times", "0.5",
                               "--gauge", "0.02"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "time (s),strain_dev\n");
  EXPECT_EQ(fake_study().first, "r.h5:np");
  ASSERT_EQ(fake_study().query.points_m.size(), 2u);
  EXPECT_EQ(fake_study().query.fields_shown, (std::vector<std::string>{"strain_vol", "velocity_x"}));
  EXPECT_EQ(fake_study().query.gauge_m, 0.02);
  expect_error(run_program({"query", "r.h5:np", "--gauge", "0"}), 2, "command line: --gauge-m: found 0, expected more than 0");
}

TEST_F(CommandOptions, InitWritesACaseThatReads) {
  folder.write("lab/frames/a 1.pgm", "P5\n64 48\n255\n" + std::string(64 * 48, '\x40'));
  folder.write("lab/frames/a 2.pgm", "P5\n64 48\n255\n" + std::string(64 * 48, '\x40'));
  const std::string frames = (folder.path / "lab/frames/*.pgm").string(), lab = (folder.path / "lab").string();
  const Ran ran = run_program({"init", frames, "--out", lab, "--rate-hz", "50", "--metres-per-pixel", "2e-4"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  const Case c = read_case(lab);
  EXPECT_EQ(c.frames->rate_hz, 50.0);
  EXPECT_EQ(c.camera.metres_per_pixel, 2e-4);
  expect_error(run_program({"init", frames, "--out", lab}), 2,
               lab + "/case.toml: is there already; --force replaces it\n");
  EXPECT_EQ(run_program({"init", frames, "--out", lab, "--force"}).code, 0);
  std::ifstream written(lab + "/case.toml");
  const std::string text((std::istreambuf_iterator<char>(written)), {});
  EXPECT_TRUE(text.starts_with("#:schema /")) << text.substr(0, 80);
  EXPECT_TRUE(std::filesystem::exists(text.substr(9, text.find('\n') - 9)));
  const Ran printed = run_program({"init", frames});
  EXPECT_EQ(parse_case(printed.out, "printed", ".").frames->path, frames);
  expect_error(run_program({"init", "lab/a.png", "lab/b.png"}), 2,
               "FRAMES: found 2 files, expected one pattern; quote it, as in 'lab/*.png'\n");
  expect_error(run_program({"init", (folder.path / "none*.png").string()}), 2, "");
  expect_error(run_program({"init", frames, "--rate-hz", "-1"}), 2, "--rate-hz: ");
}

TEST_F(CommandOptions, CompareNamesTheFormatsThatAreListed) {
  const auto read = [](const std::vector<std::filesystem::path>&) { return io::ImportedState{}; };
  {
    const test::Added dots(io::file_formats(),
                           {.name = "dots", .files = "dots_*.txt", .text = "points", .read_time = read});
    EXPECT_THAT(run_program({"compare", "--help"}).out, HasSubstr("dots_*.txt"));
  }
  EXPECT_THAT(run_program({"compare", "--help"}).out, testing::Not(HasSubstr("dots_*.txt")));
}

TEST_F(CommandOptions, FrontierTakesACaseFramesOrNeither) {
  const Folder folder;
  const Ran drawn = run_program({"frontier", "--repeats", "2"});
  EXPECT_EQ(drawn.code, 0);
  EXPECT_EQ(drawn.out, "out/frontier/frontier.html\nTwice as fast.\nnote: Seen.\n");
  EXPECT_EQ(fake_study().calls.back(), "frontier");
  EXPECT_EQ(fake_study().frontier.repeats, 2);

  folder.write("case.toml",
               "name = \"lab\"\n[mpm]\nend_s = 1.0\noutput_rate_hz = 1.0\n[grid]\nspacing_m = "
               "0.1\n[region.a]\npolygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]\n[material.a]\nmodel = "
               "\"linear_elastic\"\ndensity_kg_m3 = 1.0\nyoung_pa = 1.0\n");
  EXPECT_EQ(run_program({"frontier", folder.path.string(), "--stages", "mpm", "--out", "x", "--quiet"}).out,
            "x/frontier.html\nTwice as fast.\n");
  EXPECT_EQ(fake_study().calls.back(), "frontier of a case");
  EXPECT_FALSE(fake_study().frontier.piv);
  EXPECT_TRUE(fake_study().frontier.mpm);

  EXPECT_EQ(run_program({"frontier", "--frames", "lab/*.png", "--set", "piv.window_px=24"}).code, 0);
  EXPECT_EQ(fake_study().c.piv->window_px, 24);
  EXPECT_TRUE(fake_study().frontier.piv);
  expect_error(run_program({"frontier", "--set", "piv.window_px=24"}), 2,
               "--set: given without a case, expected CASE or --frames");
  expect_error(run_program({"frontier", "--stages", "report"}), 2, "");
}

TEST_F(CommandOptions, StressTakesSettingsOrNone) {
  const Ran plain = run_program({"stress", "--seeds", "3", "--stages", "piv"});
  EXPECT_EQ(plain.code, 0);
  EXPECT_EQ(plain.out, "out/stress/stress.html\nAll is flagged.\n");
  EXPECT_EQ(fake_study().calls.back(), "stress");
  EXPECT_EQ(fake_study().stress.seeds, 3);
  EXPECT_EQ(fake_study().stress.stages, std::vector<std::string>{"piv"});
  EXPECT_EQ(run_program({"stress", "--short", "--maps", "np_hole,mpm_step"}).code, 0);
  EXPECT_TRUE(fake_study().stress.in_short);
  EXPECT_EQ(fake_study().stress.maps, (std::vector<std::string>{"np_hole", "mpm_step"}));
  EXPECT_EQ(run_program({"stress", "--set", "piv.method=fft"}).code, 0);
  EXPECT_EQ(fake_study().calls.back(), "stress of a case");
  EXPECT_EQ(fake_study().c.piv->method, "fft");
  expect_error(run_program({"stress", "--seeds", "0"}), 2, "");
}

TEST_F(CommandOptions, SweepsACase) {
  const Folder folder;
  const std::string file = folder
                               .write("case.toml",
                                      "name = \"lab\"\n[mpm]\nend_s = 1.0\noutput_rate_hz = 1.0\n[grid]\nspacing_m = "
                                      "0.1\n[region.a]\npolygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]\n"
                                      "[material.a]\nmodel = \"linear_elastic\"\ndensity_kg_m3 = 1.0\nyoung_pa = 1.0\n")
                               .string();
  const Ran plain =
      run_program({"sweep", file, "--vary", "mpm.damping=0.1,0.2", "--vary", "mpm.courant=0.8", "--grid", "--response",
                   "run_out,top_speed", "--zone", "0,0,1,2", "--jobs", "3", "--set", "mpm.end_s=2.0"});
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_EQ(fake_study().calls.back(), "sweep");
  const SweepOptions& asked = fake_study().sweep;
  EXPECT_EQ(asked.vary, (std::vector<std::string>{"mpm.damping=0.1,0.2", "mpm.courant=0.8"}));
  EXPECT_TRUE(asked.grid);
  EXPECT_EQ(asked.responses, (std::vector<std::string>{"run_out", "top_speed"}));
  EXPECT_EQ(asked.zone_m, (std::vector<double>{0, 0, 1, 2}));
  EXPECT_EQ(asked.jobs, 3);
  EXPECT_EQ(asked.given, std::vector<std::string>{"mpm.end_s=2.0"});
  EXPECT_FALSE(asked.program.empty());
  EXPECT_NE(plain.out.find("sweep.html"), std::string::npos);
  EXPECT_EQ(run_program({"sweep", file}).code, 2);

  const Ran tested = run_program({"element", file, "--test", "direct_shear", "--pressure", "20e3,40e3", "--undrained", "--band", "0.01"});
  ASSERT_EQ(tested.code, 0) << tested.err;
  const ElementStudy& element = fake_study().element;
  EXPECT_EQ(element.test.test, mpm::ElementTest::direct_shear);
  EXPECT_EQ(element.pressures_pa, (std::vector<double>{20e3, 40e3}));
  EXPECT_TRUE(element.test.undrained);
  EXPECT_EQ(element.band_m, 0.01);
  EXPECT_NE(tested.out.find("It carries nothing."), std::string::npos);
  EXPECT_EQ(run_program({"element", file, "--test", "vane"}).code, 2);
}

TEST_F(CommandOptions, HelpShowsAnExampleForEveryCommand) {
  const Ran all = run_program({"--help"});
  EXPECT_EQ(all.code, 0);
  EXPECT_EQ(all.err, "");
  for (const Command& command : commands()) {
    EXPECT_THAT(all.out, HasSubstr("\n  " + std::string(command.name) + " "));
    const Ran one = run_program({std::string(command.name), "--help"});
    EXPECT_EQ(one.code, 0);
    EXPECT_THAT(one.out, HasSubstr("Examples:\n  pivnp " + std::string(command.name)));
    EXPECT_THAT(one.out, HasSubstr("--threads"));
  }
  EXPECT_EQ(run_program({"--version"}).out.rfind("pivnp ", 0), 0u);
  EXPECT_TRUE(fake_study().calls.empty());
}

TEST(Compare, AsJson) {
  FakeStudy& study = fake_study();
  study = {};
  Metric rms{"displacement_rms", 0.003, "m", 0.002, "\"RMS\"", Verdict::not_resolved, 2, LostIn::mesh};
  Metric plain{"coverage_first", 0.9, "1", std::nan(""), "share"};
  Metric real{"run_out_x_difference", -0.5, "m", 0.1, "", Verdict::differs, 2};
  study.outcome.metrics = {rms, plain, real};
  study.outcome.remarks = {{"A \"line\"\nof two."}};
  LimitResult limit{"displacement_rms_m", 0.005, 0.003, true};
  limit.within = 0.00629;
  study.outcome.limits = {limit};
  const Ran ran = run_program({"compare", "a", "b", "--json"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.out, testing::StartsWith("{"));
  EXPECT_THAT(ran.out, testing::EndsWith("}\n"));
  EXPECT_THAT(
      ran.out,
      HasSubstr(
          "\"displacement_rms\": {\"value\": 0.003, \"unit\": \"m\", \"uncertainty\": 0.002, \"within_95\": 0.00629"));
  EXPECT_THAT(ran.out, HasSubstr("\"verdict\": \"not resolved\", \"lost_in\": \"mesh\""));
  EXPECT_THAT(ran.out, HasSubstr("\"verdict\": \"differs\"}"));
  EXPECT_THAT(ran.out, HasSubstr("\"coverage_first\": {\"value\": 0.9, \"unit\": \"1\", \"uncertainty\": null}"));
  EXPECT_THAT(ran.out, HasSubstr("\"reached\": 0.003, \"verdict\": \"met\", \"shown_95\": false"));
  EXPECT_THAT(ran.out, HasSubstr("A \\\"line\\\"\\u000aof two."));
  study = {};
}

}  // namespace
}  // namespace pivnp::app

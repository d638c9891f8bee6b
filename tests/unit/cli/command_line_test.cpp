// The command line: what reaches the library, exit codes, one line an error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <omp.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <new>
#include <sstream>

#include "apps/cli/command_line.hpp"
#include "apps/cli/commands.hpp"
#include "apps/cli/signals.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/instruction_set.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "tests/support/added.hpp"
#include "tests/unit/cli/fake_study.hpp"

namespace pivnp::app {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    fake_study() = {};
    clear_stop_signal();
  }
  Folder folder;
  const std::string measured = folder.write("slope/case.toml", "[frames]\npath = 'img_*.png'\n").string();
};

// One line that begins as all errors do; the text may be followed by a hint.
void expect_error(const Ran& ran, int code, const std::string& text) {
  EXPECT_EQ(ran.code, code);
  EXPECT_THAT(ran.err, StartsWith("pivnp: error: " + text));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_EQ(ran.out, "");
}

TEST_F(CommandLine, RunHandsCaseAndSettingsToTheStudy) {
  const Ran ran =
      run_program({"run", measured, "--out", "o ut", "--threads", "3", "--resume", "--frames", "it's/*.png"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  const FakeStudy& study = fake_study();
  ASSERT_EQ(study.calls, std::vector<std::string>{"run_case"});
  EXPECT_EQ(study.stages, Stages::all);
  EXPECT_EQ(study.c.frames->path, "img_*.png");
  EXPECT_EQ(study.settings.out, "o ut");
  EXPECT_EQ(study.settings.threads, std::min(3, omp_get_num_procs()));
  EXPECT_TRUE(study.settings.resume);
  EXPECT_EQ(study.settings.frames, "it's/*.png");
  EXPECT_THAT(study.settings.command, StartsWith("pivnp run "));
  EXPECT_THAT(study.settings.command, HasSubstr("--out 'o ut' --threads 3 --resume --frames 'it'\\''s/*.png'"));
}

// Tracking follows OpenMP's own number. No more are used than there are processors.
TEST_F(CommandLine, ThreadsHoldForEveryEngine) {
  int seen = 0;
  fake_study().work = [&](Progress&) { seen = omp_get_max_threads(); };
  EXPECT_EQ(run_program({"run", measured}).code, 0);
  const int all = seen;
  EXPECT_LE(all, omp_get_num_procs());
  EXPECT_EQ(run_program({"run", measured, "--threads", "1"}).code, 0);
  EXPECT_EQ(seen, 1);
  EXPECT_EQ(run_program({"run", measured, "--threads", "4096"}).code, 0);
  EXPECT_EQ(seen, omp_get_num_procs());
  EXPECT_EQ(run_program({"run", measured}).code, 0);
  EXPECT_EQ(seen, all);
}

// The set holds for one command line. A set of this name that the processor lacks is refused.
TEST_F(CommandLine, TheInstructionSetIsTheOneAskedFor) {
  std::string seen;
  fake_study().work = [&](Progress&) { seen = instruction_set(); };
  const std::vector<std::string> sets = instruction_sets();
  ASSERT_EQ(sets.back(), "sse2");
  for (const std::string& set : sets) {
    EXPECT_EQ(run_program({"run", measured, "--simd", set}).code, 0);
    EXPECT_EQ(seen, set);
  }
  EXPECT_EQ(run_program({"run", measured}).code, 0);
  EXPECT_EQ(seen, sets.front());
  fake_study().calls.clear();
  expect_error(run_program({"run", measured, "--simd", "mmx"}), 2, "--simd: there is no instruction set 'mmx', expected one of ");
  if (sets.size() > 1) {
    hwy::DisableTargets(~HWY_STATIC_TARGET);
    expect_error(run_program({"--simd", sets.front(), "run", measured}), 2,
                 "--simd: this processor has no " + sets.front() + ", only sse2\n");
    hwy::DisableTargets(0);
  }
  EXPECT_TRUE(fake_study().calls.empty());
  expect_error(run_program({"--simd", "sse2", "smulate"}), 2, "unknown command 'smulate'");
}

TEST_F(CommandLine, WhatIsLeftOutIsChosen) {
  EXPECT_EQ(run_program({"run"}).code, 0);
  EXPECT_EQ(fake_study().settings.out, "out/gate_slope");
  EXPECT_TRUE(fake_study().c.synth);
  EXPECT_EQ(run_program({"run", (folder.path / "slope").string()}).code, 0);
  EXPECT_EQ(fake_study().settings.out, "out/slope");
  EXPECT_EQ(fake_study().settings.threads, 0);
  EXPECT_FALSE(fake_study().settings.resume);
  EXPECT_FALSE(fake_study().settings.frames);
}

TEST_F(CommandLine, EachCommandCallsItsFunction) {
  const std::string synth = folder
                                .write("s.toml",
                                       "[synth]\n[region.a]\npolygon_m = [[0,0],[1,0],[1,1]]\n"
                                       "[material.a]\ndensity_kg_m3 = 1\nyoung_pa = 1\ncohesion_pa = 1\n[mpm]\n")
                                .string();
  for (const auto& [command, call, stages] :
       std::vector<std::tuple<std::string, std::string, Stages>>{{"piv", "run_case", Stages::piv},
                                                                 {"track", "run_case", Stages::track},
                                                                 {"simulate", "run_case", Stages::simulate},
                                                                 {"check", "check_case", Stages::all},
                                                                 {"synth", "synthesize", Stages::all}}) {
    fake_study() = {};
    const Ran ran = run_program({command, synth});
    EXPECT_EQ(ran.code, 0) << command << ran.err;
    EXPECT_EQ(fake_study().calls, std::vector<std::string>{call}) << command;
    EXPECT_EQ(fake_study().stages, stages) << command;
  }
  EXPECT_EQ(run_program({"report", "r.h5"}).code, 0);
  EXPECT_EQ(run_program({"report", "r.h5", "--title", "My sand, 1 g", "--times", "0.1,0.2", "--fields",
                         "strain_dev,velocity_x", "--points", "[[0.1, 0.2]]"}).code, 0);
  EXPECT_EQ(fake_study().report.title, "My sand, 1 g");
  EXPECT_EQ(fake_study().report.times_s, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(fake_study().report.fields_drawn, (std::vector<std::string>{"strain_dev", "velocity_x"}));
  EXPECT_EQ(fake_study().report.points_m.size(), 1u);
  EXPECT_EQ(fake_study().first, "r.h5");
  EXPECT_EQ(fake_study().settings.out, "");
  EXPECT_EQ(run_program({"report", "r.h5", "--gauge", "0.05", "--data-sets", "np", "--compare-runs", "a,b"}).code, 0);
  EXPECT_EQ(fake_study().report.gauge_m, 0.05);
  EXPECT_EQ(fake_study().report.data_sets, std::vector<std::string>{"np"});
  EXPECT_EQ(fake_study().report.compare_runs, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(run_program({"report", "r.h5", "--compare-runs", "a", "b", "c", "--times", "0.1", "0.2"}).code, 0);
  EXPECT_EQ(fake_study().report.compare_runs, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(fake_study().report.times_s, (std::vector<double>{0.1, 0.2}));
}

TEST_F(CommandLine, ExportHandsOnWhatIsAskedFor) {
  const auto ran = run_program({"export", "r.h5", "--motions", "np,piv", "--fields", "strain_dev", "--times", "0.2,0.4", "--format", "vtkhdf", "--out", "o"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("np.csv"), std::string::npos);
  EXPECT_EQ(fake_study().first, "r.h5");
  EXPECT_TRUE(fake_study().vtkhdf);
  EXPECT_EQ(fake_study().exported.motions, (std::vector<std::string>{"np", "piv"}));
  EXPECT_EQ(fake_study().exported.times, (std::vector<double>{0.2, 0.4}));
  expect_error(run_program({"export", "r.h5", "--format", "xls"}), 2, "");
}

TEST_F(CommandLine, AFolderOfFramesStandsForTheCasesPattern) {
  EXPECT_EQ(run_program({"run", measured, "--frames", folder.path.string()}).code, 0);
  EXPECT_EQ(fake_study().settings.frames, (folder.path / "img_*.png").string());
  const std::string video = folder.write("v.toml", "[frames]\npath = 'videos/v.mp4'\n").string();
  EXPECT_EQ(run_program({"run", video, "--frames", folder.path.string()}).code, 0);
  EXPECT_EQ(fake_study().settings.frames, folder.path.string()) << "no v.mp4 in there: all images of the folder";
  folder.write("v.mp4", "x");
  EXPECT_EQ(run_program({"run", video, "--frames", folder.path.string()}).code, 0);
  EXPECT_EQ(fake_study().settings.frames, (folder.path / "v.mp4").string());
}

TEST_F(CommandLine, ResultsArePrinted) {
  fake_study().outcome = {"o/record.h5", "o/report.html", "o/report.pdf", {"Frame 3 is bad."}, {}, {}, {}};
  const Ran ran = run_program({"run", measured});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "o/record.h5\no/report.html\no/report.pdf\nnote: Frame 3 is bad.\n");
  EXPECT_EQ(run_program({"run", measured, "--quiet"}).out, "o/record.h5\no/report.html\no/report.pdf\n");
  fake_study().outcome.limits = {{"strain_rms", 0.1, 0.05, true}, {"coverage_min", 0.9, 0.5, false}};
  const Ran over = run_program({"run", measured});
  EXPECT_EQ(over.code, 3);
  const std::string met = "compare.limits.strain_rms: " + std::string(name_of(Verdict::met)),
                    exceeded = "compare.limits.coverage_min: " + std::string(name_of(Verdict::exceeded));
  EXPECT_THAT(over.out, AllOf(HasSubstr(met), HasSubstr(exceeded)));
  const Ran quiet = run_program({"run", measured, "--quiet"});
  EXPECT_EQ(quiet.code, 3);
  EXPECT_THAT(quiet.out, AllOf(Not(HasSubstr(met)), HasSubstr(exceeded)));
}

TEST_F(CommandLine, FailuresBecomeExitCodes) {
  auto run_with = [&](std::function<void(Progress&)> work) {
    fake_study().work = std::move(work);
    return run_program({"run", measured});
  };
  expect_error(run_with([](Progress&) { throw InputError("c.toml:3: no"); }), 2, "c.toml:3: no\n");
  expect_error(run_with([](Progress&) { throw RunError("disk\nfull"); }), 1, "disk full\n");
  expect_error(run_with([](Progress&) { throw std::bad_alloc(); }), 1, "out of memory\n");
  expect_error(run_with([](Progress&) { std::filesystem::create_directory("/proc/none/none"); }), 1,
               "filesystem error: ");
  expect_error(run_with([](Progress&) { throw 3; }), 1, "an unknown failure\n");
  const Ran stopped = run_with([](Progress&) { throw Interrupted(); });
  EXPECT_EQ(stopped.code, 130);
  EXPECT_EQ(stopped.err, "pivnp: interrupted; what was finished is kept, --resume continues from there\n");
}

TEST_F(CommandLine, CtrlCAsksTheWorkToStop) {
  install_signal_handlers();
  fake_study().work = [](Progress& progress) {
    EXPECT_FALSE(progress.stop_requested());
    std::raise(SIGINT);
    if (progress.stop_requested()) throw Interrupted();
  };
  EXPECT_EQ(run_program({"run", measured}).code, 130);
  clear_stop_signal();
  EXPECT_EXIT((std::raise(SIGTERM), std::raise(SIGINT)), testing::ExitedWithCode(130), "once more ends at once")
      << "the second ends the program";
}

TEST_F(CommandLine, AClosedOutputIsAnError) {
  std::ostringstream out, err;
  out.setstate(std::ios::badbit);
  const std::vector<const char*> argv{"pivnp", "run", measured.c_str()};
  EXPECT_EQ(run_command_line(int(argv.size()), argv.data(), out, err, false), 1);
  EXPECT_EQ(err.str(), "pivnp: error: standard output cannot be written\n");
}

TEST_F(CommandLine, BadUsageIsOneLineWithTheNearestName) {
  expect_error(run_program({"rum"}), 2, "unknown command 'rum'; did you mean 'run'? (see 'pivnp --help')\n");
  expect_error(run_program({"--threads", "2", "smulate"}), 2, "unknown command 'smulate'; did you mean 'simulate'?");
  expect_error(run_program({}), 2, "no command is given ('pivnp --help' lists them)\n");
  expect_error(run_program({"run", measured, "--thread", "2"}), 2,
               "unknown option '--thread'; did you mean '--threads'? (see 'pivnp run --help')\n");
  expect_error(run_program({"run", measured, "--otu=x"}), 2, "unknown option '--otu'; did you mean '--out'?");
  expect_error(run_program({"--quite", "run"}), 2, "unknown option '--quite'; did you mean '--quiet'?");
  expect_error(run_program({"report"}), 2, "RECORD is required (see 'pivnp report --help')\n");
  expect_error(run_program({"run", measured, "--threads", "0"}), 2, "--threads: ");
  expect_error(run_program({"run", measured, "--threads", "two"}), 2, "");
  expect_error(run_program({"run", measured, "other.toml"}), 2, "");
  expect_error(run_program({"synth", measured, "--resume"}), 2, "unknown option '--resume'");
  EXPECT_TRUE(fake_study().calls.empty());
}

TEST_F(CommandLine, BadCasesEndWithTwo) {
  expect_error(run_program({"run", "nowhere.toml"}), 2, "nowhere.toml: no such file\n");
  const std::string bad = folder.write("bad.toml", "[piv]\nwindow = 3\n").string();
  expect_error(run_program({"check", bad}), 2, bad + ":2: unknown key 'piv.window'; did you mean 'window_px'?\n");
}

TEST_F(CommandLine, ACaseThatLacksWhatTheCommandNeeds) {
  const auto file = [&](const std::string& text) { return folder.write("x.toml", text).string(); };
  expect_error(run_program({"simulate", measured}), 2, measured + ": there is nothing to simulate; expected [mpm]\n");
  expect_error(run_program({"synth", measured}), 2, measured + ": there is nothing to draw; expected [synth]\n");
  std::string x = file("name = 'empty'\n");
  expect_error(run_program({"run", x}), 2, x + ": there is nothing to do; ");
  expect_error(run_program({"piv", x}), 2, x + ": there are no frames to measure; ");
  EXPECT_EQ(run_program({"piv", x, "--frames", "a.mp4"}).code, 0);
  EXPECT_TRUE(fake_study().c.piv && fake_study().c.np);
  x = file("[frames]\nrate_hz = 3\n");
  expect_error(run_program({"run", x}), 2, x + ": frames.path: missing; expected it in the case, or --frames PATH\n");
  EXPECT_EQ(run_program({"run", x, "--frames", "a.mp4"}).code, 0);
  x = file("[piv]\nwindow_px = 24\n");
  EXPECT_EQ(run_program({"run", x, "--frames", "a.mp4"}).code, 0);
  EXPECT_EQ(fake_study().c.piv->window_px, 24);
  x = file("[frames]\npath = 'a'\n[compare.limits]\nstrain_rms = 0.1\n");
  expect_error(run_program({"run", x}), 2, x + ": [compare.limits]: given, but nothing is compared; ");
  EXPECT_EQ(run_program({"track", x}).code, 0) << "no comparison is asked for";
}

TEST_F(CommandLine, SetWinsOverTheCase) {
  const std::string x = folder.write("set.toml", "[frames]\npath = 'a'\n[piv]\nwindow_px = 64\n").string();
  EXPECT_EQ(run_program({"track", x, "--set", "piv.window_px=24", "--set", "np.per_element=9"}).code, 0);
  EXPECT_EQ(fake_study().c.piv->window_px, 24);
  EXPECT_EQ(fake_study().c.np->per_element, 9);
  expect_error(run_program({"track", x, "--set", "piv.window_px=7"}), 2, "--set:1: piv.window_px: found 7, ");
}

TEST_F(CommandLine, CompareTakesItsOptionsFromFlagsAndCases) {
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
  EXPECT_EQ(run_program({"compare", "a", "b", "--set", "compare.slope_base_m=0.25", "--set", "compare.limits.strain_rms=0.3", "--no-report"}).code, 0);
  EXPECT_EQ(study.options.slope_base_m, 0.25);
  EXPECT_EQ(study.limits["strain_rms"], 0.3);
  EXPECT_FALSE(study.settings.report);
  expect_error(run_program({"compare", "a", "b", "--set", "compare.slope_base=1"}), 2, "--set compare.slope_base=1: this command takes no key ");
  expect_error(run_program({"compare", "a", "b", "--set", "nonsense"}), 2, "--set nonsense: expected KEY=VALUE");
  EXPECT_EQ(run_program({"report", "r.h5", "--set", "report.title=A slope"}).code, 0);
  EXPECT_EQ(study.report.title, "A slope");
}

TEST_F(CommandLine, InitWritesACaseThatReads) {
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

TEST_F(CommandLine, CompareNamesTheFormatsThatAreListed) {
  const auto read = [](const std::vector<std::filesystem::path>&) { return io::ImportedState{}; };
  {
    const test::Added dots(io::file_formats(), {.name = "dots", .files = "dots_*.txt", .text = "points", .read_time = read});
    EXPECT_THAT(run_program({"compare", "--help"}).out, HasSubstr("dots_*.txt"));
  }
  EXPECT_THAT(run_program({"compare", "--help"}).out, testing::Not(HasSubstr("dots_*.txt")));
}

TEST_F(CommandLine, FrontierTakesACaseFramesOrNeither) {
  const Folder folder;
  const Ran drawn = run_program({"frontier", "--repeats", "2"});
  EXPECT_EQ(drawn.code, 0);
  EXPECT_EQ(drawn.out, "out/frontier/frontier.html\nTwice as fast.\nnote: Seen.\n");
  EXPECT_EQ(fake_study().calls.back(), "frontier");
  EXPECT_EQ(fake_study().frontier.repeats, 2);

  folder.write("case.toml", "name = \"lab\"\n[mpm]\nend_s = 1.0\noutput_rate_hz = 1.0\n[grid]\nspacing_m = 0.1\n[region.a]\npolygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]\n[material.a]\nmodel = \"linear_elastic\"\ndensity_kg_m3 = 1.0\nyoung_pa = 1.0\n");
  EXPECT_EQ(run_program({"frontier", folder.path.string(), "--stages", "mpm", "--out", "x", "--quiet"}).out, "x/frontier.html\nTwice as fast.\n");
  EXPECT_EQ(fake_study().calls.back(), "frontier of a case");
  EXPECT_FALSE(fake_study().frontier.piv);
  EXPECT_TRUE(fake_study().frontier.mpm);

  EXPECT_EQ(run_program({"frontier", "--frames", "lab/*.png", "--set", "piv.window_px=24"}).code, 0);
  EXPECT_EQ(fake_study().c.piv->window_px, 24);
  EXPECT_TRUE(fake_study().frontier.piv);
  expect_error(run_program({"frontier", "--set", "piv.window_px=24"}), 2, "--set: given without a case, expected CASE or --frames");
  expect_error(run_program({"frontier", "--stages", "report"}), 2, "");
}

TEST_F(CommandLine, StressTakesSettingsOrNone) {
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

TEST_F(CommandLine, SweepsACase) {
  const Folder folder;
  const std::string file = folder.write("case.toml", "name = \"lab\"\n[mpm]\nend_s = 1.0\noutput_rate_hz = 1.0\n[grid]\nspacing_m = 0.1\n[region.a]\npolygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]\n"
                                               "[material.a]\nmodel = \"linear_elastic\"\ndensity_kg_m3 = 1.0\nyoung_pa = 1.0\n").string();
  const Ran plain = run_program({"sweep", file, "--vary", "mpm.damping=0.1,0.2", "--vary", "mpm.courant=0.8", "--grid", "--response", "run_out,top_speed",
                                 "--zone", "0,0,1,2", "--jobs", "3", "--set", "mpm.end_s=2.0"});
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
}

TEST_F(CommandLine, HelpShowsAnExampleForEveryCommand) {
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
  Metric rms{"displacement_rms", 0.003, "m", 0.002, "\"RMS\"", Verdict::not_distinguishable, 2};
  Metric plain{"coverage_first", 0.9, "1", std::nan(""), "share"};
  Metric real{"run_out_x_difference", -0.5, "m", 0.1, "", Verdict::none, 2};
  study.outcome.metrics = {rms, plain, real};
  study.outcome.remarks = {"A \"line\"\nof two."};
  LimitResult limit{"displacement_rms_m", 0.005, 0.003, true};
  limit.within = 0.00629;
  study.outcome.limits = {limit};
  const Ran ran = run_program({"compare", "a", "b", "--json"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.out, testing::StartsWith("{"));
  EXPECT_THAT(ran.out, testing::EndsWith("}\n"));
  EXPECT_THAT(ran.out, HasSubstr("\"displacement_rms\": {\"value\": 0.003, \"unit\": \"m\", \"uncertainty\": 0.002, \"within_95\": 0.00629"));
  EXPECT_THAT(ran.out, HasSubstr("\"verdict\": \"not distinguishable at this u_val\""));
  EXPECT_THAT(ran.out, HasSubstr("\"verdict\": \"distinguishable\""));
  EXPECT_THAT(ran.out, HasSubstr("\"coverage_first\": {\"value\": 0.9, \"unit\": \"1\", \"uncertainty\": null}"));
  EXPECT_THAT(ran.out, HasSubstr("\"reached\": 0.003, \"verdict\": \"met\", \"shown_95\": false"));
  EXPECT_THAT(ran.out, HasSubstr("A \\\"line\\\"\\u000aof two."));
  study = {};
}

}  // namespace
}  // namespace pivnp::app

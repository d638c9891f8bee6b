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
#include "tests/unit/cli/command_line.hpp"

namespace pivnp::app {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

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

TEST_F(CommandLine, AFinishedRecordIsReplacedByForceAlone) {
  const std::string out = (folder.path / "done").string();
  folder.write("done/record.h5", "hours of work");
  for (const char* command : {"run", "piv", "track"})
    expect_error(run_program({command, measured, "--out", out}), 2, out + "/record.h5: is there already; --force replaces it");
  EXPECT_TRUE(fake_study().calls.empty());
  EXPECT_EQ(run_program({"run", measured, "--out", out, "--force"}).code, 0);
  EXPECT_EQ(run_program({"run", measured, "--out", out, "--resume"}).code, 0);
  folder.write("done/parts/head.h5", "a run that was interrupted");
  EXPECT_EQ(run_program({"run", measured, "--out", out}).code, 0);
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
  EXPECT_EQ(fake_study().format, io::ExportFormat::vtkhdf);
  EXPECT_EQ(fake_study().exported.motions, (std::vector<std::string>{"np", "piv"}));
  EXPECT_EQ(fake_study().exported.times, (std::vector<double>{0.2, 0.4}));
  EXPECT_EQ(run_program({"export", "r.h5", "--format", "vtu"}).code, 0);
  EXPECT_EQ(fake_study().format, io::ExportFormat::vtu);
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

TEST_F(CommandLine, WhatIsNotUsableIsAnError) {
  fake_study().outcome = {"o/record.h5", "", "", {Remark{"Nothing moves.", RemarkWeight::unusable}, Remark{"Frame 4 is dark.", RemarkWeight::doubt}}, {}, {}, {}};
  const Ran ran = run_program({"track", measured});
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.out, "o/record.h5\nwarning: Frame 4 is dark.\n");
  EXPECT_EQ(ran.err, "pivnp: error: Nothing moves.\n");
  EXPECT_EQ(run_program({"track", measured, "--quiet"}).err, ran.err);
  EXPECT_EQ(run_program({"report", "o/record.h5"}).code, 0) << "a report can be drawn of it";
}

TEST_F(CommandLine, ResultsArePrinted) {
  fake_study().outcome = {"o/record.h5", "o/report.html", "o/report.pdf", {Remark{"Frame 3 is bad."}}, {}, {}, {}};
  const Ran ran = run_program({"run", measured});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "o/record.h5\no/report.html\no/report.pdf\nnote: Frame 3 is bad.\n");
  EXPECT_EQ(run_program({"run", measured, "--quiet"}).out, "o/record.h5\no/report.html\no/report.pdf\n");
  fake_study().outcome.limits = {{"strain_rms", 0.1, 0.05, true}, {"coverage_min", 0.9, 0.5, false}};
  const Ran over = run_program({"run", measured});
  EXPECT_EQ(over.code, 3);
  const std::string met = "compare.limits.strain_rms: " + std::string(name_of(LimitFate::met)),
                    exceeded = "compare.limits.coverage_min: " + std::string(name_of(LimitFate::exceeded));
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
               "/proc/none/none: No such file or directory");
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

// The window is a program of its own, which does not lie beside the tests.
TEST_F(CommandLine, AWindowThatIsNotInstalledIsSaidSo) {
  const Ran result = run_program({"view", "lab"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("pivnp-view: the window is not installed; expected the package pivnp-view\n"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace pivnp::app

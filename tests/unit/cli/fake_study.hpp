// A study that does nothing but remember what it was asked, so that the command line can be tested alone.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/study/study.hpp"
#include "pivnp/io/exports/exports.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {

struct FakeStudy {
  std::vector<std::string> calls;  // "run_case", ...
  Case c;
  RunSettings settings;
  Stages stages = Stages::all;
  std::string first, second;
  compare::CompareOptions options;
  compare::LimitOptions limits;
  report::ReportOptions report;
  FrontierOptions frontier;
  StressOptions stress;
  SweepOptions sweep;
  ElementStudy element;
  QueryOptions query;
  io::ExportOptions exported;
  io::ExportFormat format = io::ExportFormat::csv;
  std::function<void(Progress&)> work;  // what every call does: throw, report progress, wait for a stop
  RunOutcome outcome;
  std::vector<VerifyResult> verdicts;  // handed out one after the other
};

FakeStudy& fake_study();

/// What the program did.
struct Ran {
  int code;
  std::string out, err;
};
Ran run_program(const std::vector<std::string>& words);

/// An empty folder of its own, removed at the end.
struct Folder : test::Scratch {
  std::filesystem::path write(const std::string& name, const std::string& text) const;
};

}  // namespace pivnp::app

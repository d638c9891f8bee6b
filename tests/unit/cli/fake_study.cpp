#include "tests/unit/cli/fake_study.hpp"


#include <fstream>
#include <sstream>

#include "apps/cli/command_line.hpp"

namespace pivnp::app {

FakeStudy& fake_study() {
  static FakeStudy study;
  return study;
}

namespace {

void called(const std::string& name, const RunSettings& settings, Progress& progress) {
  fake_study().calls.push_back(name);
  fake_study().settings = settings;
  if (fake_study().work) fake_study().work(progress);
}

}  // namespace

RunOutcome run_case(const Case& c, const RunSettings& settings, Stages stages, Progress& progress) {
  fake_study().c = c;
  fake_study().stages = stages;
  called("run_case", settings, progress);
  return fake_study().outcome;
}

RunOutcome compare_records(const CompareSources& sources, const compare::CompareOptions& options,
                           const compare::LimitOptions& limits, const RunSettings& settings, Progress& progress) {
  fake_study().first = sources.first;
  fake_study().second = sources.second;
  fake_study().options = options;
  fake_study().limits = limits;
  called("compare_records", settings, progress);
  return fake_study().outcome;
}

void synthesize(const Case& c, const RunSettings& settings, Progress& progress, const io::DirectoryLock*) {
  fake_study().c = c;
  called("synthesize", settings, progress);
}

RunOutcome report_record(const std::filesystem::path& record, const RunSettings& settings, Progress& progress,
                         const std::function<void(report::ReportOptions&)>& change) {
  fake_study().report = {};
  if (change) change(fake_study().report);
  fake_study().first = record.string();
  called("report_record", settings, progress);
  return fake_study().outcome;
}

std::vector<std::filesystem::path> export_record(const std::filesystem::path& record, const std::filesystem::path& out, io::ExportFormat format,
                                                 const io::ExportOptions& options) {
  fake_study().first = record.string();
  fake_study().exported = options;
  fake_study().format = format;
  return {out / "np.csv"};
}

std::string query_motion(const std::string& source, const QueryOptions& options) {
  fake_study().first = source;
  fake_study().query = options;
  return "time (s),strain_dev\n";
}

CheckOutcome check_case(const Case& c, const RunSettings& settings, Progress& progress) {
  fake_study().c = c;
  called("check_case", settings, progress);
  return {settings.out / "check.png", {}};
}

VerifyResult verify_case(const Case& c, const RunSettings& settings, Progress& progress) {
  FakeStudy& study = fake_study();
  study.c = c;
  called("verify_case", settings, progress);
  VerifyResult result = study.verdicts.at(0);
  study.verdicts.erase(study.verdicts.begin());
  return result;
}

CalibrateOutcome calibrate_camera(const std::string& pattern, const image::Board& board, image::LensModel model, bool third,
                                  const std::filesystem::path& out) {
  CalibrateOutcome outcome;
  outcome.keys = out / "camera.toml";
  outcome.picture = out / "residuals.png";
  outcome.remarks = {pattern + ", " + std::to_string(board.columns) + " by " + std::to_string(board.rows) + ", " +
                     std::string(name_of(model)) + (third ? ", k3" : "")};
  return outcome;
}

Ran run_program(const std::vector<std::string>& words) {
  std::vector<const char*> argv{"/usr/bin/pivnp"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out, err;
  const int code = run_command_line(int(argv.size()), argv.data(), out, err, false);
  return {code, out.str(), err.str()};
}

std::filesystem::path Folder::write(const std::string& name, const std::string& text) const {
  const std::filesystem::path file = path / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

FrontierOutcome frontier(const Case* c, const FrontierOptions& options, const RunSettings& settings, Progress& progress) {
  if (c) fake_study().c = *c;
  fake_study().frontier = options;
  called(c ? "frontier of a case" : "frontier", settings, progress);
  return {{}, {settings.out / "frontier.html"}, {"Twice as fast."}, {"Seen."}};
}

StressOutcome stress(const Case* c, const StressOptions& options, const RunSettings& settings, Progress& progress) {
  if (c) fake_study().c = *c;
  fake_study().stress = options;
  called(c ? "stress of a case" : "stress", settings, progress);
  return {{}, {settings.out / "stress.html"}, {"All is flagged."}};
}

std::vector<SweepResponse> sweep_responses() { return {{"top_speed", "m/s", "speed"}}; }

SweepOutcome sweep(const Case& c, const SweepOptions& options, const RunSettings& settings, Progress& progress) {
  fake_study().sweep = options;
  fake_study().c = c;
  called("sweep", settings, progress);
  return {{}, {settings.out / "sweep.html"}, {"It depends most on nothing."}};
}

ElementOutcome element(const Case& c, const ElementStudy& study, const RunSettings& settings) {
  fake_study().element = study;
  fake_study().c = c;
  fake_study().calls.push_back("element");
  fake_study().settings = settings;
  return {{}, {settings.out / "element.html"}, {"It carries nothing."}};
}

}  // namespace pivnp::app

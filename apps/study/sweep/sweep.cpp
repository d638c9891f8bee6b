#include "apps/study/sweep/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include "apps/plot/files.hpp"
#include "apps/study/frontier/written_pages.hpp"
#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/sweep/plan.hpp"
#include "apps/study/sweep/responses.hpp"
#include "apps/study/sweep/runs.hpp"
#include "apps/study/sweep/sweep_pages.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/hash.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/core/version.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

SweepOptions checked(SweepOptions o) {
  if (o.vary.empty()) throw InputError("--vary: missing, expected KEY=VALUE,VALUE,... at least once");
  if (o.responses.empty()) o.responses = {"top_speed", "run_out"};
  if (o.fields.empty()) o.fields = {"displacement_magnitude"};
  for (const std::string& name : o.responses) {
    sweep_response(name);
    if (name.starts_with("difference.") && o.against.empty())
      throw InputError("--response " + name + ": no measurement is named; expected --against RECORD[:MOTION]");
  }
  if (!o.against.empty()) open_motion(o.against, {});
  for (const std::string& name : o.fields) derived_field(name);
  if (!o.zone_m.empty() && !(o.zone_m.size() == 4 && o.zone_m[0] < o.zone_m[2] && o.zone_m[1] < o.zone_m[3]))
    throw InputError("--zone: expected x0,y0,x1,y1 with x0 < x1 and y0 < y1");
  return o;
}

// What a run with these keys is; throws where the case does not take them.
Case case_with(const Case& c, const SweepOptions& options, const std::vector<std::string>& keys) {
  std::vector<std::string> given = options.given;
  given.insert(given.end(), keys.begin(), keys.end());
  return c.file.empty() ? parse_case(embedded_case_text(), "built-in case", c.folder, given) : read_case(c.file, given);
}

}  // namespace

SweepOutcome sweep(const Case& c, const SweepOptions& given, const RunSettings& settings, Progress& progress) {
  const SweepOptions options = checked(given);
  if (!c.mpm) throw InputError(of_file(c) + ": there is nothing to simulate; expected [mpm]");
  std::vector<Variation> variations;
  for (const std::string& text : options.vary) {
    variations.push_back(parse_variation(text));
    variations.back().own = value_in(c, variations.back().name());
  }
  SweepOutcome outcome;
  outcome.runs = plan_sweep(variations, options.grid);
  plot::make_folder(settings.out);
  const int threads = settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  const int at_once = std::clamp(options.jobs > 0 ? options.jobs : threads, 1, int(outcome.runs.size()));
  std::vector<SweepJob> jobs;
  std::vector<Case> cases;
  for (std::size_t k = 0; k < outcome.runs.size(); ++k) {
    SweepRun& run = outcome.runs[k];
    std::vector<std::string> keys = options.given;
    for (const std::string& key : keys_of(run, variations)) keys.push_back(key);
    cases.push_back(case_with(c, options, keys_of(run, variations)));
    run.folder = settings.out / "runs" / hexadecimal(hash64(build_info().commit + "\n" + write_case(cases.back())));
    run.kept = fs::exists(run.folder / "record.h5");
    if (run.kept) continue;
    // (Values that are written otherwise and mean the same make one run.)
    if (std::any_of(jobs.begin(), jobs.end(), [&](const SweepJob& job) { return job.folder == run.folder; })) continue;
    SweepJob job{{options.program.string(), "simulate"}, run.folder, run.label};
    if (!c.file.empty()) job.words.push_back(c.file.string());
    for (const std::string& key : keys) job.words.insert(job.words.end(), {"--set", key});
    job.words.insert(job.words.end(), {"--out", run.folder.string(), "--threads", std::to_string(std::max(1, threads / at_once))});
    if (fs::exists(run.folder / "parts")) job.words.push_back("--resume");
    jobs.push_back(std::move(job));
  }
  make_jobs(jobs, at_once, std::int64_t(outcome.runs.size() - jobs.size()), progress);
  for (SweepRun& run : outcome.runs)
    for (const SweepJob& job : jobs)
      if (job.folder == run.folder) run.failure = job.failure;
  for (std::size_t k = 0; k < outcome.runs.size(); ++k) {
    SweepRun& run = outcome.runs[k];
    if (run.failure.empty()) read_responses(cases[k], options, run, progress);
    else run.responses = run.uncertainties = std::vector<double>(options.responses.size(), std::numeric_limits<double>::quiet_NaN());
  }
  SweepPages pages = sweep_pages(c, options, variations, outcome.runs);
  outcome.files = write_pages(pages.document, "sweep", {{"sweep.csv", csv_of(options, variations, outcome.runs)}}, {table_of(options, variations, outcome.runs)}, settings.out);
  outcome.sentences = std::move(pages.sentences);
  return outcome;
}

}  // namespace pivnp::app

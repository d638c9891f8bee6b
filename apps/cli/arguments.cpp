#include "apps/cli/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>

#include "apps/cli/json.hpp"
#include "apps/cli/junit.hpp"
#include "apps/cli/signals.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

namespace {

// A folder stands for what the case names in it, if that is a pattern or is there; else for all its images.
std::string frames_path(const std::string& given, const Case& c) {
  std::error_code ignored;
  if (!fs::is_directory(given, ignored) || !c.frames) return given;
  const fs::path name = fs::path(c.frames->path).filename();
  const bool pattern = name.string().find_first_of("*?[%") != std::string::npos;
  return !name.empty() && (pattern || fs::exists(given / name, ignored)) ? (given / name).string() : given;
}

}  // namespace

TerminalProgress progress_for(const Session& session) {
  const ProgressStyle style = session.quiet             ? ProgressStyle::silent
                              : session.err_is_terminal ? ProgressStyle::bar
                                                        : ProgressStyle::lines;
  return TerminalProgress(session.err, style, stop_signalled);
}

void add_case(CLI::App& app, Arguments& arguments, const std::string& left_out) {
  app.add_option("CASE", arguments.case_path, "case file, or a folder with a case.toml (default: " + left_out + ")")
      ->check([](const std::string& given) {
        return given.empty() ? std::string("found an empty text, expected a file or a folder") : std::string();
      });
  add_given(app, arguments);
}

void add_given(CLI::App& app, Arguments& arguments) {
  app.add_option("--set", arguments.given,
                 "a key of the case that wins over the file's, as in --set piv.window_px=24 (may be repeated)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_out(CLI::App& app, Arguments& arguments, const std::string& fallback) {
  app.add_option("--out", arguments.out, "folder for the results (default: " + fallback + ")")->type_name("DIR");
}

void add_frames(CLI::App& app, Arguments& arguments) {
  app.add_option("--frames", arguments.frames,
                 "frames in place of the case's: glob (quoted), printf pattern, video file, or the folder that holds "
                 "the case's pattern")
      ->type_name("PATH");
}

void add_resume(CLI::App& app, Arguments& arguments) {
  app.add_flag("--resume", arguments.resume,
               "continue the interrupted or failed run in the output folder; of a finished record, simulate anew what other keys "
               "of the simulation ask for");
}

void add_force(CLI::App& app, Arguments& arguments) {
  app.add_flag("--force", arguments.force, "replace the finished record in the output folder");
}

void add_junit(CLI::App& app, Arguments& arguments) {
  app.add_option("--junit", arguments.junit, "writes the results of [compare.limits] as JUnit XML")->type_name("FILE");
}

void add_no_report(CLI::App& app, Arguments& arguments) {
  app.add_flag("--no-report", arguments.no_report, "the record alone: no report, no figures");
}

void add_json(CLI::App& app, Arguments& arguments) {
  app.add_flag("--json", arguments.json,
               "print the comparison as one JSON object: values, uncertainties, verdicts, limits, remarks");
}

void add_session(CLI::App& app, Session& session) {
  app.add_option("--threads", session.threads, "threads (default: all cores); results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  app.add_option("--simd", session.simd,
                 "instruction set of the kernels: avx3 (AVX-512), avx2 or sse2 (default: the best that the processor has); "
                 "results differ by round-off")
      ->type_name("SET");
  app.add_flag("--quiet", session.quiet, "no progress, no notes");
}

void print_notes(const Case& c, const Session& session) {
  if (session.quiet) return;
  for (const std::string& note : c.notes) session.err << "pivnp: note: " << note << std::endl;
}

Case load_case(const Arguments& arguments, const Session& session) {
  Case c = arguments.case_path.empty()
               ? parse_case(embedded_case_text(), "built-in case", fs::current_path(), arguments.given)
               : read_case(arguments.case_path, arguments.given, !arguments.frames.empty());
  print_notes(c, session);
  if (!arguments.frames.empty()) {
    if (!c.piv) c.piv.emplace();
    if (!c.np) c.np.emplace();
  }
  return c;
}

std::string title_of(const Case& c) { return c.file.empty() ? "built-in case" : c.file.string(); }

RunSettings settings_for(const Arguments& arguments, const Session& session, const Case& c, const fs::path& fallback) {
  RunSettings settings;
  settings.out = arguments.out.empty() ? fallback : fs::path(arguments.out);
  settings.resume = arguments.resume;
  settings.report = !arguments.no_report;
  settings.threads = session.threads;
  settings.command = session.typed;
  if (!arguments.frames.empty()) settings.frames = frames_path(arguments.frames, c);
  return settings;
}

fs::path default_out(const Case& c) { return fs::path("out") / short_name(c); }

int print_outcome(const RunOutcome& outcome, const Arguments& arguments, const std::string& name,
                  const Session& session, bool of_run) {
  const bool unusable = of_run && std::any_of(outcome.remarks.begin(), outcome.remarks.end(),
                                              [](const Remark& r) { return r.weight == RemarkWeight::unusable; });
  const int code = unusable ? 1 : any_exceeded(outcome.limits) ? 3 : 0;
  const auto line = [&](const std::string& text) {
    if (!arguments.json) session.out << text << "\n";
  };
  if (arguments.json) session.out << comparison_json(outcome, code);
  for (const fs::path& file : {outcome.record, outcome.report_html, outcome.report_pdf})
    if (!file.empty()) line(file.string());
  for (const Remark& remark : outcome.remarks)
    if (of_run && remark.weight == RemarkWeight::unusable) print_error(session.err, remark.text);
    else if (!session.quiet) line((remark.weight == RemarkWeight::note ? "note: " : "warning: ") + remark.text);
  if (const std::string cost = text_of(outcome.cost); !session.quiet && !cost.empty()) line("note: " + cost);
  VerifyResult limits;
  limits.name = name;
  for (const LimitResult& l : outcome.limits) {
    limits.items.push_back({"compare.limits." + l.key, l.limit, l.reached, l.met});
    if (l.met && session.quiet) continue;
    std::string text = "compare.limits." + l.key + ": " + std::string(name_of(l.fate())) + ": reached " + number(l.reached, 6) +
                       ", limit " + number(l.limit, 6);
    if (std::isfinite(l.within)) text += l.shown() ? "; within it with 95 %" : "; within " + number(l.within, 3) + " with 95 %";
    line(text);
  }
  if (!arguments.junit.empty()) {
    std::ofstream stream(arguments.junit, std::ios::binary);
    stream << junit_xml({limits}, "pivnp limits") << std::flush;
    if (!stream) throw RunError(arguments.junit + ": cannot be written");
    line(arguments.junit);
  }
  return code;
}

}  // namespace pivnp::app

// Commands on finished records: compare, report, query, export.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "apps/case/checks.hpp"
#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "apps/cli/option_flags.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/import_format.hpp"

namespace pivnp::app {

Action declare_compare(CLI::App& app, Session& session) {
  struct Compare {
    Arguments arguments;
    CompareSources sources;
    compare::CompareOptions options;
    compare::LimitOptions limits;
    Setters setters;
  };
  const auto c = std::make_shared<Compare>();
  app.add_option("FIRST", c->sources.first,
                 "the data set that is compared against: record, record:motion (np, mpm ...), or another program's results: "
                 "FORMAT=PATTERN with FORMAT " + io::formats_text(&io::FileFormat::motion) + "; or a curve: " +
                     io::formats_text(&io::FileFormat::curve) + "=FILE[:COLUMN], front=RECORD")
      ->required();
  app.add_option("SECOND", c->sources.second, "the data set that is compared with it, likewise")->required();
  app.add_option("--coarser", c->sources.coarser,
                 "the second on a coarser grid (twice: on one coarser still), for its numerical uncertainty")
      ->type_name("DATA")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--refinement", c->sources.refinement_ratio, "ratio of those grids' spacings (2)")
      ->type_name("RATIO")
      ->check(CLI::Range(1.01, 100.0));
  app.add_option("--step-s", c->sources.step_s,
                 "time from one file's number to the next, where files of another program state no times (1)")
      ->type_name("VALUE (s)")
      ->check(CLI::PositiveNumber);
  app.add_option("--length-unit", c->sources.length_unit,
                 "unit of lengths in another program's files (m); its name is compared with the other data set's")
      ->type_name("NAME");
  app.add_option("--case", c->arguments.case_path, "takes [compare] and [compare.limits] from a case; flags win")
      ->type_name("CASE");
  add_option_flags(app, c->options, c->setters);
  add_option_flags(app, c->limits, c->setters);
  add_set(app, c->setters, {keys_of("compare.limits", c->limits), keys_of("compare", c->options)});
  add_json(app, c->arguments);
  add_no_report(app, c->arguments);
  add_out(app, c->arguments, "out/compare");
  add_junit(app, c->arguments);
  add_session(app, session);
  std::string formats = "Formats of other programs (FORMAT=PATTERN):\n";
  for (const io::FileFormat& format : io::file_formats())
    if (format.motion() || format.curve()) formats += "  " + format.name + std::string(format.name.size() < 8 ? 8 - format.name.size() : 1, ' ') + format.files +
               ": " + format.text + "\n";
  app.footer(app.get_footer() + "\n" + formats);
  return [c, &session] {
    if (!c->arguments.case_path.empty()) {
      const Case given = read_case(c->arguments.case_path);
      print_notes(given, session);
      c->options = given.compare;
      c->limits = given.limits;
    }
    for (const auto& set : c->setters) set();
    RunOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      outcome = compare_records(c->sources, c->options, c->limits,
                                settings_for(c->arguments, session, {}, "out/compare"), progress);
    }
    return print_outcome(outcome, c->arguments, c->sources.first + " against " + c->sources.second, session);
  };
}

namespace {

// Keys of [report.line.NAME], of a line that the record's case has or of another.
KeySetter keys_of_lines(report::ReportOptions& options) {
  return [&options](const std::string& key, const std::string& text, std::vector<std::string>& known) {
    static const std::string prefix = "report.line.";
    const std::size_t dot = key.find('.', prefix.size());
    const bool of_line = key.starts_with(prefix) && dot != std::string::npos && dot > prefix.size();
    const std::string section = of_line ? key.substr(0, dot) : prefix + "NAME", name = of_line ? section.substr(prefix.size()) : "";
    report::LineOptions line;
    const auto held = std::find_if(options.lines.begin(), options.lines.end(), [&](const auto& item) { return item.first == name; });
    if (of_line && held != options.lines.end()) line = held->second;
    if (!keys_of(section, line)(key, text, known)) return false;
    if (held != options.lines.end()) held->second = line;
    else options.lines.emplace_back(name, line);
    return true;
  };
}

void require_lines(const report::ReportOptions& options) {
  for (const auto& [name, line] : options.lines)
    if (const std::optional<LineFault> fault = fault_of_line(name, line))
      throw InputError("--set report.line." + name + (fault->key.empty() ? "" : "." + fault->key) + ": " + fault->text);
}

}  // namespace

Action declare_report(CLI::App& app, Session& session) {
  struct Report {
    Arguments arguments;
    std::string record;
    report::ReportOptions options;
    Setters setters;
  };
  const auto r = std::make_shared<Report>();
  app.add_option("RECORD", r->record, "record.h5, or the folder that holds it")->required();
  add_out(app, r->arguments, "beside the record");
  add_frames(app, r->arguments);
  add_option_flags(app, r->options, r->setters, true);
  add_set(app, r->setters, {keys_of_lines(r->options), keys_of("report", r->options)});
  add_session(app, session);
  return [r, &session] {
    const auto change = [&r](report::ReportOptions& options) {
      r->options = options;
      for (const auto& set : r->setters) set();
      require_lines(r->options);
      options = r->options;
    };
    RunOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      outcome = report_record(r->record, settings_for(r->arguments, session, {}, ""), progress, change);
    }
    return print_outcome(outcome, r->arguments, r->record, session);
  };
}

Action declare_query(CLI::App& app, Session& session) {
  struct Query {
    std::string source;
    QueryOptions options;
    Setters setters;
  };
  const auto q = std::make_shared<Query>();
  app.add_option("RECORD", q->source, "record.h5 or its folder, with :MOTION where it holds several; or FORMAT=PATTERN, as in compare")->required();
  add_option_flags(app, q->options, q->setters, true);
  add_session(app, session);
  return [q, &session] {
    for (const auto& set : q->setters) set();
    session.out << query_motion(q->source, q->options) << std::flush;
    return 0;
  };
}

Action declare_export(CLI::App& app, Session& session) {
  struct Export {
    Arguments arguments;
    std::string record, format = "csv";
    io::ExportOptions options;
  };
  const auto e = std::make_shared<Export>();
  app.add_option("RECORD", e->record, "record.h5, or the folder that holds it")->required();
  app.add_option("--format", e->format, "csv: one table per motion, and one of the vectors; vtu: a .pvd per motion with a file per time, for ParaView; vtkhdf: one file per motion, for ParaView 5.12 (csv)")
      ->type_name("NAME")
      ->check(CLI::IsMember(choice_names<io::ExportFormat>()));
  app.add_option("--motions", e->options.motions, "motions to write, and piv for the vectors (all)")->type_name("NAMES")->delimiter(',');
  app.add_option("--fields", e->options.fields, "fields to write, by their names in docs/format.md (displacement and strain)")
      ->type_name("NAMES")
      ->delimiter(',');
  app.add_option("--times", e->options.times, "times to write; the nearest recorded ones are taken (all)")->type_name("VALUES")->delimiter(',');
  add_out(app, e->arguments, "export/ beside the record");
  add_session(app, session);
  return [e, &session] {
    for (const std::filesystem::path& file : export_record(e->record, e->arguments.out, *value_named<io::ExportFormat>(e->format), e->options))
      session.out << file.string() << "\n";
    return 0;
  };
}

}  // namespace pivnp::app

// Commands on finished records: compare, report.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "apps/cli/option_flags.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

Action declare_compare(CLI::App& app, Session& session) {
  struct Compare {
    Arguments arguments;
    std::string first, second;
    compare::CompareOptions options;
    compare::LimitOptions limits;
    Setters setters;
  };
  const auto c = std::make_shared<Compare>();
  app.add_option("FIRST", c->first, "record, or record:motion (np, mpm ...): the side that is judged against")
      ->required();
  app.add_option("SECOND", c->second, "record, or record:motion: the side that is judged")->required();
  app.add_option("--case", c->arguments.case_path, "takes [compare] and [compare.limits] from a case; flags win")
      ->type_name("CASE");
  add_option_flags(app, c->options, c->setters);
  add_option_flags(app, c->limits, c->setters);
  add_out(app, c->arguments, "out/compare");
  add_session(app, session);
  return [c, &session] {
    if (!c->arguments.case_path.empty()) {
      const Case given = read_case(c->arguments.case_path);
      c->options = given.compare;
      c->limits = given.limits;
    }
    for (const auto& set : c->setters) set();
    RunOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      outcome = compare_records(c->first, c->second, c->options, c->limits,
                                settings_for(c->arguments, session, {}, "out/compare"), progress);
    }
    return print_outcome(outcome, session);
  };
}

Action declare_report(CLI::App& app, Session& session) {
  struct Report {
    Arguments arguments;
    std::string record;
  };
  const auto r = std::make_shared<Report>();
  app.add_option("RECORD", r->record, "record.h5, or the folder that holds it")->required();
  add_out(app, r->arguments, "beside the record");
  add_frames(app, r->arguments);
  add_session(app, session);
  return [r, &session] {
    RunOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      outcome = report_record(r->record, settings_for(r->arguments, session, {}, ""), progress);
    }
    return print_outcome(outcome, session);
  };
}

}  // namespace pivnp::app

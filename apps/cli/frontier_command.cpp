// pivnp frontier: speed against accuracy.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>

#include "apps/case/values.hpp"
#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "apps/study/frontier/frontier.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

// The case, or one of nothing but frames; none: drawn texture.
std::optional<Case> scene(const Arguments& arguments, const Session& session) {
  if (!arguments.case_path.empty()) return load_case(arguments, session);
  if (!arguments.frames.empty())
    return parse_case("[frames]\npath = " + toml_text(arguments.frames) + "\n", "--frames", std::filesystem::current_path(), arguments.given);
  if (!arguments.given.empty()) throw InputError("--set: given without a case, expected CASE or --frames");
  return std::nullopt;
}

}  // namespace

Action declare_frontier(CLI::App& app, Session& session) {
  struct Frontier {
    Arguments arguments;
    FrontierOptions options;
    std::vector<std::string> stages;
  };
  const auto f = std::make_shared<Frontier>();
  add_case(app, f->arguments, "image correlation on drawn texture, or on --frames");
  add_out(app, f->arguments, "out/frontier, or out/<name of the case's folder>/frontier");
  add_frames(app, f->arguments);
  app.add_option("--stages", f->stages, "what is measured: piv, mpm (left out: all that the case has)")
      ->type_name("STAGE,...")
      ->delimiter(',')
      ->check(CLI::IsMember({"piv", "mpm"}));
  app.add_option("--repeats", f->options.repeats, "times that each pair of frames is measured by each setting (3)")
      ->type_name("N")
      ->check(CLI::Range(1, 100));
  add_session(app, session);
  return [f, &session] {
    const auto asked = [&](const char* stage) {
      return f->stages.empty() || std::find(f->stages.begin(), f->stages.end(), stage) != f->stages.end();
    };
    f->options.piv = asked("piv");
    f->options.mpm = asked("mpm");
    const std::optional<Case> c = scene(f->arguments, session);
    FrontierOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      const std::filesystem::path fallback = f->arguments.case_path.empty() ? "out/frontier" : default_out(*c) / "frontier";
      outcome = frontier(c ? &*c : nullptr, f->options, settings_for(f->arguments, session, c ? *c : Case{}, fallback), progress);
    }
    for (const std::filesystem::path& file : outcome.files) session.out << file.string() << "\n";
    for (const std::string& sentence : outcome.sentences) session.out << sentence << "\n";
    if (!session.quiet)
      for (const std::string& remark : outcome.remarks) session.out << "note: " << remark << "\n";
    return 0;
  };
}

}  // namespace pivnp::app

// Commands on a case: run and its parts, init, check, synth.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <memory>
#include <ostream>

#include "apps/case/init.hpp"
#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

namespace {

// What a stage needs and the case, together with the command line, does not give.
void demand(const Case& c, const Arguments& arguments, Stages stages) {
  const bool named = c.frames && !c.frames->path.empty();
  const bool images = named || c.synth || !arguments.frames.empty();
  if (c.frames && !images && stages != Stages::simulate)
    throw InputError(title_of(c) + ": frames.path: missing; expected it in the case, or --frames PATH");
  const bool measures = images || c.vectors;
  if ((stages == Stages::piv || stages == Stages::track) && !measures)
    throw InputError(title_of(c) + ": there are no frames to measure; expected [frames], [vectors], [synth] or --frames PATH");
  if (stages == Stages::simulate && !c.mpm)
    throw InputError(title_of(c) + ": there is nothing to simulate; expected [mpm]");
  if (stages != Stages::all) return;
  if (!measures && !c.mpm)
    throw InputError(title_of(c) + ": there is nothing to do; expected [frames], [vectors], [synth], [mpm] or --frames PATH");
  if (c.limits.any() && !(measures && c.mpm))
    throw InputError(title_of(c) + ": [compare.limits]: given, but nothing is compared; expected frames and [mpm]");
}

// A finished record is hours of work: it is not replaced unasked.
void spare_record(const fs::path& out) {
  std::error_code ignored;
  if (!fs::exists(out / "record.h5", ignored) || fs::exists(out / "parts", ignored)) return;
  throw InputError((out / "record.h5").string() + ": is there already; --force replaces it, --resume goes on from it, --out DIR writes elsewhere");
}

Action declare_stages(CLI::App& app, Session& session, Stages stages) {
  const auto arguments = std::make_shared<Arguments>();
  add_case(app, *arguments);
  add_out(app, *arguments, "out/<name of the case's folder>");
  add_frames(app, *arguments);
  add_resume(app, *arguments);
  add_force(app, *arguments);
  if (stages == Stages::all) add_junit(app, *arguments);
  if (stages == Stages::all) add_json(app, *arguments);
  add_no_report(app, *arguments);
  add_session(app, session);
  return [arguments, stages, &session] {
    const Case c = load_case(*arguments, session);
    demand(c, *arguments, stages);
    const RunSettings settings = settings_for(*arguments, session, c, default_out(c));
    if (!arguments->resume && !arguments->force) spare_record(settings.out);
    RunOutcome outcome;
    {
      TerminalProgress progress = progress_for(session);
      outcome = run_case(c, settings, stages, progress);
    }
    return print_outcome(outcome, *arguments, c.name, session, true);
  };
}

// The JSON schema of cases that lies with this program; empty: the program was copied without it.
std::string schema_file() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  const fs::path schema = program.parent_path().parent_path() / "share" / "pivnp" / "case.schema.json";
  return fs::exists(schema, failed) ? schema.string() : "";
}

// Where a case that is printed comes to lie: the folder of the file that takes the output, else the one the user is in.
fs::path folder_of_output(const Session& session) {
  std::error_code failed;
  const fs::path file = &session.out == &std::cout ? fs::read_symlink("/proc/self/fd/1", failed) : fs::path();
  return fs::is_regular_file(file, failed) ? file.parent_path() : fs::current_path();
}

// Writes a file that does not exist yet, unless `force`.
void write_new(const fs::path& file, const std::string& text, bool force) {
  if (!force && fs::exists(file)) throw InputError(file.string() + ": is there already; --force replaces it");
  fs::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw RunError(file.string() + ": cannot be written");
}

}  // namespace

Action declare_run(CLI::App& app, Session& session) { return declare_stages(app, session, Stages::all); }
Action declare_piv(CLI::App& app, Session& session) { return declare_stages(app, session, Stages::piv); }
Action declare_track(CLI::App& app, Session& session) { return declare_stages(app, session, Stages::track); }
Action declare_simulate(CLI::App& app, Session& session) { return declare_stages(app, session, Stages::simulate); }

Action declare_init(CLI::App& app, Session& session) {
  struct Init {
    std::vector<std::string> frames;
    std::string out;
    InitOptions options;
    bool force = false;
  };
  const auto init = std::make_shared<Init>();
  app.add_option("FRAMES", init->frames, "glob (quoted), printf pattern, folder or video file")->required();
  app.add_option("--metres-per-pixel", init->options.metres_per_pixel, "scale, if it is known")
      ->check(CLI::PositiveNumber);
  app.add_option("--rate-hz", init->options.rate_hz, "frames per second of the recording")->check(CLI::PositiveNumber);
  app.add_option("--out", init->out, "writes DIR/case.toml (default: the case is printed)")->type_name("DIR");
  app.add_flag("--all", init->options.all, "all keys of measurement and simulation, as comments");
  app.add_flag("--force", init->force, "replace a case.toml that is there");
  add_session(app, session);
  return [init, &session] {
    if (init->frames.size() > 1)
      throw InputError("FRAMES: found " + std::to_string(init->frames.size()) +
                       " files, expected one pattern; quote it, as in '" +
                       (fs::path(init->frames[0]).parent_path() / "*").string() +
                       fs::path(init->frames[0]).extension().string() + "'");
    InitOptions options = init->options;
    const fs::path file = fs::path(init->out) / "case.toml";
    options.frames = init->frames[0];
    options.schema = schema_file();
    options.folder = init->out.empty() ? folder_of_output(session) : fs::path(init->out);
    const std::string text = init_case(options);
    if (init->out.empty()) {
      session.out << text;
    } else {
      write_new(file, text, init->force);
      session.out << file.string() << "\n";
      if (!session.quiet) session.out << "note: edit its region, then: pivnp check " << file.string() << "\n";
    }
    return 0;
  };
}

Action declare_check(CLI::App& app, Session& session) {
  const auto arguments = std::make_shared<Arguments>();
  add_case(app, *arguments);
  add_out(app, *arguments, "out/<name of the case's folder>");
  add_frames(app, *arguments);
  add_session(app, session);
  return [arguments, &session] {
    const Case c = load_case(*arguments, session);
    demand(c, *arguments, Stages::all);
    CheckOutcome checked;
    if (c.frames || c.vectors || c.synth || c.mpm || !arguments->frames.empty()) {
      TerminalProgress progress = progress_for(session);
      checked = check_case(c, settings_for(*arguments, session, c, default_out(c)), progress);
    }
    session.out << title_of(c) << ": valid\n";
    if (!checked.picture.empty()) session.out << checked.picture.string() << "\n";
    if (!session.quiet)
      for (const std::string& remark : checked.remarks) session.out << "note: " << remark << "\n";
    return 0;
  };
}

Action declare_synth(CLI::App& app, Session& session) {
  const auto arguments = std::make_shared<Arguments>();
  add_case(app, *arguments);
  add_out(app, *arguments, "out/<name of the case's folder>");
  add_session(app, session);
  return [arguments, &session] {
    const Case c = load_case(*arguments, session);
    if (!c.synth) throw InputError(title_of(c) + ": there is nothing to draw; expected [synth]");
    const RunSettings settings = settings_for(*arguments, session, c, default_out(c));
    {
      TerminalProgress progress = progress_for(session);
      synthesize(c, settings, progress);
    }
    session.out << (settings.out / "frames").string() << "\n"
                << (settings.out / "truth" / "record.h5").string() << "\n";
    return 0;
  };
}

}  // namespace pivnp::app

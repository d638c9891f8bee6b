// Options that several commands have in common, and what they come to.
#pragma once

#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/cli/session.hpp"
#include "apps/study/study.hpp"

namespace CLI {
class App;
}

namespace pivnp::app {

struct Arguments {
  std::string case_path;  // empty: the embedded case
  std::string out;        // empty: the command's default
  std::string frames;     // empty: the case's
  std::vector<std::string> given;  // keys of the case, "piv.window_px=24" each, that win over the file's
  bool resume = false;
  bool force = false;     // replace a finished record
  bool no_report = false;
  bool json = false;      // the comparison as JSON in place of the usual lines
  std::string junit;      // file for the limits' verdicts; empty: none
};

/// `left_out`: what is taken where no case is given.
void add_case(CLI::App& app, Arguments& arguments, const std::string& left_out = "the built-in slope behind a gate");
void add_out(CLI::App& app, Arguments& arguments, const std::string& fallback);
void add_frames(CLI::App& app, Arguments& arguments);
void add_resume(CLI::App& app, Arguments& arguments);
void add_force(CLI::App& app, Arguments& arguments);
void add_junit(CLI::App& app, Arguments& arguments);
void add_no_report(CLI::App& app, Arguments& arguments);
void add_json(CLI::App& app, Arguments& arguments);
/// Keys for every case that a command reads.
void add_given(CLI::App& app, Arguments& arguments);

/// --threads, --simd and --quiet, which every command takes.
void add_session(CLI::App& app, Session& session);

/// The case named, or the embedded one. Given frames bring the measuring stages with them.
Case load_case(const Arguments& arguments, const Session& session);

/// What reading a case has to say, unless --quiet.
void print_notes(const Case& c, const Session& session);

/// What messages call a case: its file, or what it is.
std::string title_of(const Case& c);

/// Settings of a run; `fallback` is the output folder where none is given. A folder given as --frames stands for the
/// case's own pattern in that folder, if the case has one.
RunSettings settings_for(const Arguments& arguments, const Session& session, const Case& c,
                         const std::filesystem::path& fallback);

/// "out/<name>".
std::filesystem::path default_out(const Case& c);

/// Prints where the results are, what was flagged and which limits were met or exceeded, and writes the JUnit XML that
/// was asked for. Gives the exit code: 0; 3 if a limit was exceeded; 1 if it is that `of_run` whose result is not usable,
/// which is an error.
int print_outcome(const RunOutcome& outcome, const Arguments& arguments, const std::string& name,
                  const Session& session, bool of_run = false);

}  // namespace pivnp::app

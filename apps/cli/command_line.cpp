#include "apps/cli/command_line.hpp"

#include <omp.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <new>
#include <ostream>

#include "apps/cli/arguments.hpp"
#include "apps/cli/commands.hpp"
#include "apps/cli/session.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/instruction_set.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/core/version.hpp"

namespace pivnp::app {

namespace {

constexpr int success = 0, failed = 1, bad_input = 2, interrupted = 130;

// The command line as a shell would take it again.
std::string quoted(int argc, const char* const* argv) {
  std::string typed;
  for (int k = 0; k < argc; ++k) {
    const std::string word = k == 0 ? std::filesystem::path(argv[0]).filename().string() : printable(argv[k]);
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                            "0123456789_-+=./:,@%") == std::string::npos;
    std::string shown = word;
    if (!plain) {
      shown = "'";
      for (const char c : word) shown += c == '\'' ? std::string("'\\''") : std::string(1, c);
      shown += "'";
    }
    typed += (k ? " " : "") + shown;
  }
  return typed;
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text)
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  return printable(text);
}

// However long the names are that a message quotes.
std::string bounded(const std::string& line) {
  constexpr std::size_t most = 2000, end = 400;
  return line.size() <= most ? line : line.substr(0, most - end) + " ... " + line.substr(line.size() - end);
}

std::string indented(std::string_view lines) {
  std::string text = "  ";
  for (const char c : lines) text += c == '\n' ? std::string("\n  ") : std::string(1, c);
  return text;
}

// The word that should be a command: the first that is no option, nor the value of one of the program's own.
std::string command_word(int argc, const char* const* argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--threads" || word == "--simd") {
      ++k;
    } else if (!word.starts_with("-")) {
      return word;
    }
  }
  return "";
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.emplace_back(command.name);
  return names;
}

// What is wrong with a command line that did not parse, in one line.
std::string usage_error(const CLI::App& app, const CLI::App* command, const CLI::ParseError& error) {
  const std::string name = command ? "pivnp " + command->get_name() : "pivnp";
  const std::string hint = " (see '" + name + " --help')";
  for (const std::string& word : app.remaining(true)) {
    if (!word.starts_with("-")) continue;
    std::vector<std::string> known;
    for (const CLI::Option* option : (command ? *command : app).get_options())
      for (const std::string& long_name : option->get_lnames()) known.push_back("--" + long_name);
    const std::string given = word.substr(0, word.find('='));
    return "unknown option '" + given + "'" + did_you_mean(given, known) + hint;
  }
  return one_line(error.what()) + hint;
}

void describe(CLI::App& app) {
  app.set_help_flag("-h,--help", "this text");
  app.get_formatter()->column_width(34);
}

// No more than there are processors, whatever is asked for (OMP_NUM_THREADS too): they would wait for one another, and
// a million cannot be had.
void use_threads(Session& session) {
  const int processors = std::max(1, omp_get_num_procs());
  static const int all = std::min(omp_get_max_threads(), processors);
  session.threads = std::min(session.threads, processors);
  omp_set_num_threads(session.threads > 0 ? session.threads : all);  // for the engines that take no number of their own
}

int parse_and_run(int argc, const char* const* argv, Session& session) {
  CLI::App app{
      "From lab video to verdict: PIV, numerical particles (PIV-NP), MPM on the same grid, and their comparison.",
      "pivnp"};
  describe(app);
  app.set_version_flag("--version", "pivnp " + build_info().version + " (" + build_info().commit + ")",
                       "the program's version and commit");
  app.require_subcommand(1);
  add_session(app, session);
  std::string examples = "Examples:\n";
  std::vector<std::pair<CLI::App*, Action>> actions;
  for (const Command& command : commands()) {
    CLI::App* sub = app.add_subcommand(std::string(command.name), std::string(command.text));
    describe(*sub);
    sub->footer("Examples:\n" + indented(command.example));
    examples += indented(command.example.substr(0, command.example.find('\n'))) + "\n";
    actions.emplace_back(sub, command.declare(*sub, session));
  }
  app.footer(examples +
             "\n'pivnp COMMAND --help' tells more. Exit codes: 0 done, 1 failed while running, 2 bad usage or "
             "input,\n3 done but a stated limit was exceeded, 130 interrupted.");

  const std::string word = command_word(argc, argv);
  const std::vector<std::string> names = command_names();
  if (!word.empty() && std::find(names.begin(), names.end(), word) == names.end()) {
    print_error(session.err, "unknown command '" + word + "'" + did_you_mean(word, names) + " (see 'pivnp --help')");
    return bad_input;
  }
  const auto chosen = [&] {
    return std::find_if(actions.begin(), actions.end(), [](const auto& a) { return a.first->parsed(); });
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error, session.out, session.err);  // --help, --version
    const auto at = chosen();
    const bool nothing = word.empty() && app.remaining(true).empty() && dynamic_cast<const CLI::RequiredError*>(&error);
    print_error(session.err, nothing ? "no command is given ('pivnp --help' lists them)"
                                     : usage_error(app, at == actions.end() ? nullptr : at->first, error));
    return bad_input;
  }
  const auto at = chosen();
  use_threads(session);
  use_instruction_set(session.simd, "--simd");
  try {
    return at->second();
  } catch (const Interrupted&) {
    const bool resumable = at->first->get_option_no_throw("--resume") != nullptr;
    session.err << "pivnp: interrupted" << (resumable ? "; what was finished is kept, --resume continues from there" : "")
                << std::endl;
    return interrupted;
  }
}

int guarded(int argc, const char* const* argv, Session& session) {
  try {
    return parse_and_run(argc, argv, session);
  } catch (const InputError& error) {
    print_error(session.err, error.what());
    return bad_input;
  } catch (const std::filesystem::filesystem_error& error) {
    print_error(session.err, error.path1().string() + ": " + error.code().message());
    // A name that no file can have is given, not met.
    const bool named = error.code() == std::errc::filename_too_long || error.code() == std::errc::too_many_symbolic_link_levels;
    return named ? bad_input : failed;
  } catch (const std::bad_alloc&) {
    print_error(session.err, "out of memory");
  } catch (const std::exception& error) {  // RunError, the file system's and what libraries throw
    print_error(session.err, error.what());
  } catch (...) {
    print_error(session.err, "an unknown failure");
  }
  return failed;
}

}  // namespace

void print_error(std::ostream& err, const std::string& what) {
  err << "pivnp: error: " << bounded(one_line(what)) << std::endl;
}

int run_command_line(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal) {
  Session session{out, err, err_is_terminal, 0, "", false, quoted(argc, argv)};
  const int code = guarded(argc, argv, session);
  out.flush();
  if (out) return code;
  print_error(err, "standard output cannot be written");
  return code == success ? failed : code;
}

}  // namespace pivnp::app

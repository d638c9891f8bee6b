// The table of commands. Each declares its options and returns what to do once they are read: one call of a library
// function, and the printing of what it returned.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace pivnp::app {

struct Session;

using Action = std::function<int()>;  // gives the exit code

struct Command {
  std::string_view name;
  std::string_view text;     // one line, no full stop
  std::string_view example;  // command lines, one each
  Action (*declare)(CLI::App& app, Session& session);
};

/// Commands that work, in the order of the help.
const std::vector<Command>& commands();

// On cases (case_commands.cpp).
Action declare_run(CLI::App& app, Session& session);
Action declare_init(CLI::App& app, Session& session);
Action declare_check(CLI::App& app, Session& session);
Action declare_piv(CLI::App& app, Session& session);
Action declare_track(CLI::App& app, Session& session);
Action declare_simulate(CLI::App& app, Session& session);
Action declare_synth(CLI::App& app, Session& session);

// Speed against accuracy, where methods fail, and what a law does (chart_commands.cpp).
Action declare_frontier(CLI::App& app, Session& session);
Action declare_stress(CLI::App& app, Session& session);
Action declare_sweep(CLI::App& app, Session& session);
Action declare_element(CLI::App& app, Session& session);

// The window, which is a program of its own (view_command.cpp).
Action declare_view(CLI::App& app, Session& session);

// On pictures of a calibration board (camera_commands.cpp).
Action declare_calibrate(CLI::App& app, Session& session);

// On finished records, and on many cases (record_commands.cpp, verify_command.cpp).
Action declare_compare(CLI::App& app, Session& session);
Action declare_report(CLI::App& app, Session& session);
Action declare_query(CLI::App& app, Session& session);
Action declare_export(CLI::App& app, Session& session);
Action declare_verify(CLI::App& app, Session& session);

}  // namespace pivnp::app

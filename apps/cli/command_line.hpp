// The program without its main(): reads the command line, runs the command, turns failures into exit codes.
#pragma once

#include <iosfwd>

namespace pivnp::app {

/// Exit codes: 0 done; 1 failed while running; 2 bad usage or input; 3 done, but a stated limit was exceeded; 130
/// interrupted. Every failure is one line on `err`, "pivnp: error: ...". `err_is_terminal` chooses how progress shows.
int run_command_line(int argc, const char* const* argv, std::ostream& out, std::ostream& err, bool err_is_terminal);

}  // namespace pivnp::app

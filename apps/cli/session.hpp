// What all commands share: where they write, and what was asked of the program as a whole.
#pragma once

#include <iosfwd>
#include <string>

#include "apps/cli/terminal_progress.hpp"

namespace pivnp::app {

struct Session {
  std::ostream& out;  // results
  std::ostream& err;  // progress and errors
  bool err_is_terminal = false;
  int threads = 0;  // 0: all cores
  std::string simd;  // instruction set of the kernels; empty: the best one
  bool quiet = false;
  std::string typed;  // the command line, quoted for a shell
};

/// "pivnp: error: ..." as one line, however long the names are that it quotes.
void print_error(std::ostream& err, const std::string& what);

/// The progress display that suits the session.
TerminalProgress progress_for(const Session& session);

}  // namespace pivnp::app

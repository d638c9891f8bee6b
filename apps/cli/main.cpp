#include <unistd.h>

#include <iostream>

#include "apps/cli/command_line.hpp"
#include "apps/cli/signals.hpp"

int main(int argc, char** argv) {
  pivnp::app::install_signal_handlers();
  return pivnp::app::run_command_line(argc, argv, std::cout, std::cerr, isatty(STDERR_FILENO) == 1);
}

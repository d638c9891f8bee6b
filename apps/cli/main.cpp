#include <fcntl.h>
#include <sys/auxv.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <iostream>

#include "apps/cli/command_line.hpp"
#include "apps/cli/signals.hpp"

namespace {

// Where a thread waits for others, libgomp has it spin for milliseconds. On processors that have other work as well it
// keeps those from running that it waits for: a measurement beside other jobs took six times as long. A thousand turns
// outlast the barriers of a step on idle processors, and no longer. libgomp reads the number before main() begins, so
// the program starts itself anew; where that fails it goes on as it is.
void wait_briefly(char** argv) {
  if (std::getenv("GOMP_SPINCOUNT") || std::getenv("OMP_WAIT_POLICY")) return;
  if (getauxval(AT_BASE) == 0) return;  // the loader itself was called, with this program as its argument
  std::array<char, 4096> program{};
  const ssize_t length = readlink("/proc/self/exe", program.data(), program.size() - 1);  // `ps` would show "exe"
  if (length <= 0 || setenv("GOMP_SPINCOUNT", "1000", 0) != 0) return;
  execv(program.data(), argv);
}

// Where standard input, output or error is closed, the next file that is opened would take its place and get what is
// meant for it. Reading gives nothing, and writing fails as before.
void occupy_standard_descriptors() {
  int descriptor = 0;
  while (descriptor >= 0 && descriptor <= STDERR_FILENO) descriptor = open("/dev/null", O_RDONLY);
  if (descriptor > STDERR_FILENO) close(descriptor);
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_descriptors();
  if (argc > 2) wait_briefly(argv);  // a command and what it works on
  pivnp::app::install_signal_handlers();
  return pivnp::app::run_command_line(argc, argv, std::cout, std::cerr, isatty(STDERR_FILENO) == 1);
}

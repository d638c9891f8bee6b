// Command view: hands over to the program that has the window. This one knows no widgets and needs no display.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "apps/cli/commands.hpp"
#include "apps/cli/session.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

Action declare_view(CLI::App& app, Session&) {
  const auto opened = std::make_shared<std::string>();
  app.add_option("PATH", *opened, "a case, a record, a folder of frames, a video (default: nothing is open)");
  const auto threads = std::make_shared<int>(0);
  app.add_option("--threads", *threads, "threads of the window and of its runs (default: all cores); results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  return [opened, threads]() -> int {
    std::error_code failed;
    const std::filesystem::path window = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path() / "pivnp-view";
    if (!std::filesystem::exists(window, failed))
      throw InputError(window.string() + ": the window is not installed; expected the package pivnp-view");
    if (*threads > 0) setenv("OMP_NUM_THREADS", std::to_string(*threads).c_str(), 1);
    std::string program = window.string();
    char* const words[] = {program.data(), opened->empty() ? nullptr : opened->data(), nullptr};
    execv(program.c_str(), words);
    throw RunError(program + ": cannot be started: " + std::strerror(errno));
  };
}

}  // namespace pivnp::app

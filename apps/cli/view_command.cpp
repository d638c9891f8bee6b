// Command view: hands over to the program that has the window. This one knows no widgets and needs no display.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#include "apps/cli/commands.hpp"
#include "apps/cli/session.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

Action declare_view(CLI::App& app, Session&) {
  const auto opened = std::make_shared<std::string>();
  app.add_option("PATH", *opened, "a case, a record, a folder of frames, a video (left out: nothing is open)");
  return [opened] {
    std::error_code failed;
    const std::filesystem::path window = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path() / "pivnp-view";
    if (!std::filesystem::exists(window, failed))
      throw InputError(window.string() + ": the window is not installed; expected the package pivnp-view");
    std::string program = window.string();
    char* const words[] = {program.data(), opened->empty() ? nullptr : opened->data(), nullptr};
    execv(program.c_str(), words);
    throw RunError(program + ": cannot be started: " + std::strerror(errno));
    return 0;
  };
}

}  // namespace pivnp::app

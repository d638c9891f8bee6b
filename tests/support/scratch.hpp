// A fresh folder for a test's files, removed at the end. Its name holds a space, as users' folders do.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace pivnp::test {

struct Scratch {
  std::filesystem::path path;

  explicit Scratch(const char* prefix = "pivnp test ") {
    std::string name = (std::filesystem::temp_directory_path() / prefix).string() + "XXXXXX";
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder can be made in " + name);
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
};

}  // namespace pivnp::test

// A first case for given frames: commented TOML to be edited by the one who knows the experiment.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace pivnp::app {

struct InitOptions {
  std::string frames;                  // as given: glob, printf pattern or video; relative to the current folder
  std::filesystem::path folder = ".";  // where the case will lie: paths in it are relative to this
  std::optional<double> metres_per_pixel;
  std::optional<double> rate_hz;
  bool all = false;         // all keys, as comments; else those that a user needs
  std::string schema = {};  // path of the case's JSON schema, for editors; empty: not named
};

/// What the frames themselves say.
struct FrameFacts {
  int width = 0, height = 0;
  std::size_t count = 0;
  std::optional<double> rate_hz;  // a container's claim
};

/// The case's text. It reads back as it is, with one region that spans the middle of the image; `facts` fill in sizes.
std::string initial_case(const InitOptions& options, const FrameFacts& facts);

/// The same, opening the frames to learn the facts. Throws InputError if they cannot be opened.
std::string init_case(const InitOptions& options);

}  // namespace pivnp::app

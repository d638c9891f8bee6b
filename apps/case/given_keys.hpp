// Keys of a case that are given beside its file, on a command line: "piv.window_px=24".
#pragma once

#include <string>
#include <vector>

#include "apps/case/document.hpp"

namespace pivnp::app {

struct GivenKey {
  std::vector<std::string> path;  // "piv", "window_px"
  Node value;                     // its line: which of the keys given, counted from 1
};

/// "KEY=VALUE" with a dotted key; the value is TOML where it reads as TOML, else a text. Throws InputError.
GivenKey parse_given_key(const std::string& text, int ordinal);

/// A case that holds this key and no other, with the key's ordinal for a line.
Node alone(const GivenKey& key);

/// Puts the key into the case `root` of file `name`, in place of what it had; it takes over the line of that. Throws InputError
/// where a part of the key is no section there.
void put(const GivenKey& key, Node& root, const std::string& name);

}  // namespace pivnp::app

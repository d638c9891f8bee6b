// The kinds of failure that leave the program. (A bad vector or a lost particle is not one: it is data with a status.)
#pragma once

#include <stdexcept>
#include <string>

namespace pivnp {

/// Bad input or usage: the message is one line that names the place (file, line or key), what was found and what was
/// expected. The program ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that failed for a reason outside the input (disk full, a solver that blew up). Exit code 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user stopped the run (Ctrl-C). What was closed is intact. Exit code 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace pivnp

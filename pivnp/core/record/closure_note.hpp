// What closing chains of steps with direct pairs said of a sequence's vectors.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace pivnp {

struct ClosureNote {
  std::string verdict = "not checked";     // "agrees", "repeated error", "not checked: " and why
  std::vector<std::array<int, 2>> chains;  // first and last frame of each
  // Mean ratio of the repeated error's variance to that estimate's standard error, and what it must pass to be believed.
  double strength = 0, threshold = 0;
  // Covariance (uu, vv, uv; length^2) of the error that every pair repeats at a node, [ny][nx]; empty unless found. It
  // comes on top of a vector's own covariance, and adds up along a path as one error, not as independent ones.
  std::vector<std::array<float, 3>> repeated;
  std::string cause;  // as far as it can be told, in words; not in records
};

}  // namespace pivnp

// One sentence or two that a run says of its data.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pivnp {

enum class RemarkWeight : std::uint8_t {
  note = 0,      // how it was done
  doubt = 1,     // part of the result may be wrong
  unusable = 2,  // there is no result
};

inline constexpr std::array remark_weights{RemarkWeight::unusable, RemarkWeight::doubt, RemarkWeight::note};  // the gravest first
inline std::string name_of(RemarkWeight weight) {
  return weight == RemarkWeight::note ? "note" : weight == RemarkWeight::doubt ? "doubt" : "unusable";
}

struct Remark {
  std::string text;
  RemarkWeight weight = RemarkWeight::note;
  std::string id = {};  // of a row of the registry of remarks; empty: of the run itself
};

}  // namespace pivnp

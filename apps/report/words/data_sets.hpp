// What a report calls its two sides.
#pragma once

#include <string>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// True where nothing says that the first side was measured and the second simulated: two histories; two motions, the
/// first not called np or the second likewise, of which both know their error, or neither does, or the second only.
bool like_with_like(const Content& content);

/// `text`, written of a measurement and a simulation, in the words that fit: unchanged, or of a first and a second.
std::string in_sides(const Content& content, std::string text);

}  // namespace pivnp::report

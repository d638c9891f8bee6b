#include "apps/report/words/data_sets.hpp"

#include <array>
#include <utility>

namespace pivnp::report {

namespace {

bool knows_its_error(const MotionSource& motion) {
  return !motion.times().empty() && !motion.frame(motion.times().size() - 1).cov_u.empty();
}

// Longer phrases before the words they hold.
constexpr std::array<std::pair<const char*, const char*>, 12> neutral{{
    {"Simulation and measurement were compared", "Two motions were compared"},
    {"Simulation and measurement are not", "They are not"},
    {"Measurement and simulation compared", "Two motions compared"},
    {"The measurement\u2019s uncertainty is", "Their uncertainty is"},
    {"the measurement\u2019s", "the first\u2019s"},
    {"measurement\u2019s own", "the first\u2019s own"},
    {"the measurement's", "the first's"},
    {"the measurement is not what limits the comparison", "their uncertainty is not what limits the comparison"},
    {"the measurement itself", "the first itself"},
    {"the measurement", "the first"},
    {"The measurement", "The first"},
    {"the simulation", "the second"},
}};
constexpr std::array<std::pair<const char*, const char*>, 4> words{
    {{"Measured", "First"}, {"measured", "first"}, {"Simulated", "Second"}, {"simulated", "second"}}};

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

}  // namespace

bool like_with_like(const Content& content) {
  if (!content.comparison) return false;
  if (!content.measured || !content.simulated) return !content.measured && !content.simulated;
  if (content.measured->name() == "np" && !content.simulated->name().starts_with("np")) return false;
  return !knows_its_error(*content.measured) || knows_its_error(*content.simulated);
}

std::string in_sides(const Content& content, std::string text) {
  if (!like_with_like(content)) return text;
  for (const auto& [from, to] : neutral) replace_all(text, from, to);
  for (const auto& [from, to] : words) replace_all(text, from, to);
  return text;
}

}  // namespace pivnp::report

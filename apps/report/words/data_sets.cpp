#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

namespace {

bool knows_its_error(const MotionSource& motion) {
  return !motion.times().empty() && !motion.frame(motion.times().size() - 1).cov_u.empty();
}

bool like_with_like(const Content& content) {
  if (!content.comparison) return false;
  if (!content.measured || !content.simulated) return !content.measured && !content.simulated;
  if (content.measured->name() == "np" && !content.simulated->name().starts_with("np")) return false;
  return !knows_its_error(*content.measured) || knows_its_error(*content.simulated);
}

}  // namespace

DataSetNames data_set_names(const Content& content) {
  if (like_with_like(content)) return {true, "first", "second", "the first", "the second"};
  return {false, "measured", "simulated", "the measurement", "the simulation"};
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = char(text[0] - 'a' + 'A');
  return text;
}

}  // namespace pivnp::report

#include "apps/report/words/flags.hpp"

#include <algorithm>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/ends.hpp"
#include "apps/report/words/summary.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

std::vector<std::string> flags(const Content& content, const DataSetNames& names, const std::vector<PairQuality>& pairs) {
  std::vector<std::string> list = missed_limits(content);
  list.insert(list.end(), content.remarks.begin(), content.remarks.end());
  const bool many = std::count_if(pairs.begin(), pairs.end(), [](const PairQuality& q) { return q.flag != 0; }) > 12;
  std::size_t flagged = 0;
  for (const PairQuality& q : pairs) {
    if (q.flag == 0 || (many && ++flagged > 12)) continue;
    const std::string step =
        "Step " + frame_words(content, q.frames[0]) + " to " + frame_words(content, q.frames[1]) + ": ";
    if (q.flag & frame_decorrelated)
      list.push_back(step + "the pair lost its correlation over most of the image (median score " +
                     significant(q.score_median, 2) + ", " + percent(q.share(q.valid)) + " valid).");
    if (q.flag & frame_repeated)
      list.push_back(step + "the second exposure repeats the first; no motion can be read from it.");
    if (q.flag & frame_flash)
      list.push_back(
          step +
          "the second frame is brighter or darker than those before and after it: a flash, or a lamp that failed.");
    if (q.flag & frame_jump)
      list.push_back(step + "the motion does not agree with the steps before and after: a frame may be missing, or "
                            "the camera was shaken.");
  }
  if (many)
    list.push_back("Further steps are flagged; the figure of the measurement\u2019s quality marks all of them.");

  // A pair that is short of valid vectors is named once, by its worst.
  const PairQuality* worst = nullptr;
  std::size_t poor = 0;
  for (const PairQuality& q : pairs) {
    if (q.nodes == 0 || q.share(q.valid) >= 0.9) continue;
    ++poor;
    if (worst == nullptr || q.share(q.valid) < worst->share(worst->valid)) worst = &q;
  }
  if (worst != nullptr)
    list.push_back("In " + std::to_string(poor) + " of " + count(pairs.size(), "pair") +
                   " fewer than 90 % of the vectors are valid; the worst is " + frame_words(content, worst->frames[0]) +
                   " to " + frame_words(content, worst->frames[1]) + ": " + percent(worst->share(worst->valid)) +
                   " valid, " + percent(worst->share(worst->replaced)) + " replaced, " +
                   percent(worst->share(worst->rejected)) + " rejected, " + percent(worst->share(worst->failed)) +
                   " failed.");
  for (const auto& [motion, name] :
       {std::pair{content.measured.get(), names.first}, {content.simulated.get(), names.second}}) {
    if (motion == nullptr) continue;
    std::size_t ended = 0;
    for (const Ends& e : ends_by_reason(motion->particles())) ended += e.particles;
    if (ended > 0)
      list.push_back(count(ended, "particle") + " of " + std::to_string(motion->particles().size()) + " in the " + name +
                     " motion ended before the last frame (a table gives the reasons).");
  }
  return list;
}

}  // namespace pivnp::report

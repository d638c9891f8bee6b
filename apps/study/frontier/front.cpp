#include "apps/study/frontier/front.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

bool was_measured(const FrontierPoint& p) { return p.complete && !p.elsewhere && std::isfinite(p.seconds) && std::isfinite(p.error); }

std::string compared(const FrontierPoint& p, const FrontierPoint& with) {
  const auto times = [](double ratio, const char* of) { return number(ratio, 2) + (ratio < 1 ? " of the " : " times the ") + of; };
  return p.name + " (" + p.keys + ") takes " + times(p.seconds / with.seconds, "time") + ", with " + times(p.error / with.error, "error");
}

}  // namespace

void find_front(std::vector<FrontierPoint>& points) {
  for (FrontierPoint& p : points)
    p.on_front = was_measured(p) && std::none_of(points.begin(), points.end(), [&](const FrontierPoint& o) {
      return was_measured(o) && o.seconds <= p.seconds && o.error <= p.error && (o.seconds < p.seconds || o.error < p.error);
    });
}

std::vector<std::string> what_to_change(const FrontierStage& stage) {
  const auto is_own = [](const FrontierPoint& p) { return p.own && was_measured(p); };
  const auto is_standard = [](const FrontierPoint& p) { return p.standard && was_measured(p); };
  auto from = std::find_if(stage.points.begin(), stage.points.end(), is_own);
  const bool own = from != stage.points.end();
  if (!own) from = std::find_if(stage.points.begin(), stage.points.end(), is_standard);
  if (from == stage.points.end()) return {};
  const std::string whose = own ? "the case's setting (" + from->name + ")" : "the default (" + from->name + ")";
  const auto best = [&](const auto& good, const auto& of) -> const FrontierPoint* {
    const FrontierPoint* found = nullptr;
    for (const FrontierPoint& p : stage.points)
      if (was_measured(p) && good(p) && (!found || of(p) < of(*found))) found = &p;
    return found;
  };
  const auto error = [](const FrontierPoint& p) { return p.error; };
  const auto seconds = [](const FrontierPoint& p) { return p.seconds; };
  std::vector<std::string> words;
  const FrontierPoint* faster = best([&](const FrontierPoint& p) { return p.seconds <= 0.5 * from->seconds; }, error);
  words.push_back(faster ? "Twice as fast as " + whose + ": " + compared(*faster, *from) + "."
                         : "Nothing measured is twice as fast as " + whose + ".");
  const FrontierPoint* better = best([&](const FrontierPoint& p) { return p.error <= 0.5 * from->error && p.error > stage.floor; }, seconds);
  if (0.5 * from->error <= stage.floor) {
    words.push_back("Twice as accurate as " + whose + " cannot be shown: the error of the reference itself is about " + number(stage.floor, 2) + ".");
  } else if (better) {
    words.push_back("Twice as accurate as " + whose + ": " + compared(*better, *from) + ".");
  } else {
    const FrontierPoint* least = best([](const FrontierPoint&) { return true; }, error);
    words.push_back("Nothing measured is twice as accurate as " + whose +
                    (least == &*from ? ", which has the least error of all." : "; the least error: " + compared(*least, *from) + "."));
  }
  if (!from->on_front && from->error > 2 * stage.floor)
    if (const FrontierPoint* beats = best([&](const FrontierPoint& p) { return p.seconds <= from->seconds && p.error <= from->error && &p != &*from; }, error))
      words.push_back(std::string(own ? "The case's setting" : "The default") + " is not on the front: " + compared(*beats, *from) + ".");
  return words;
}

}  // namespace pivnp::app

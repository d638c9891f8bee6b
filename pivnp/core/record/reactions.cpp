#include "pivnp/core/record/reactions.hpp"

#include <limits>

namespace pivnp {

Reactions reactions_of(const std::vector<std::string>& names, const std::vector<ReactionRow>& rows) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  Reactions out;
  for (const ReactionRow& row : rows) out.time.push_back(row.time);
  for (std::size_t k = 0; k < names.size(); ++k) {
    ReactionSeries s{.name = names[k], .force = {}, .moment = {}, .displacement = {}, .turn = {}};
    const bool body = s.name.starts_with("body.");
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const ReactionRow::Of& now = rows[r].of[k];
      const double dt = r > 0 ? rows[r].time - rows[r - 1].time : 0;
      const ReactionRow::Of before = r > 0 ? rows[r - 1].of[k] : ReactionRow::Of{};
      s.force.push_back(dt > 0 ? Vec2((now.impulse - before.impulse) / dt) : Vec2(unknown, unknown));
      s.moment.push_back(dt > 0 ? (now.moment - before.moment) / dt : unknown);
      if (!body) continue;
      s.displacement.push_back(now.displacement);
      s.turn.push_back(now.turn);
    }
    out.series.push_back(std::move(s));
  }
  return out;
}

}  // namespace pivnp

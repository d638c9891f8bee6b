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
      const double dt = r > 0 ? rows[r].stepped - rows[r - 1].stepped : 0;
      if (dt > 0) {
        const ReactionRow::Of& before = rows[r - 1].of[k];
        s.force.push_back((now.impulse - before.impulse) / dt);
        s.moment.push_back((now.moment - before.moment) / dt);
      } else {
        s.force.push_back(r > 0 ? s.force.back() : Vec2(unknown, unknown));
        s.moment.push_back(r > 0 ? s.moment.back() : unknown);
      }
      if (!body) continue;
      s.displacement.push_back(now.displacement);
      s.turn.push_back(now.turn);
    }
    out.series.push_back(std::move(s));
  }
  return out;
}

}  // namespace pivnp

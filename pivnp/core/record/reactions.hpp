// What boundaries, loads, rigid bodies and contacts do to the material of a simulation, against time: what a load-displacement curve is
// drawn from.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp {

/// At an output time, of every boundary, body and contact in the order of their names.
struct ReactionRow {
  struct Of {
    Vec2 impulse = Vec2::Zero();  // on the material since time 0, N s/m
    double moment = 0;            // of that impulse about the origin of coordinates, N s
    Vec2 displacement = Vec2::Zero();  // of a body since time 0, m; others: zero
    double turn = 0;                   // of a body, rad
  };
  double time = 0;
  double stepped = 0;  // of that time, what was simulated: less once a run has come to rest
  std::vector<Of> of;
};

/// The series of one of them, one value a row.
struct ReactionSeries {
  std::string name;                // "boundary.NAME", "body.NAME" or "contact.NAME"
  // On the material per metre of thickness, mean since the row before, N/m; the first: NaN; after the last step: as before.
  std::vector<Vec2> force;
  std::vector<double> moment;      // likewise, about the origin of coordinates, N
  std::vector<Vec2> displacement;  // of a body; empty for others
  std::vector<double> turn;        // likewise
};
struct Reactions {
  std::vector<double> time;
  std::vector<ReactionSeries> series;
};

/// Series of the rows of `names`.
Reactions reactions_of(const std::vector<std::string>& names, const std::vector<ReactionRow>& rows);

}  // namespace pivnp

// Bodies in contact, for tests.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {

inline const Grid contact_box{{0, 0}, {0.01, 0.01}, 41, 31};

inline ContactOptions between(const std::vector<std::string>& regions, std::optional<double> friction,
                       const std::vector<std::string>& against = {}) {
  ContactOptions o;
  o.regions = regions;
  o.against = against;
  o.friction = friction;
  return o;
}

// Three bodies over one another, the upper two side by side.
inline Scene pile(std::optional<double> friction) {
  Scene s = scene(contact_box,
                  {rectangle("bed", 0.05, 0.05, 0.35, 0.1), rectangle("left", 0.1, 0.1, 0.2, 0.2),
                   rectangle("right", 0.2, 0.1, 0.3, 0.2)},
                  {elastic(1e6, 0.3, 1500), elastic(2e5, 0.2, 700), elastic(1e6, 0.3, 2500)});
  s.contacts = {{"left", between({"left"}, friction)}, {"right", between({"right"}, 0.2)},
                {"sides", between({"right"}, 0.0, {"left"})}};
  return s;
}

}  // namespace pivnp::mpm::test

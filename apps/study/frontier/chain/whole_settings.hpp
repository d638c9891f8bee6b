// A handful of whole settings, from quick to fine.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/case/case.hpp"

namespace pivnp::app {

struct WholeSetting {
  std::string name, keys;
  std::function<void(Case&)> change;
  bool own = false, standard = false;
  double cells = 1;  // of the simulation, times the case's

  Case applied(const Case& c) const;
};

/// Of [piv] and [np]: fast, default, subsets, fine, and the case's own where `own` says that it has one.
std::vector<WholeSetting> measurement_settings(const Case& c, bool own);
/// Of [mpm]: coarse, default, and the case's own.
std::vector<WholeSetting> simulation_settings(const Case& c, bool own);

}  // namespace pivnp::app

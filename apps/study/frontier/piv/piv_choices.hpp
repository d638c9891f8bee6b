// Settings of [piv] that are worth measuring, and what a case says for each.
#pragma once

#include <string>
#include <vector>

#include "pivnp/piv/options.hpp"

namespace pivnp::app {

/// A setting of [piv] by its name.
struct PivChoice {
  std::string name;
  piv::PivOptions options;
};
/// Every method with the windows, orders and passes worth having, from `base`.
std::vector<PivChoice> piv_choices(const piv::PivOptions& base);

/// What `options` say that `base` does not, as a command line has it; "as it is" where that is nothing.
std::string keys_of(const piv::PivOptions& options, const piv::PivOptions& base);
bool same(const piv::PivOptions& a, const piv::PivOptions& b);

/// What acts alike is written alike: one name a method, what a method has no use for as it is by default, passes counted.
piv::PivOptions plainly(piv::PivOptions o);
/// `base` with the method, window and smoothing of a case that names none; its tests and anchor stay.
piv::PivOptions with_defaults(const piv::PivOptions& base);
/// "gn, 24 px, subsets"
std::string plain_name(const piv::PivOptions& o);

}  // namespace pivnp::app

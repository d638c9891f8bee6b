// How the checks of a case refuse, and what they share.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/case/document.hpp"
#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

struct Refusals {
  const Case& c_;
  const Source& source_;

  [[noreturn]] void refuse(const std::string& key, const std::string& what) const {
    throw InputError(source_.at(key) + ": " + what);
  }
  [[noreturn]] void refuse_section(const std::string& path, const std::string& what) const {
    throw InputError(source_.place(path) + ": [" + path + "]: " + what);
  }

  bool has_images() const { return c_.frames || c_.synth; }
  bool measures() const { return has_images() || c_.vectors; }

  // Every region has a material among `materials`, by the name it gives or its own.
  void materials_of_regions(const std::string& stage, const std::string& prefix,
                            const Named<mpm::MaterialOptions>& materials) const {
    if (c_.regions.empty()) refuse_section(stage, "there is nothing to simulate; expected a [region.NAME]");
    std::vector<std::string> known;
    for (const auto& item : materials) known.push_back(item.first);
    if (known.empty()) refuse_section(stage, "no material is given; expected a [" + prefix + ".NAME]");
    for (const auto& [name, region] : c_.regions) {
      const std::string wanted = region.material.empty() ? name : region.material;
      if (std::find(known.begin(), known.end(), wanted) != known.end()) continue;
      const std::string key = "region." + name + (region.material.empty() ? "" : ".material");
      throw InputError(source_.at(key) + ": there is no [" + prefix + "." + wanted + "]" + did_you_mean(wanted, known));
    }
  }
};

/// Of materials, [mpm], [centrifuge], [water], [initial.NAME] and [contact.NAME]; as check_given().
void check_simulation(const Case& c, const Source& source);

}  // namespace pivnp::app

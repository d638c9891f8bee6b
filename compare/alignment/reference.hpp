// The frame both data sets are seen in: the motion of declared reference material, taken off each data set.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/rigid.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::compare {

class Reference {
 public:
  /// Without a polygon nothing is taken off. `turn`: shift and rotation, else the mean displacement alone. Throws
  /// InputError, naming `key`, if the polygon is not simple, or holds fewer particles of a data set than the fit needs.
  Reference(const Points& polygon, bool turn, const std::string& key, const DataSet& first, const DataSet& second);

  bool given() const { return given_; }
  bool turns() const { return turn_; }

  /// The reference's motion by the particles still followed, first and second data set; none without a polygon; nothing
  /// once a data set has lost too many.
  std::optional<std::array<RigidFit, 2>> fit(const DataSetState& first, const DataSetState& second) const;

 private:
  bool given_ = false, turn_ = false;
  std::array<const DataSet*, 2> sets_;
  std::array<std::vector<std::size_t>, 2> members_;  // by material position at the common start
};

}  // namespace pivnp::compare

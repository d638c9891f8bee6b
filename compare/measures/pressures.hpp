// Second minus first of the pressure of the water in the pores, where both data sets know it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/sources.hpp"
#include "compare/data/statistics.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// Linear in time between frames, as displacements are, and by the partners' weights between particles. Without pressures in both
/// nothing is read and nothing kept.
class Pressures {
 public:
  /// `paired`: as Differences has them.
  Pressures(const DataSet& first, const DataSet& second, const std::vector<std::size_t>& paired, const CommonTimes& common);

  /// One more common time.
  void add(const DataSetState& first, const DataSetState& second, const std::vector<Partner>& partners);

  bool known() const { return known_; }
  const ScalarStatistics& total() const { return total_; }
  const ScalarStatistics& last() const { return last_; }
  double greatest(std::size_t set) const { return greatest_[set]; }  // size of the pressure, over the compared particles and times
  /// difference_pressure, at the first time, the last, and evenly between them; nothing where it is not known.
  std::optional<ComparisonField> field() const;

 private:
  struct Held {
    std::optional<std::size_t> index;
    std::vector<float> values;
  };
  const std::vector<float>& frame(std::size_t set, std::size_t index);
  std::vector<double> at(std::size_t set, double time);

  PerDataSet<const MotionSource*> motion_;
  double tolerance_;
  bool known_;
  std::vector<std::size_t> paired_;
  std::vector<std::int64_t> id_;
  std::size_t most_times_, kept_, added_ = 0;
  PerDataSet<std::array<Held, 2>> held_;
  ScalarStatistics total_, last_;
  PerDataSet<double> greatest_{0, 0};
  std::vector<double> time_;
  std::vector<float> values_;
};

}  // namespace pivnp::compare

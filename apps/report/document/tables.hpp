// The tables of a report.
#pragma once

#include <optional>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/quality.hpp"
#include "apps/report/document/document.hpp"
#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

/// What the comparison comes to, in eight rows at most; none where nothing is known.
std::optional<Table> summary_table(const Content& content, const DataSetNames& names);

/// Camera, correlation, noise and strain gauge of the measurement.
Table measurement_table(const Content& content, const std::vector<PairQuality>& pairs);

/// Materials, cells, step, walls and loads of the simulation; none where they are not known.
std::optional<Table> simulation_table(const Content& content);

/// What the comparisons of several runs come to, a column a run; none where there are not two.
std::optional<Table> runs_table(const Content& content);

/// All metrics: statistics of differences, quantities of both data sets, and what remains.
std::vector<Table> metrics_tables(const Content& content, const DataSetNames& names);

/// What each of them means, families once.
Definitions metric_definitions(const Content& content);

/// Particles that ended, by reason; none if none did.
std::optional<Table> ends_table(const Content& content, const DataSetNames& names);

/// Time and memory of each stage; none where the record does not tell.
std::optional<Table> cost_table(const Content& content);

}  // namespace pivnp::report

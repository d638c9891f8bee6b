// The tables of a report.
#pragma once

#include <optional>

#include "apps/report/content/content.hpp"
#include "apps/report/document/document.hpp"
#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

/// What the comparison comes to, in eight rows at most; none where nothing is known.
std::optional<Table> summary_table(const Content& content, const DataSetNames& names);

/// The metrics that a reader asks for first, and those with a limit.
Table leading_metrics_table(const Content& content, const DataSetNames& names);

/// All of them with their definitions.
Table metrics_table(const Content& content, const DataSetNames& names);

/// Particles that ended, by reason; none if none did.
std::optional<Table> ends_table(const Content& content, const DataSetNames& names);

}  // namespace pivnp::report

// A stage as numbers.
#pragma once

#include <string>

#include "apps/study/frontier/front.hpp"
#include "pivnp/io/records/table_file.hpp"

namespace pivnp::app {

/// As CSV: a row a point.
std::string csv(const FrontierStage& stage);
/// For HDF5, with the machine and its threads.
io::NamedTable table_of(const FrontierStage& stage, const std::string& machine, int threads);

}  // namespace pivnp::app

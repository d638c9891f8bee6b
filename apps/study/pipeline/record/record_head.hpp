// What every record of a study says of itself.
#pragma once

#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// Command, case, grid, units of length and camera. The unit of time stays seconds.
/// io::StageKeys of a case's text: all sections but those that the stage has no use for.
std::string keys_of_stage(const std::string& case_text, const std::string& stage);

io::RecordHead record_head(const Case& c, const Setting& setting, const RunSettings& settings);

}  // namespace pivnp::app

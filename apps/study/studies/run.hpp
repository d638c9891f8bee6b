// `pivnp run` and its parts.
#pragma once

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// How far `run_case` goes.
enum class Stages { all, piv, track, simulate };

/// The chain of the case's stages: frames (drawn first where only [synth] is given) -> PIV -> numerical particles ->
/// MPM -> comparison -> record -> report. Throws InputError, RunError, Interrupted; closed segments stay for `resume`.
RunOutcome run_case(const Case& c, const RunSettings& settings, Stages stages, Progress& progress);

}  // namespace pivnp::app

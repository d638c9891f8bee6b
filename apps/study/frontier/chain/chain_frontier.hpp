// Whole settings of a case whose truth is known: error of what the verdict compares against total time.
#pragma once

#include "apps/case/case.hpp"
#include "apps/study/frontier/front.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// `c` draws its frames ([synth]); they and all that is measured go to folders in settings.out. A handful of settings of the measurement (fast, the
/// default, fine ...) are each combined with as many of the simulation, where there is one. The verdict's numbers are those of compare():
/// final rms differences of displacement and deviatoric strain and, with compare.slope_base_m, the difference of run-out. Error: these numbers between
/// measured and drawn motion and between the simulation and that on cells half as large, in squares added; rms over the numbers, each in percent of the
/// motion's own size (rms displacement, rms strain, greatest displacement). No deviation of the verdict's numbers is greater than the sum of both (triangle
/// inequality), and none small by chance makes a setting good. The numbers themselves are columns, beside the true ones. Time: of measuring, following, simulating and comparing;
/// neither drawing nor the report is in it. Each part is timed `repeats` times, in turn (long ones once); spreads of the parts are added. Throws InputError where [synth] is missing.
FrontierStage chain_frontier(const Case& c, bool own, const RunSettings& settings, int repeats, int threads, Progress& progress);

}  // namespace pivnp::app

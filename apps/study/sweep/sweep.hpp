// `pivnp sweep`: a case simulated with other values of its keys, one at a time or in all combinations; what comes of it as
// tornado charts, curves, fields and tables.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct SweepOptions {
  std::vector<std::string> vary;       // "KEY=VALUE,VALUE,..."; "KEY+KEY=..." gives several keys the same value
  bool grid = false;                   // all combinations of the values; else one key at a time beside the case's own
  std::vector<std::string> responses;  // names of sweep_responses(), or difference.METRIC; none: top_speed and run_out
  std::string against;                 // the measurement that difference.METRIC compares each run with, as in CompareSources
  std::vector<double> zone_m;          // x0, y0, x1, y1: the points that start in this box; none: those of the material that moves
  std::vector<std::string> fields;     // of the last output time, drawn for each run; none: displacement_magnitude
  int jobs = 0;                        // runs at a time; 0: as many as threads
  std::vector<std::string> given;      // keys given beside the file, for all runs
  std::filesystem::path program;       // `pivnp`, which makes each run
};

/// What can be asked of a run: name, unit and one line of text.
struct SweepResponse {
  std::string name, unit, text;
};
std::vector<SweepResponse> sweep_responses();
/// One of them, or "difference.METRIC": a metric of the comparison with a measurement, simulated minus measured. Throws InputError.
SweepResponse sweep_response(const std::string& name);

/// One run: the values of the keys that it varies, and what came of it.
struct SweepRun {
  std::vector<std::string> values;  // one a variation; empty: the case's own
  std::string label;
  std::filesystem::path folder;     // of its record and report
  std::string failure;              // why it ended; empty: it did not
  std::vector<double> responses;    // in the order asked for; NaN: not known
  std::vector<double> uncertainties;  // their standard uncertainties, of differences; NaN: not known
  std::vector<double> times, distance, speed, pressure;  // means over the zone's points; pressure: in their bands, where there are none in the pores; NaN without water
  bool kept = false;                // made by an earlier call
};

struct SweepOutcome {
  std::vector<SweepRun> runs;  // without `grid`, the first is the case as it is
  std::vector<std::filesystem::path> files;
  std::vector<std::string> sentences;
};

/// Makes the runs in `settings.out`/runs, several at a time, and writes the page, its charts and its tables beside. A run that is there
/// already, of the same keys and the same program, is kept; one that was stopped goes on. A run that fails is a row with its reason.
/// Throws InputError for variations, responses or fields that are none (before any run), RunError, Interrupted.
SweepOutcome sweep(const Case& c, const SweepOptions& options, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app

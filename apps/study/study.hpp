// The chains of several engines that the commands run, as a library of values: no argv, no printing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "compare/compare.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct RunSettings {
  std::filesystem::path out;          // receives record.h5, record.xdmf, report.html, report.pdf, figures/
  bool resume = false;                // go on from what a killed run left in `out`
  int threads = 0;                    // 0: all cores; never changes a result
  std::string command;                // as typed, for the record
  std::optional<std::string> frames;  // wins over the case's [frames] path, relative to the working folder
};

/// How far `run_case` goes.
enum class Stages { all, piv, track, simulate };

struct RunOutcome {
  bool over_limit = false;  // a limit of [compare.limits] was passed: exit code 3
  std::filesystem::path record, report_html, report_pdf;
  std::vector<std::string> remarks;  // what was flagged and why, one sentence each
  std::vector<compare::LimitResult> limits;  // one a limit of [compare.limits] that was given and judged
};

/// The chain of the case's stages: frames (drawn first where only [synth] is given) -> PIV -> numerical particles ->
/// MPM -> comparison -> record -> report. Throws InputError, RunError, Interrupted; closed segments stay for `resume`.
RunOutcome run_case(const Case& c, const RunSettings& settings, Stages stages, Progress& progress);

/// What is compared, each side "RECORD.h5" or "RECORD.h5:motion" (a record with one motion needs no name), or results
/// of another program (pivnp/io/import_motion.hpp), or both of them histories (apps/study/histories.hpp).
struct CompareSources {
  std::string first, second;
  std::vector<std::string> coarser;  // the second on coarser grids, the finer one first
  double refinement_ratio = 2;       // of the grids' spacings
  double step_s = 1;                 // time from one step to the next where files only count them
  std::string length_unit = "m";     // of other programs' results
};

/// Compares two motions, writes a record with both and the comparison, and its report.
RunOutcome compare_records(const CompareSources& sources, const compare::CompareOptions& options,
                           const compare::LimitOptions& limits, const RunSettings& settings, Progress& progress);

/// Draws the frames of a [synth] case into OUT/frames/*.png and their truth into OUT/truth/record.h5 (motion "truth",
/// at the seeds that the case's own particles start from).
void synthesize(const Case& c, const RunSettings& settings, Progress& progress);

/// Writes the report of a finished record beside it (or into settings.out).
RunOutcome report_record(const std::filesystem::path& record, const RunSettings& settings, Progress& progress);

struct CheckOutcome {
  std::filesystem::path picture;
  std::vector<std::string> remarks;  // on the first frame, one sentence each
};

/// Validates a case against its frames and what its simulation asks for, and draws OUT/check.png: the first frame with
/// grid, masks, regions, boundaries and a scale bar. Without frames nothing is drawn (`picture` is empty).
CheckOutcome check_case(const Case& c, const RunSettings& settings, Progress& progress);

struct VerifyResult {
  struct Item {
    std::string criterion;
    double limit = 0, reached = 0;
    bool passed = false;
  };
  std::string name;
  bool passed = false;
  double seconds = 0;
  std::vector<Item> items;
  std::string failure;  // why it could not be judged; empty otherwise
};

/// Runs a [synth] case through images and as nodal increments, and judges both by [verify].
VerifyResult verify_case(const Case& c, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app

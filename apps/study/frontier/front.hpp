// Settings of one stage in cost and error: which of them none beats, and what to change.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace pivnp::app {

/// A setting that was measured. Columns: figures beside cost and error, as many as the stage names.
struct FrontierPoint {
  std::string name;      // "gn, 24 px"
  std::string keys;      // what a case says for it: "piv.method=gn piv.window_px=24"
  double seconds = std::numeric_limits<double>::quiet_NaN();  // median
  double slowest = std::numeric_limits<double>::quiet_NaN(), quickest = slowest;  // of the repeats
  double bytes = std::numeric_limits<double>::quiet_NaN();         // peak, beyond what was held before
  double instructions = std::numeric_limits<double>::quiet_NaN();  // where they may be counted
  double error = std::numeric_limits<double>::quiet_NaN();
  double worst = std::numeric_limits<double>::quiet_NaN();  // error in the worst of its scenes
  std::vector<double> columns;
  bool standard = false;  // what a case gets that says nothing
  bool own = false;       // the case's
  bool complete = true;   // it gives as much as the others: else it is on no front
  bool elsewhere = false; // another program, measured on another machine: shown, and on no front
  bool on_front = false;  // no other is both quicker and more accurate
};

struct FrontierColumn {
  std::string name;  // in files: "bias_px"
  std::string head;  // of a table: "bias (px)"
  std::string text;  // what it is, no full stop
};

struct FrontierStage {
  std::string name;         // "piv": its files' name
  std::string title;        // "Image correlation"
  std::string made_of;      // one sentence: on what it was measured
  std::string error_label;  // "error, rms (px)"
  std::string time_label;   // "time per pair of frames (ms)"
  double time_unit = 1;     // seconds, of the label's unit
  double floor = 0;         // the truth's own error: nothing below it is told apart
  std::vector<FrontierColumn> columns;  // of FrontierPoint::columns
  std::vector<FrontierPoint> points;
  std::vector<std::string> remarks;   // what else the points say, a sentence each
  std::vector<std::string> left_out;  // settings that could not be run, and why
};

/// Sets on_front.
void find_front(std::vector<FrontierPoint>& points);

/// What to change to be twice as fast, or twice as accurate, than the case's setting (or the default where no point is the
/// case's): one sentence each.
std::vector<std::string> what_to_change(const FrontierStage& stage);

}  // namespace pivnp::app

// What a record's data say of themselves: one registry that the report, the terminal and Python read.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/record/remark.hpp"
#include "pivnp/core/registry.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// A record as remarks see it, read once.
struct RecordSeen {
  struct Step {  // of the vectors in material that are not masked
    std::string from, to;
    std::uint8_t flag = 0;  // of its second frame
    double asked = 0, valid = 0, replaced = 0, rejected = 0, failed = 0;
    double score = 0;  // median
  };
  struct Motion {
    std::string name, length_unit;
    bool measured = false;
    std::size_t particles = 0, to_the_end = 0, flagged = 0;  // flagged: of those followed to the end
    double flagged_sigma = 0;                                // standard uncertainty of their displacement, RMS; NaN: not known
    std::vector<std::pair<EndReason, std::size_t>> ends;
    std::size_t hot = 0, open = 0;  // outside the equations of heat, at most in one state
  };
  std::vector<Step> steps;
  std::vector<double> time_steps;
  std::string time_unit;
  std::vector<Motion> motions;
  std::vector<EnergyRow> energy;
  bool damped = false;  // local damping was asked for
};
RecordSeen seen_in(const io::RecordReader& record);
RecordSeen::Motion seen_in(const MotionSource& motion);

struct RemarkRow {
  std::string_view name;
  RemarkWeight weight;
  std::string_view said;     // a part of the sentence that does not change
  std::string_view advice;   // what to look at, said with it; empty: nothing
  std::string_view meaning;  // for docs/troubleshooting.md: cause, and what to do
  std::function<std::vector<std::string>(const RecordSeen&)> find;  // one sentence each
};
const Registry<RemarkRow>& remark_rows();
/// The section of docs/troubleshooting.md that explains them, below its head.
inline constexpr std::string_view remark_head = "## What a run says of its data\n\n";
std::string remark_reference();

/// Those that the run left in the record, then what its data say.
std::vector<Remark> remarks_of(const io::RecordReader& record);
std::vector<Remark> remarks_of(const RecordSeen& seen);

/// Adds texts of one weight.
void append(std::vector<std::string> texts, std::vector<Remark>& remarks, RemarkWeight weight = RemarkWeight::note);

}  // namespace pivnp::app

// The simulation of a case, into the record; able to go on from its last closed segment.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// The simulation at `times` (the first is 0): motion "mpm", and its energy. Returns remarks: its doubts, and what sleeping left out.
std::vector<Remark> simulate(const Case& c, const Setting& setting, const std::vector<double>& times,
                                  io::RecordWriter& writer, int threads, Progress& progress);

/// The measured grid with cells so many times as large; it reaches at least as far.
Grid coarsened(const Grid& grid, double factor);

/// The same on a grid whose cells are mesh_study_ratio times as large (`level` 1), or the square of that (2), with as many
/// particles a cell: motion coarser_motion(level), for the numerical uncertainty of the other.
void simulate_coarser(const Case& c, const Setting& setting, int level, const std::vector<double>& times,
                      io::RecordWriter& writer, int threads, Progress& progress);

}  // namespace pivnp::app

// Runs of a sweep as processes of their own: a record's file library takes one thread, and what ends one run leaves the others alone.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct SweepJob {
  std::vector<std::string> words;  // of the command line, the program first
  std::filesystem::path folder;    // made; receives what the program prints, as run.log
  std::string title;
  std::string failure = {};        // out: the program's message where it did not end with 0
};

/// Makes the jobs, `at_once` at a time, in their order. On a request to stop all are interrupted and waited for. Throws Interrupted, and
/// RunError where no process can be made.
void make_jobs(std::vector<SweepJob>& jobs, int at_once, std::int64_t before, Progress& progress);

}  // namespace pivnp::app

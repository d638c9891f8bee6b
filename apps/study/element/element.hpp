// `pivnp element`: a laboratory's element tests on the materials of a case, charted beside the laboratory's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "mpm/scene/element_test.hpp"

namespace pivnp::app {

struct ElementStudy {
  mpm::ElementTestOptions test;       // its pressure is not used
  std::vector<double> pressures_pa;   // one test each, six at most; none: 50, 100 and 200 kPa
  std::string material;               // name in the case; empty: its only one
  std::filesystem::path laboratory;   // CSV (io/imports/time_table.hpp); empty: none
  double band_m = 0;                  // direct_shear: thickness of the band, which makes gamma a displacement; 0: gamma is shown
};

struct ElementOutcome {
  std::vector<mpm::ElementPath> paths;  // in the order of the pressures
  std::vector<std::filesystem::path> files;
  std::vector<std::string> sentences;
};

/// Runs the tests and writes element.html, .pdf, .csv, .h5 and the chart into `settings.out`. Throws InputError for a material that is not
/// there, options out of range and a laboratory's file that cannot be read (before anything is written), RunError.
ElementOutcome element(const Case& c, const ElementStudy& study, const RunSettings& settings);

}  // namespace pivnp::app

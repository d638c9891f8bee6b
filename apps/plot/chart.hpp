// A chart of a few named curves, for studies that end in one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pivnp::plot {

struct ChartCurve {
  std::string name;
  std::vector<double> x, y;  // NaN leaves a gap
};

struct Chart {
  std::string x_label, y_label;
  std::vector<ChartCurve> curves;  // at most six
  bool logarithmic = false;        // y
};

/// Writes FILE.svg and FILE.png (`file` without suffix). Throws RunError naming the file.
void write_chart(const Chart& chart, const std::filesystem::path& file);

}  // namespace pivnp::plot

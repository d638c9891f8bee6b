// What both exports of a motion walk: its chosen frames with all that is known of each particle. Private to this folder.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/io/exports/exports.hpp"

namespace pivnp::io {

struct ExportColumn {
  std::string name, unit;
  std::vector<double> values;  // one a particle, NaN: not known
};

struct ExportFrame {
  double time = 0;
  MotionFrame state;
  std::vector<ExportColumn> columns;  // sigma_x, sigma_y, fields, differences; the same in every frame
};

/// Names of the motions asked for, all of them if none are. `vectors`: "piv" is among them, or nothing was asked for and
/// there are vectors.
std::vector<std::string> chosen_motions(const RecordReader& record, const ExportOptions& options, bool& vectors);

void for_each_frame(const RecordReader& record, const MotionSource& motion, const ExportOptions& options,
                    const std::function<void(const ExportFrame&)>& take);

}  // namespace pivnp::io

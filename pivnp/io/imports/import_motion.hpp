// Results of other programs as motions; their formats are listed in import_format.cpp.
#pragma once

#include <memory>
#include <string>

#include "pivnp/core/particles/motion.hpp"

namespace pivnp::io {

struct ImportOptions {
  double step = 1;  // time from one number of a file (or step of a table) to the next; a table's own times win
  std::string length_unit = "m", time_unit = "s";
};

/// True for "FORMAT=PATTERN" with a FORMAT that reads motions (import_format.hpp).
bool is_import(const std::string& text);

/// Opens "FORMAT=PATTERN"; PATTERN is a file or a glob in one folder, files ordered by the last number in their names,
/// which counts their steps (all files must belong to one run). The name of the motion is the format's. x and y are
/// taken; a third coordinate is left out. Material positions: x - u of the first time a particle is there where its
/// displacement is known, else its first position; the displacement is then counted from there. Particles that stop
/// appearing have ended. Deformation gradients are fitted to the displacements
/// (core/particles/displacement_gradient.hpp), whatever strain the program itself writes: one measure for both motions
/// of a comparison. Frames are read when asked for (a table is held in memory). Throws InputError naming the file and
/// what was found and expected.
std::unique_ptr<MotionSource> open_import(const std::string& text, const ImportOptions& options);

}  // namespace pivnp::io

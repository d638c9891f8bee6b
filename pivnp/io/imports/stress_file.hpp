// Stresses and pressures at scattered points, as finite element programs write them.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::io {

struct StressValues {
  std::vector<Vec2> at;                       // m
  std::vector<std::array<double, 4>> stress;  // xx yy zz xy, Pa, tension positive
};

/// Reads the columns x_m, y_m, stress_xx_pa, stress_yy_pa, stress_zz_pa and stress_xy_pa of a CSV file; others are left out. Throws
/// InputError naming file, line and what was expected: a missing column, no number, fewer than three points.
StressValues read_stress(const std::filesystem::path& file);

struct PressureValues {
  std::vector<Vec2> at;          // m
  std::vector<double> pressure;  // Pa
};

/// The same of the columns x_m, y_m and pressure_pa.
PressureValues read_pressure(const std::filesystem::path& file);

}  // namespace pivnp::io

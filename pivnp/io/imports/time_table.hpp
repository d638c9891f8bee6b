// Quantities over time, as loading devices and spreadsheets write them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pivnp::io {

struct TimeTable {
  std::vector<double> time;                           // s, ascending
  std::map<std::string, std::vector<double>> columns;  // of the quantities found, SI
  const std::vector<double>* find(const std::string& quantity) const;
};

/// Reads a CSV file whose header names quantity and unit of every column: time_s (ms, min, h), displacement_x_m (mm, cm), velocity_x_m_s
/// (mm_s, mm_min), angle_rad (deg), angular_velocity_rad_s (deg_s), force_x_n_m (kn_m, per metre of thickness), and those of y. `wanted`: the
/// quantities taken here. Throws InputError naming file, line and what was expected: a column of another name, none of them, a quantity
/// given twice, no number, times that do not ascend, fewer than two rows.
TimeTable read_time_table(const std::filesystem::path& file, const std::vector<std::string>& wanted);

/// What a laboratory's element test may give; strains (1, percent) and stresses (pa, kpa, mpa), compression positive.
const std::vector<std::string>& test_quantities();
/// Reads such a CSV file: axial_strain_percent, deviator_stress_kpa and so on, in SI by quantity. Throws InputError as read_time_table() does.
std::map<std::string, std::vector<double>> read_test_table(const std::filesystem::path& file);

}  // namespace pivnp::io

// Tables as an HDF5 file: one group a table, one dataset a column.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace pivnp::io {

struct TableColumn {
  std::string name;
  std::string unit = {};
  std::vector<double> numbers = {};
  std::vector<std::string> texts = {};  // in the place of numbers
};

struct NamedTable {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;  // what the table is about
  std::vector<TableColumn> columns;
};

/// Whole or not at all. Throws RunError naming the file and the cause.
void write_tables(const std::filesystem::path& file, const std::vector<NamedTable>& tables);

}  // namespace pivnp::io

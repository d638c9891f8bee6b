// A page, its figures and its numbers as files.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/document/document.hpp"
#include "pivnp/io/records/table_file.hpp"

namespace pivnp::app {

/// Writes NAME.html, NAME.pdf, each figure as .png and .svg, `texts` (file name, bytes) and NAME.h5 into `folder`, which is made; returns
/// them in this order. Throws RunError naming the file.
std::vector<std::filesystem::path> write_pages(const report::Document& document, const std::string& name,
                                               const std::vector<std::pair<std::string, std::string>>& texts,
                                               const std::vector<io::NamedTable>& tables, const std::filesystem::path& folder);

}  // namespace pivnp::app

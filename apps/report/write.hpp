// The report's files.
#pragma once

#include <filesystem>

#include "apps/report/content/content.hpp"
#include "apps/report/content/options.hpp"

namespace pivnp::report {

/// Writes report.html, report.pdf and figures/*.png, *.svg into `directory` (made if missing), each under a temporary
/// name that is renamed when complete; figures of an earlier report that this one lacks are removed. Throws RunError
/// naming the file and the cause, InputError for an unknown name in `options.fields_drawn`. Qt is started on the first
/// call, offscreen; every call must come from the thread of the first.
void write_content(const ReportOptions& options, const Content& content, const std::filesystem::path& directory);

}  // namespace pivnp::report

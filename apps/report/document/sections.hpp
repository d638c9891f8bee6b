// The report's order of things.
#pragma once

#include "apps/report/content/content.hpp"
#include "apps/report/content/options.hpp"
#include "apps/report/document/document.hpp"

namespace pivnp::report {

/// Draws all figures and puts the document together.
Document make_document(const ReportOptions& options, const Content& content);

}  // namespace pivnp::report

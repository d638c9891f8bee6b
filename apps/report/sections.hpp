// The report's order of things.
#pragma once

#include "apps/report/content.hpp"
#include "apps/report/document.hpp"

namespace pivnp::report {

/// Draws all figures and puts the document together.
Document make_document(const ReportOptions& options, const Content& content);

}  // namespace pivnp::report

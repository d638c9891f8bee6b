// The document as an A4 PDF: vector figures, page numbers, nothing cut at a page's end.
#pragma once

#include <string>

#include "apps/report/document/document.hpp"

namespace pivnp::report {

std::string pdf(const Document& document);

}  // namespace pivnp::report

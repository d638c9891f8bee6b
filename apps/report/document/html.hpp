// The document as one HTML file that needs nothing else.
#pragma once

#include <functional>
#include <string>

#include "apps/report/document/document.hpp"

namespace pivnp::report {

/// `png_of` gives a figure's PNG, which is embedded.
std::string html(const Document& document, const std::function<std::string(const Figure&)>& png_of);

}  // namespace pivnp::report

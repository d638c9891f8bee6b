// Results of `pivnp verify` as a table and as JUnit XML.
#pragma once

#include <string>
#include <vector>

#include "apps/study/study.hpp"

namespace pivnp::app {

/// One test suite a case, one test case a criterion; a case that could not be evaluated is an error.
std::string junit_xml(const std::vector<VerifyResult>& results, const std::string& name = "pivnp verify");

/// One line a criterion: verdict, case, criterion, reached, limit.
std::string verify_table(const std::vector<VerifyResult>& results);

/// Text as XML character data: markup escaped, what XML 1.0 forbids and broken UTF-8 as a question mark.
std::string xml_escaped(const std::string& text);

}  // namespace pivnp::app

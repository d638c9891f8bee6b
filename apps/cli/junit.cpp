#include "apps/cli/junit.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "pivnp/core/record/metric.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

// Length of the UTF-8 character at `at` that XML allows; 0: none.
std::size_t character(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned lead = byte(at);
  if (lead < 0x80) return lead >= 0x20 || lead == '\t' || lead == '\n' || lead == '\r' ? 1 : 0;
  const std::size_t length = lead >= 0xC2 && lead < 0xE0   ? 2
                             : lead >= 0xE0 && lead < 0xF0 ? 3
                             : lead >= 0xF0 && lead < 0xF5 ? 4
                                                           : 0;
  unsigned code = length == 2 ? lead & 0x1F : length == 3 ? lead & 0x0F : lead & 0x07;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(at + k) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(at + k) & 0x3F);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool forbidden = (code >= 0xD800 && code < 0xE000) || code == 0xFFFE || code == 0xFFFF || code > 0x10FFFF;
  return overlong || forbidden ? 0 : length;
}

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + xml_escaped(value) + "\"";
}

std::string seconds(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.3f", value);
  return buffer;
}

std::size_t failures_of(const VerifyResult& result) {
  return std::size_t(
      std::count_if(result.items.begin(), result.items.end(), [](const auto& item) { return !item.passed; }));
}

std::string counts(std::size_t tests, std::size_t failures, std::size_t errors, double time) {
  return attribute("tests", std::to_string(tests)) + attribute("failures", std::to_string(failures)) +
         attribute("errors", std::to_string(errors)) + attribute("time", seconds(time));
}

std::size_t errors_of(const VerifyResult& result) { return result.failure.empty() ? 0 : 1; }

std::string suite(const VerifyResult& result) {
  std::string xml =
      "  <testsuite" + attribute("name", result.name) +
      counts(result.items.size() + errors_of(result), failures_of(result), errors_of(result), result.seconds) + ">\n";
  for (const VerifyResult::Item& item : result.items) {
    const std::string verdict = std::string(name_of(item.passed ? LimitFate::met : LimitFate::exceeded)) + ": reached " +
                                number(item.reached, 6) + ", limit " + number(item.limit, 6);
    xml += "    <testcase" + attribute("classname", result.name) + attribute("name", item.criterion) + ">\n";
    if (!item.passed) xml += "      <failure" + attribute("message", verdict) + "/>\n";
    xml += "      <system-out>" + xml_escaped(verdict) + "</system-out>\n    </testcase>\n";
  }
  if (!result.failure.empty())
    xml += "    <testcase" + attribute("classname", result.name) + attribute("name", "runs to its end") +
           ">\n      <error" + attribute("message", result.failure) + "/>\n    </testcase>\n";
  return xml + "  </testsuite>\n";
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 0, ' ');
}

}  // namespace

std::string xml_escaped(const std::string& text) {
  std::string escaped;
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t length = character(text, k);
    switch (text[k]) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\n': escaped += "&#10;"; break;  // attributes would lose them
      case '\r': escaped += "&#13;"; break;
      case '\t': escaped += "&#9;"; break;
      default: escaped += length == 0 ? "?" : text.substr(k, length);
    }
    k += std::max<std::size_t>(length, 1);
  }
  return escaped;
}

std::string junit_xml(const std::vector<VerifyResult>& results, const std::string& name) {
  std::size_t tests = 0, failures = 0, errors = 0;
  double time = 0;
  for (const VerifyResult& result : results) {
    tests += result.items.size() + errors_of(result);
    failures += failures_of(result);
    errors += errors_of(result);
    time += result.seconds;
  }
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + attribute("name", name) +
                    counts(tests, failures, errors, time) + ">\n";
  for (const VerifyResult& result : results) xml += suite(result);
  return xml + "</testsuites>\n";
}

std::string verify_table(const std::vector<VerifyResult>& results) {
  std::string table;
  for (const VerifyResult& result : results) {
    std::size_t width = 0;
    for (const auto& item : result.items) width = std::max(width, item.criterion.size());
    table += std::string(result.passed ? "passed" : "FAILED") + "  " + result.name + "  (" + number(result.seconds, 3) +
             " s)\n";
    for (const auto& item : result.items)
      table += std::string("  ") + (item.passed ? "met     " : "EXCEEDED") + "  " + padded(item.criterion, width) +
               "  reached " + padded(number(item.reached, 4), 10) + " limit " + number(item.limit, 4) + "\n";
    if (!result.failure.empty()) table += "  could not be evaluated: " + result.failure + "\n";
  }
  return table;
}

}  // namespace pivnp::app

#include "apps/cli/json.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace pivnp::app {

namespace {

std::string json_text(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04x", unsigned(static_cast<unsigned char>(c)));
      out += code.data();
    } else {
      out += c;
    }
  }
  return out + "\"";
}

// The shortest digits that give the same number again.
std::string digits_of(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::string verdict_of(const Metric& m) {
  return m.verdict == Verdict::none ? "null" : json_text(std::string(name_of(m.verdict)));
}

std::string path_or_null(const std::filesystem::path& file) { return file.empty() ? "null" : json_text(file.string()); }

}  // namespace

std::string comparison_json(const RunOutcome& outcome, int exit_code) {
  std::string out = "{\n  \"record\": " + path_or_null(outcome.record) + ",\n  \"report\": " + path_or_null(outcome.report_html) +
                    ",\n  \"exit_code\": " + std::to_string(exit_code) + ",\n  \"metrics\": {";
  const char* comma = "\n";
  for (const Metric& m : outcome.metrics) {
    out += comma;
    out += "    " + json_text(m.name) + ": {\"value\": " + digits_of(m.value) + ", \"unit\": " + json_text(m.unit) +
           ", \"uncertainty\": " + digits_of(m.uncertainty);
    if (std::isfinite(m.factor))
      out += ", \"within_95\": " + digits_of(m.within()) + ", \"seen_95\": " + digits_of(m.seen()) + ", \"verdict\": " + verdict_of(m);
    if (m.lost_in != LostIn::nothing) out += ", \"lost_in\": " + json_text(std::string(name_of(m.lost_in)));
    if (m.limit != LimitFate::none) out += ", \"limit\": " + json_text(std::string(name_of(m.limit)));
    out += "}";
    comma = ",\n";
  }
  out += "\n  },\n  \"limits\": {";
  comma = "\n";
  for (const LimitResult& l : outcome.limits) {
    out += comma;
    out += "    " + json_text(l.key) + ": {\"limit\": " + digits_of(l.limit) + ", \"reached\": " + digits_of(l.reached) + ", \"verdict\": " +
           json_text(std::string(name_of(l.fate()))) + ", \"shown_95\": " + (l.shown() ? "true" : "false") + "}";
    comma = ",\n";
  }
  out += "\n  },\n  \"remarks\": [";
  comma = "\n";
  for (const Remark& remark : outcome.remarks) {
    out += comma;
    out += "    " + json_text(remark.text);
    comma = ",\n";
  }
  return out + "\n  ]\n}\n";
}

}  // namespace pivnp::app

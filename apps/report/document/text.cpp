#include "apps/report/document/text.hpp"

#include <algorithm>

namespace pivnp::report {

std::string clean_utf8(std::string_view text) {
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    const auto c = static_cast<unsigned char>(text[k]);
    const std::size_t length = c < 0x80                ? 1
                               : c >= 0xc2 && c < 0xe0 ? 2
                               : c >= 0xe0 && c < 0xf0 ? 3
                               : c >= 0xf0 && c < 0xf5 ? 4
                                                       : 0;
    bool good = length > 0 && k + length <= text.size();
    for (std::size_t j = 1; good && j < length; ++j) good = (static_cast<unsigned char>(text[k + j]) & 0xc0) == 0x80;
    if (good && length >= 3) {  // overlong forms, surrogates, beyond U+10FFFF
      const auto d = static_cast<unsigned char>(text[k + 1]);
      good =
          !((c == 0xe0 && d < 0xa0) || (c == 0xed && d >= 0xa0) || (c == 0xf0 && d < 0x90) || (c == 0xf4 && d >= 0x90));
    }
    if (!good) {
      out += "\ufffd";
      ++k;
      continue;
    }
    if (length > 1 || c == '\n' || c == '\t' || (c >= 0x20 && c != 0x7f)) out.append(text.substr(k, length));
    k += length;
  }
  return out;
}

std::string escape_html(std::string_view text) {
  std::string out;
  for (char c : clean_utf8(text)) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  }
  return out;
}

std::vector<std::pair<std::string, std::string>> sections_of(std::string_view toml) {
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t from = 0; from < toml.size();) {
    const std::size_t end = std::min(toml.find('\n', from), toml.size());
    const std::string line(toml.substr(from, end - from));
    from = end + 1;
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    if (line.starts_with("[")) {
      out.emplace_back(line, "");
      continue;
    }
    if (out.empty()) out.emplace_back();
    std::string& text = out.back().second;
    text += (text.empty() ? "" : "; ") + line;
  }
  std::erase_if(out, [](const auto& section) { return section.second.empty(); });
  return out;
}

}  // namespace pivnp::report

// A strict reader of the XML that tests meet: tags in balance, quoted attributes, known entities, valid UTF-8.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace pivnp::app {

struct Xml {
  std::string error;  // empty: well-formed
  std::map<std::string, int> elements;
  int count(const std::string& name) const { return elements.count(name) ? elements.at(name) : 0; }
};

inline bool valid_utf8(const std::string& text) {
  for (std::size_t k = 0; k < text.size();) {
    const auto byte = static_cast<unsigned char>(text[k]);
    const std::size_t length = byte < 0x80 ? 1 : byte >> 5 == 6 ? 2 : byte >> 4 == 14 ? 3 : byte >> 3 == 30 ? 4 : 0;
    if (length == 0 || k + length > text.size()) return false;
    for (std::size_t j = 1; j < length; ++j)
      if ((static_cast<unsigned char>(text[k + j]) & 0xC0) != 0x80) return false;
    k += length;
  }
  return true;
}

// Character data: no markup, no control characters, entities known.
inline bool valid_text(const std::string& text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    if (byte < 0x20 && byte != '\n' && byte != '\t' && byte != '\r') return false;
    if (text[k] == '<') return false;
    if (text[k] != '&') continue;
    const std::string entity = text.substr(k, text.find(';', k) - k + 1);
    bool known = false;
    for (const char* e : {"&amp;", "&lt;", "&gt;", "&quot;", "&#9;", "&#10;", "&#13;"}) known = known || entity == e;
    if (!known) return false;
  }
  return true;
}

inline bool valid_attributes(std::string text) {
  while (!text.empty()) {
    if (text[0] != ' ') return false;
    const std::size_t quote = text.find("=\""), end = quote == std::string::npos ? quote : text.find('"', quote + 2);
    if (end == std::string::npos || quote < 2 || text.find(' ', 1) < quote) return false;
    if (!valid_text(text.substr(quote + 2, end - quote - 2))) return false;
    text = text.substr(end + 1);
  }
  return true;
}

// Where the tag that begins at `open` ends: a > outside quotes.
inline std::size_t tag_end(const std::string& text, std::size_t open) {
  bool quoted = false;
  for (std::size_t k = open; k < text.size(); ++k) {
    if (text[k] == '"') quoted = !quoted;
    if (text[k] == '>' && !quoted) return k;
  }
  return std::string::npos;
}

inline Xml read_xml(const std::string& text) {
  Xml xml;
  auto fail = [&](const std::string& why) {
    xml.error = why;
    return xml;
  };
  if (!valid_utf8(text)) return fail("not UTF-8");
  std::vector<std::string> open;
  int roots = 0;
  std::size_t at = text.starts_with("<?xml ") ? text.find("?>") + 2 : 0;
  while (at < text.size()) {
    const std::size_t tag = std::min(text.find('<', at), text.size());
    const std::string between = text.substr(at, tag - at);
    if (!valid_text(between)) return fail("text: " + between);
    if (open.empty() && between.find_first_not_of(" \n") != std::string::npos) return fail("text outside the root");
    if (tag == text.size()) break;
    const std::size_t end = tag_end(text, tag);
    if (end == std::string::npos) return fail("tag without end");
    std::string inside = text.substr(tag + 1, end - tag - 1);
    at = end + 1;
    if (inside.starts_with("/")) {
      if (open.empty() || open.back() != inside.substr(1)) return fail("closes " + inside);
      open.pop_back();
      continue;
    }
    const bool closed = inside.ends_with("/");
    if (closed) inside.pop_back();
    const std::string name = inside.substr(0, inside.find(' '));
    if (name.empty() || !valid_attributes(inside.substr(name.size()))) return fail("tag " + inside);
    ++xml.elements[name];
    roots += open.empty();
    if (!closed) open.push_back(name);
  }
  if (!open.empty()) return fail("not closed: " + open.back());
  return roots == 1 ? xml : fail("not one root");
}

}  // namespace pivnp::app

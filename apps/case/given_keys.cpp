#include "apps/case/given_keys.hpp"

#include <algorithm>

#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

void set_line(Node& node, int line) {
  node.line = line;
  for (Node& item : node.list) set_line(item, line);
  for (Entry& entry : node.entries) {
    entry.line = line;
    set_line(entry.value, line);
  }
}

}  // namespace

GivenKey parse_given_key(const std::string& text, int ordinal) {
  const std::string where = "--set:" + std::to_string(ordinal) + ": ";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(where + "found \"" + shortened(text) + "\", expected KEY=VALUE, as in piv.window_px=24");
  const std::string key = text.substr(0, equals);
  GivenKey given;
  for (std::size_t begin = 0; begin <= key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    given.path.push_back(key.substr(begin, end - begin));
    if (given.path.back().empty()) throw InputError(where + "found the key \"" + shortened(key) + "\", expected names between its dots");
    begin = end + 1;
  }
  if (given.path.size() > 4) throw InputError(where + "found a key of " + std::to_string(given.path.size()) + " parts, expected at most 4");
  given.value = parse_value(text.substr(equals + 1));
  set_line(given.value, ordinal);
  return given;
}

Node alone(const GivenKey& key) {
  Node node = key.value;
  for (std::size_t k = key.path.size(); k-- > 0;) {
    Node section;
    section.line = key.value.line;
    section.entries.push_back({key.path[k], key.value.line, std::move(node)});
    node = std::move(section);
  }
  return node;
}

void put(const GivenKey& key, Node& root, const std::string& name) {
  Node* node = &root;
  std::string dotted;
  for (std::size_t k = 0; k < key.path.size(); ++k) {
    dotted = joined_key(dotted, key.path[k]);
    const bool last = k + 1 == key.path.size();
    Entry* found = nullptr;
    for (Entry& entry : node->entries)
      if (entry.key == key.path[k]) found = &entry;
    if (!found) {
      node->entries.push_back({key.path[k], 0, Node{}});
      found = &node->entries.back();
    } else if (!last && found->value.kind != Node::Kind::table) {
      throw InputError(name + ":" + std::to_string(found->line) + ": " + dotted + ": found " + describe(found->value) +
                       ", expected a section");
    }
    if (last) {
      found->value = key.value;
      set_line(found->value, found->line);
    }
    node = &found->value;
  }
}

}  // namespace pivnp::app

// Changes to the text of a case that leave the rest of it, comments among it, as it is.
#pragma once

#include <string>
#include <vector>

namespace pivnp::app {

/// A key by its parts: {"region", "sand", "polygon_px"}.
using KeyPath = std::vector<std::string>;

/// `text` with `key` = `value`, which is TOML on one line: in place of what it had, else after the last key of its section, else in
/// a new section at the end. `name` stands in messages. Throws InputError where the text is no TOML, where a part of the key is no
/// section, or where `value` is none.
std::string with_key(const std::string& text, const std::string& name, const KeyPath& key, const std::string& value);

/// Without a key, or a section and those under it; as it is where there is none. Comments before a section stay. Throws InputError
/// as above, and for a key of a section in braces.
std::string without_key(const std::string& text, const std::string& name, const KeyPath& key);

/// A section called otherwise: `last` in place of the last part. Throws InputError as above, and where that name is taken.
std::string with_name(const std::string& text, const std::string& name, const KeyPath& section, const std::string& last);

}  // namespace pivnp::app

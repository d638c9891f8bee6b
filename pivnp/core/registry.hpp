// A list to which a row is added in one place: laws, methods, file formats, figures, metrics, fields.
#pragma once

#include <algorithm>
#include <deque>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp {

/// Rows in the order in which they were added; each has a `name` of its own. Addresses of rows stay valid while they
/// are listed. Rows are added before work starts: reading is safe from any thread, adding is not.
template <class Row>
class Registry {
 public:
  Registry() = default;
  Registry(std::initializer_list<Row> rows) {
    for (const Row& row : rows) add(row);
  }

  auto begin() const { return rows_.begin(); }
  auto end() const { return rows_.end(); }
  std::size_t size() const { return rows_.size(); }

  /// nullptr: no row of that name.
  const Row* find(std::string_view name) const {
    const auto at = std::find_if(begin(), end(), [&](const Row& row) { return row.name == name; });
    return at == end() ? nullptr : &*at;
  }
  /// Throws InputError "PLACE: found 'NAME', expected one of A, B or C; did you mean 'B'?".
  const Row& at(std::string_view name, const std::string& place) const {
    if (const Row* row = find(name)) return *row;
    const std::vector<std::string> known = names();
    throw InputError(place + ": found '" + std::string(name) + "', expected " + (known.size() > 1 ? "one of " : "") +
                     one_of(known) + did_you_mean(std::string(name), known));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Row& row : rows_) names.emplace_back(row.name);
    return names;
  }

  const Row& add(Row row) {
    if (find(row.name)) throw std::logic_error("registry: '" + std::string(row.name) + "' is listed twice");
    return rows_.emplace_back(std::move(row));
  }
  /// Takes the row added last off again (for tests that add one).
  void remove_last() { rows_.pop_back(); }

 private:
  std::deque<Row> rows_;
};

}  // namespace pivnp

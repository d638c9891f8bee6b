#include "pivnp/core/record/comparison.hpp"

#include <algorithm>

namespace pivnp {

namespace {

template <class T>
const T* named(const std::vector<T>& list, std::string_view name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const T& item) { return item.name == name; });
  return at == list.end() ? nullptr : &*at;
}

}  // namespace

std::string history_table(DataSetRole role) { return "history_" + std::string(name_of(role)); }

const ComparisonTable* Comparison::table(std::string_view name) const { return named(tables, name); }
const ComparisonField* Comparison::field(std::string_view name) const { return named(fields, name); }

const std::vector<double>& Comparison::times() const {
  static const std::vector<double> none;
  for (const std::string& name : {std::string(over_space_table), history_table(DataSetRole::first)})
    if (const ComparisonTable* held = table(name))
      if (const ComparisonTable::Column* time = find(*held, "time")) return time->values;
  return fields.empty() ? none : fields[0].time;
}

const ComparisonTable::Column* find(const ComparisonTable& table, std::string_view column) {
  return named(table.columns, column);
}

}  // namespace pivnp

// A row that a test adds to a registry, for as long as the test's scope.
#pragma once

#include <utility>

#include "pivnp/core/registry.hpp"

namespace pivnp::test {

template <class Row>
class Added {
 public:
  Added(Registry<Row>& registry, Row row) : registry_(registry) { registry_.add(std::move(row)); }
  ~Added() { registry_.remove_last(); }
  Added(const Added&) = delete;
  Added& operator=(const Added&) = delete;

 private:
  Registry<Row>& registry_;
};

}  // namespace pivnp::test

// A drawn figure as the report carries it.
#pragma once

#include <memory>
#include <string>

namespace pivnp::report {

class Sheet;  // apps/plot/canvas.hpp, Qt

struct Figure {
  std::string name;  // of its files
  std::string caption;
  std::shared_ptr<const Sheet> sheet;
};

}  // namespace pivnp::report

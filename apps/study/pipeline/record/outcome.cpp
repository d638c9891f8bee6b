#include "apps/study/pipeline/record/outcome.hpp"

namespace pivnp::app {

void add_camera(double residual, compare::CompareOptions& options) {
  if (!options.measurement_uncertainty_m && residual > 0) options.measurement_uncertainty_m = residual;
}

}  // namespace pivnp::app

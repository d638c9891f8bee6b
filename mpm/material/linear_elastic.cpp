#include "mpm/material/linear_elastic.hpp"

namespace pivnp::mpm {

void LinearElastic::update(const StressBatch& batch) const {
  for (std::size_t k = 0; k < batch.size; ++k) store(batch, k, elastic_trial(elastic_, batch, k));
}

}  // namespace pivnp::mpm

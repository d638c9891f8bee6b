#include "compare/metrics/numerical.hpp"

#include <cmath>

#include "compare/metrics/significance.hpp"
#include "compare/uncertainty/numerics.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

std::vector<std::string> add_numerical(std::vector<Metric>& metrics, const std::vector<std::vector<Metric>>& coarser,
                                       double ratio) {
  std::vector<std::string> outside;
  for (Metric& m : metrics) {
    if (!std::isfinite(m.factor) || !std::isfinite(m.value) || made_of_u_val(m.name)) continue;
    std::vector<double> values{m.value};
    for (const std::vector<Metric>& grid : coarser)
      if (const Metric* same = find(grid, m.name); same != nullptr && std::isfinite(same->value)) values.push_back(same->value);
    if (values.size() != coarser.size() + 1) continue;
    const GridConvergence g = grid_convergence(values, ratio);
    const double change = std::abs(values[0] - values[1]);
    double u = g.factor * change;
    if (!(change > 0)) u = values.size() > 2 ? std::abs(values[1] - values[2]) : 0;
    const bool three = values.size() > 2;
    m.definition += "; with u_num = " + number(u, 2) +
                    (g.asymptotic ? " (GCI of three grids, order " + number(g.order, 2) + ")"
                     : three      ? " (range over three grids: out of the asymptotic range, no bound)"
                                  : " (change from one coarser grid: the order is not known, no bound)");
    if (three && !g.asymptotic) outside.push_back(m.name);
    if (std::isnan(m.uncertainty)) continue;  // the measurement's part is not known, and u_num alone is no u_val
    m.uncertainty = std::hypot(m.uncertainty, u);
    m.numerical = u;
  }
  return outside;
}

}  // namespace pivnp::compare

#include "compare/metrics/numerical.hpp"

#include <cmath>
#include <string_view>

#include "compare/uncertainty/numerics.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

// Those whose uncertainty is made of u_val, which has the grid's error in it.
bool holds_it_already(std::string_view name) {
  for (const std::string_view family : {"displacement_", "velocity_", "area_metric_displacement", "decomposition_displacement",
                                        "point_"})
    if (name.starts_with(family)) return true;
  return false;
}

}  // namespace

std::vector<std::string> add_numerical(std::vector<Metric>& metrics, const std::vector<std::vector<Metric>>& coarser,
                                       double ratio) {
  std::vector<std::string> outside;
  for (Metric& m : metrics) {
    if (!std::isfinite(m.factor) || !std::isfinite(m.value) || m.verdict == Verdict::withheld || holds_it_already(m.name))
      continue;
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
    if (m.verdict == Verdict::none || m.verdict == Verdict::not_distinguishable)
      m.verdict = std::abs(m.value) < m.factor * m.uncertainty ? Verdict::not_distinguishable : Verdict::none;
  }
  return outside;
}

}  // namespace pivnp::compare

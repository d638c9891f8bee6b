#include "compare/measures/points.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/data/statistics.hpp"
#include "compare/data/triangulation.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

std::vector<Partner> places(const std::vector<Vec2>& points, const DataSet& set) {
  std::vector<int> index;
  std::vector<Vec2> x;
  std::vector<double> spacing;
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!set.state().followed[p]) continue;
    index.push_back(int(p));
    x.push_back(set.material_position()[p]);
    spacing.push_back(set.spacing()[p]);
  }
  const MaterialMesh mesh(std::move(x), std::move(spacing));
  std::vector<Partner> out;
  for (const Vec2& point : points) {
    Partner place = mesh.find_natural(point).value_or(Partner{});
    place.renumber(index);
    out.push_back(place);
  }
  return out;
}

}  // namespace

PointHistories::PointHistories(const CompareOptions& options, const DataSet& first, const DataSet& second)
    : sets_{&first, &second}, gauge_(options.gauge_uncertainty) {
  for (const double u : {options.measurement_uncertainty_m.value_or(0), options.numerical_uncertainty_m,
                         options.input_uncertainty_m})
    given_ += 2 * u * u;  // both components
  points_ = positions_of(options.points_m);
  if (points_.empty()) return;
  for (std::size_t s = 0; s < 2; ++s)
    for (const Partner& place : places(points_, *sets_[s])) tracks_[s].push_back({place, {}, 0, 0});
  shared_.assign(points_.size(), 0);
}

void PointHistories::add(const DataSetState& first, const DataSetState& second, const PerDataSet<RigidFit>& frame,
                         const std::vector<Vec2>& numerical) {
  if (points_.empty()) return;
  time_.push_back(first.time);
  const PerDataSet<const DataSetState*> states{&first, &second};
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Track& track = tracks_[s][k];
      if (!track.place.rests_on(states[s]->followed)) track.place = places({points_[k]}, *sets_[s]).front();
      if (!has_partner(track.place)) {
        track.u.push_back(Vec2::Constant(not_known));
        continue;
      }
      const PartnerState at = partner_state(track.place, *states[s]);
      track.u.push_back(frame[s].motion.undo(points_[k] + at.u) - points_[k]);
      shared_[k] += frame[s].variance_at(points_[k]).sum();
      if (s == 0 && !numerical.empty())
        for (const Natural::Share& share : track.place.shares)
          shared_[k] += share.weight * numerical[std::size_t(share.point)].squaredNorm();
      if (states[s]->cov.empty()) continue;
      track.variance += at.cov[0] + at.cov[1];
      ++track.known;
    }
}

PointMeasures PointHistories::measure(const std::string& unit, const std::string& time_unit) const {
  PointMeasures out;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const std::string name = "point_" + std::to_string(k + 1);
    const std::string where = "(" + number(points_[k].x()) + ", " + number(points_[k].y()) + ")";
    PerDataSet<TimeHistory> size;
    HistoryErrors errors;
    double variance = given_ + shared_[k] / double(std::max<std::size_t>(1, time_.size())), greatest = 0;
    bool known = variance > 0;
    ComparisonTable table{name, "displacement of the material point " + where + " on both data sets",
                          {{"time", time_unit, time_}}};
    for (const DataSetRole role : data_set_roles) {
      const auto s = std::size_t(role);
      const Track& track = tracks_[s][k];
      size[s].time = time_;
      std::array<std::vector<double>, 2> component;
      for (const Vec2& u : track.u) {
        size[s].value.push_back(u.norm());
        component[0].push_back(u.x());
        component[1].push_back(u.y());
      }
      const std::string of(name_of(role));
      table.columns.push_back({"x_" + of, unit, std::move(component[0])});
      table.columns.push_back({"y_" + of, unit, std::move(component[1])});
      for (const Vec2& u : track.u)
        if (role == DataSetRole::first && u.norm() > greatest) greatest = u.norm();
      if (track.known == 0) continue;
      errors.own[s] = std::sqrt(track.variance / double(track.known));
      variance += track.variance / double(track.known);
      known = true;
    }
    known = known || gauge_ > 0;
    if (known) errors.difference = std::sqrt(variance + gauge_ * gauge_ * greatest * greatest);
    auto found = measure_histories(name, "|u| of the material point " + where, size[0], size[1], errors, unit, time_unit);
    if (!found) {
      out.lost.push_back(where);
      continue;
    }
    ScalarStatistics distance;
    for (std::size_t t = 0; t < time_.size(); ++t) {
      const double d = (tracks_[1][k].u[t] - tracks_[0][k].u[t]).norm();
      if (std::isfinite(d)) distance.add(d);
    }
    found->distance_rms = distance.rms();
    out.histories.push_back(std::move(*found));
    out.tables.push_back(std::move(table));
  }
  return out;
}

}  // namespace pivnp::compare

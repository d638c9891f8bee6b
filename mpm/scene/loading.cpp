#include "mpm/scene/loading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/scene/scene_setup.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// 0 before `from`, 1 from `until` on, linear between.
double share_between(double from, double until, double time) {
  if (time >= until) return 1;
  return time <= from ? 0 : (time - from) / (until - from);
}

[[noreturn]] void refuse_loading(const std::string& key, double found, const std::string& expected) {
  throw InputError(key + ": found " + number(found) + ", expected " + expected);
}

}  // namespace

Loading::Loading(const MpmOptions& o, const Scene& scene)
    : from_(o.gravity_m_s2[0], o.gravity_m_s2[1]), to_(from_), materials_(scene.materials),
      tractions_(scene.boundaries, scene.particles, scene.grid.spacing) {
  if (o.gravity_from_m_s2.has_value() != o.gravity_ramp_s.has_value())
    throw InputError(std::string("mpm.") + (o.gravity_ramp_s ? "gravity_ramp_s" : "gravity_from_m_s2") +
                     ": given alone, expected gravity_from_m_s2 and gravity_ramp_s");
  if (o.gravity_ramp_s) {
    ramp_ = *o.gravity_ramp_s;
    if (!(ramp_ > 0)) refuse_loading("mpm.gravity_ramp_s", ramp_, "a time above 0 s");
    from_ = {(*o.gravity_from_m_s2)[0], (*o.gravity_from_m_s2)[1]};
    changes_.push_back(ramp_);
  }
  if (scene.centrifuge) {
    centrifuge_.emplace(*scene.centrifuge, o.geometry == Geometry::axisymmetric);
    changes_.insert(changes_.end(), centrifuge_->changes().begin(), centrifuge_->changes().end());
  }
  for (const MaterialOptions& m : materials_) {
    if (m.density_end_kg_m3) {
      any_density_ = true;
      changes_.insert(changes_.end(), {m.density_from_s, *m.density_until_s});
    }
    if (m.reduction_factor) {
      any_reduction_ = true;
      changes_.insert(changes_.end(), {m.reduction_from_s, m.reduction_until_s.value_or(m.reduction_from_s)});
    }
    if (m.removed_s) changes_.push_back(*m.removed_s);
  }
  changes_.insert(changes_.end(), tractions_.changes().begin(), tractions_.changes().end());
  std::sort(changes_.begin(), changes_.end());
  if (!changes_.empty()) last_ = changes_.back();
}

Vec2 Loading::gravity(double time) const {
  return ramp_ > 0 && time < ramp_ ? Vec2(from_ + time / ramp_ * (to_ - from_)) : to_;
}

double Loading::density_ratio(std::size_t material, double time) const {
  const MaterialOptions& m = materials_[material];
  if (!m.density_end_kg_m3) return 1;
  return 1 + (*m.density_end_kg_m3 / m.density_kg_m3 - 1) * share_between(m.density_from_s, *m.density_until_s, time);
}

double Loading::reduction(std::size_t material, double time) const {
  const MaterialOptions& m = materials_[material];
  if (!m.reduction_factor) return 1;
  const double until = m.reduction_until_s.value_or(m.reduction_from_s);
  return 1 + (*m.reduction_factor - 1) * share_between(m.reduction_from_s, until, time);
}

double Loading::removal(std::size_t material) const { return materials_[material].removed_s.value_or(never); }

double Loading::next_change(double time) const {
  const auto it = std::upper_bound(changes_.begin(), changes_.end(), time);
  return it == changes_.end() ? never : *it;
}

}  // namespace pivnp::mpm

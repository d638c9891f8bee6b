// What axial symmetry and a centrifuge do not go with, and the axis.
#include <algorithm>
#include <cmath>

#include "mpm/solver/impl.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

constexpr double on_axis = 1e-9;  // cells

[[noreturn]] void refuse(const std::string& key, const std::string& what) { throw InputError(key + ": " + what); }

void check_axisymmetric(const MpmOptions& o, const Scene& s) {
  const std::string run = " in an axisymmetric run, ";
  if (s.grid.origin.x() < -on_axis * s.grid.spacing.x())
    refuse("mpm.domain_m", "the simulation's grid begins at x = " + number(s.grid.origin.x()) + run + "expected 0, the axis, or more");
  if (o.gravity_m_s2[0] != 0) refuse("mpm.gravity_m_s2", "found " + number(o.gravity_m_s2[0]) + " along x" + run + "expected 0");
  if (o.gravity_from_m_s2 && (*o.gravity_from_m_s2)[0] != 0)
    refuse("mpm.gravity_from_m_s2", "found " + number((*o.gravity_from_m_s2)[0]) + " along x" + run + "expected 0");
  if (o.sleep_below_m_s) refuse("mpm.sleep_below_m_s", "given" + run + "expected none");
  if (s.heat) refuse("heat", "given" + run + "which has no conduction; expected geometry = \"plane\"");
  if (!s.contacts.empty()) refuse("contact." + s.contacts.front().first, "given" + run + "expected none");
  for (const auto& [name, b] : s.boundaries)
    if (b.type == BoundaryType::tied) refuse("boundary." + name + ".type", "found tied" + run + "expected another type");
  for (const auto& [name, b] : s.bodies) {
    if (b.mass_kg_m) refuse("body." + name + ".mass_kg_m", "given" + run + "expected a body with prescribed motion");
    if (b.angular_velocity_rad_s != 0 || b.motion_table.courses[0].given() || b.motion_table.courses[2].given())
      refuse("body." + name + (b.angular_velocity_rad_s != 0 ? ".angular_velocity_rad_s" : ".motion"),
             "found more than a motion along y" + run + "expected none");
    if (b.velocity_m_s[0] != 0) refuse("body." + name + ".velocity_m_s", "found " + number(b.velocity_m_s[0]) + " along x" + run + "expected 0");
  }
}

}  // namespace

Scene checked(const MpmOptions& o, Scene s) {
  const bool tied = std::any_of(s.boundaries.begin(), s.boundaries.end(), [](const auto& b) { return b.second.type == BoundaryType::tied; });
  for (auto& [name, b] : s.boundaries)
    b.grips = (b.velocity_m_s || b.motion_table.any()) && (b.type == BoundaryType::fixed || b.type == BoundaryType::roller) && !s.water && !tied;
  if (s.centrifuge && s.water) refuse("centrifuge", "given beside [water], which takes gravity to be the same everywhere; expected one of them");
  if (s.centrifuge && !s.centrifuge->rate_history.empty() && o.sleep_below_m_s)
    refuse("mpm.sleep_below_m_s", "given beside centrifuge.rate_history, expected none");
  if (o.geometry != Geometry::axisymmetric) return s;
  check_axisymmetric(o, s);
  if (s.grid.origin.x() > on_axis * s.grid.spacing.x()) return s;  // a ring
  BoundaryOptions axis;
  axis.type = BoundaryType::roller;
  axis.line_m = {{s.grid.origin.x(), s.grid.origin.y()}, {s.grid.origin.x(), s.grid.upper().y()}};
  axis.normal = Pair{-1.0, 0.0};
  s.boundaries.emplace_back(axis_boundary, axis);
  return s;
}

}  // namespace pivnp::mpm

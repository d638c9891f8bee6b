#include "apps/study/frontier/chain/whole_settings.hpp"

namespace pivnp::app {

namespace {

// The default's methods, tests and windows as the case has them.
void standard_measurement(Case& c) {
  const piv::PivOptions plain;
  c.piv->method = plain.method, c.piv->smoothing = plain.smoothing, c.piv->order = plain.order, c.piv->passes = plain.passes;
  const np::NpOptions particles;
  c.np->shape = particles.shape, c.np->gradient = particles.gradient, c.np->per_element = particles.per_element;
  c.np->seeding = particles.seeding, c.np->drift = particles.drift;
}

bool standard(const Case& c) {
  const piv::PivOptions plain;
  const np::NpOptions particles;
  const bool recommended = c.piv->method == plain.method || c.piv->method == "gn";
  return recommended && c.piv->smoothing == plain.smoothing && c.piv->passes == plain.passes && c.np->shape == particles.shape &&
         c.np->gradient == particles.gradient && c.np->per_element == particles.per_element && c.np->drift == particles.drift;
}

Case complete(const Case& c) {
  Case out = c;
  out.piv = c.piv.value_or(piv::PivOptions{});
  out.np = c.np.value_or(np::NpOptions{});
  return out;
}

void standard_simulation(Case& c) {
  const mpm::MpmOptions plain;
  c.mpm->scheme = plain.scheme, c.mpm->shape = plain.shape, c.mpm->transfer = plain.transfer, c.mpm->stress_update = plain.stress_update;
  c.mpm->locking = plain.locking, c.mpm->per_element = plain.per_element, c.mpm->courant = plain.courant, c.mpm->pic_per_s = plain.pic_per_s;
}

bool standard_scheme(const mpm::MpmOptions& o) {
  const mpm::MpmOptions plain;
  return o.scheme == plain.scheme && !o.shape && !o.transfer && !o.stress_update && !o.locking && !o.pic_per_s && o.per_element == plain.per_element &&
         o.courant == plain.courant;
}

}  // namespace

Case WholeSetting::applied(const Case& c) const {
  Case out = complete(c);
  if (change) change(out);
  return out;
}

std::vector<WholeSetting> measurement_settings(const Case& c, bool own) {
  std::vector<WholeSetting> all;
  const bool is_standard = standard(complete(c));
  if (own && !is_standard) all.push_back({"the case's", "as it is", {}, true, false, 1});
  all.push_back({"default", is_standard ? "as it is" : "piv.method=default piv.smoothing=adaptive np.shape=bspline3 np.per_element=4 np.drift=none", standard_measurement,
                 own && is_standard, true, 1});
  all.push_back({"fast", "piv.method=fast np.per_element=1", [](Case& o) {
                   standard_measurement(o);
                   o.piv->method = "fast";
                   o.np->per_element = 1;
                 }});
  all.push_back({"subsets", "piv.smoothing=window", [](Case& o) {
                   standard_measurement(o);
                   o.piv->smoothing = piv::Smoothing::window;
                 }});
  all.push_back({"fine", "np.shape=bspline3 np.per_element=9 np.drift=corrected", [](Case& o) {
                   standard_measurement(o);
                   o.np->shape = np::ShapeFunctions::bspline3;
                   o.np->per_element = 9;
                   o.np->drift = np::DriftScheme::corrected;
                 }});
  return all;
}

std::vector<WholeSetting> simulation_settings(const Case& c, bool own) {
  std::vector<WholeSetting> all;
  const bool is_standard = standard_scheme(*c.mpm);
  if (own && !is_standard) all.push_back({"the case's scheme", "as it is", {}, true, false, 1});
  all.push_back({"default scheme", is_standard ? "as it is" : "mpm.scheme=default", standard_simulation, own && is_standard, true, 1});
  all.push_back({"coarse cells", "grid spacing of the simulation times 2", standard_simulation, false, false, 2});
  all.push_back({"long steps", "mpm.courant=0.8", [](Case& o) {
                   standard_simulation(o);
                   o.mpm->courant = 0.8;
                 }});
  return all;
}

}  // namespace pivnp::app

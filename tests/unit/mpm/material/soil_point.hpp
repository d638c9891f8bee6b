// A material point on its own, for tests of laws.
#pragma once

#include <cstdint>
#include <string>

#include "mpm/material/abbo_sloan.hpp"
#include "mpm/material/model.hpp"

namespace pivnp::mpm::test {

struct SoilPoint {
  Tensor stress{};
  double plastic_dev = 0, dissipated = 0, opening = 0, J = 1;
  std::uint8_t separated = 0;

  void advance(const Material& law, Tensor de, double spin = 0, double dt = 0) {
    StressBatch b{};
    b.size = 1;
    b.de_xx = &de[0];
    b.de_yy = &de[1];
    b.de_zz = &de[2];
    b.de_xy = &de[3];
    b.spin = &spin;
    b.J = b.F_xx = b.F_xy = b.F_yx = b.F_yy = &J;
    b.xx = &stress[0];
    b.yy = &stress[1];
    b.zz = &stress[2];
    b.xy = &stress[3];
    b.history = {&plastic_dev, &dissipated, &opening};
    b.flags = {&separated};
    b.dt = dt;
    law.update(b);
  }
  double energy(const Material& law) const { return law.elastic().energy(stress[0], stress[1], stress[2], stress[3]); }
  double mean() const { return (stress[0] + stress[1] + stress[2]) / 3; }
  double bar() const { return Invariants(stress).bar; }
};

inline MaterialOptions soil(const std::string& model, double friction = 30, double cohesion = 0) {
  MaterialOptions m;
  m.model = model;
  m.density_kg_m3 = 1600;
  m.young_pa = 1e7;
  m.poisson = 0.3;
  m.friction_deg = friction;
  m.cohesion_pa = cohesion;
  return m;
}

}  // namespace pivnp::mpm::test

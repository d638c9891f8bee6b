// The fields of the points, listed once: memory, sorting, checkpoints, what kernels and laws see, and frames walk the list.
// The history variables of laws (history.hpp) are not among them.
#pragma once

#include <string_view>
#include <type_traits>
#include <vector>

#include "mpm/state/particles.hpp"
#include "mpm/state/stress_batch.hpp"
#include "mpm/state/views.hpp"

namespace pivnp::mpm {

struct ParticleField {
  std::string_view name, unit, definition;
  bool ParticleNeeds::*need = nullptr;  // without it the field has no values; null: every case has it
  bool state = true;                    // sorted and saved; else of one step
  std::string_view recorded = {};       // the motion field that holds it; empty: none
  bool per_volume = false;              // recorded per volume as it is, not as it was at the start: divided by J
};

/// A component: where its values are, and where kernels and laws see them. `laws_read`: laws see it, but do not change it.
template <class Values>
struct Column {
  Values Particles::*values;
  double* PointView::*kernels = nullptr;
  double* StressBatch::*laws = nullptr;
  const double* StressBatch::*laws_read = nullptr;
};
template <class Values, class... Views>
Column(Values Particles::*, Views...) -> Column<Values>;

/// Calls visit(field, column, ...) with a column for each component.
template <class Visit>
inline void for_each_particle_field(Visit&& visit) {
  using P = Particles;
  using K = PointView;
  using L = StressBatch;
  using N = ParticleNeeds;
  visit(ParticleField{"place", "m", "where the point is"}, Column{&P::x, &K::x}, Column{&P::y, &K::y});
  visit(ParticleField{.name = "velocity", .unit = "m/s", .definition = "velocity", .recorded = "v"}, Column{&P::vx, &K::vx},
        Column{&P::vy, &K::vy});
  visit(ParticleField{"volume0", "m^2", "volume at the start, per metre of thickness (axisymmetric: per radian, m^3)"}, Column{&P::volume0, &K::volume0});
  visit(ParticleField{"mass", "kg/m", "mass; one dry body needs none (Particles::mass_of)", &N::own_mass},
        Column{&P::mass, &K::mass});
  visit(ParticleField{.name = "F", .unit = "1", .definition = "deformation gradient, of the point's own velocity gradient",
                      .recorded = "F"},
        Column{&P::F_xx, &K::F_xx, nullptr, &L::F_xx}, Column{&P::F_xy, &K::F_xy, nullptr, &L::F_xy},
        Column{&P::F_yx, &K::F_yx, nullptr, &L::F_yx}, Column{&P::F_yy, &K::F_yy, nullptr, &L::F_yy});
  visit(ParticleField{"hoop F", "1", "radius over that at the start", &N::axisymmetric}, Column{&P::F_zz, &K::F_zz, nullptr, &L::F_zz});
  visit(ParticleField{"hoop increment", "1", "log hoop strain of the step", &N::axisymmetric, false}, Column{&P::hoop, &K::hoop});
  visit(ParticleField{"J", "1", "volume ratio, of the averaged volumetric strain"}, Column{&P::J, &K::J, nullptr, &L::J});
  visit(ParticleField{.name = "stress", .unit = "Pa", .definition = "Kirchhoff stress, tension positive", .recorded = "stress",
                      .per_volume = true},
        Column{&P::tau_xx, &K::tau_xx, &L::xx}, Column{&P::tau_yy, &K::tau_yy, &L::yy},
        Column{&P::tau_zz, &K::tau_zz, &L::zz}, Column{&P::tau_xy, &K::tau_xy, &L::xy});
  visit(ParticleField{.name = "pressure", .unit = "Pa", .definition = "pressure of the water in the pores, compression positive",
                      .need = &N::wet, .recorded = "pressure"},
        Column{&P::pressure, &K::pressure});
  visit(ParticleField{"J at the flow", "1", "J when water last flowed", &N::wet}, Column{&P::J_flow});
  visit(ParticleField{"J before", "1",
                      "J at the end of the last flow; J at the flow has what the pores swelled by since then added",
                      &N::swells},
        Column{&P::J_strained});
  visit(ParticleField{"soil", "m^2/(Pa s), 1", "mobility of the water, and the share of the grains in the initial volume", &N::soils},
        Column{&P::mobility}, Column{&P::solid});
  visit(
      ParticleField{
          "displacing", "1",
          "of the volume that opens, the share that displaces water outside; pores that change places with it have 0",
          &N::drains},
      Column{&P::displacing, &K::displacing});
  visit(ParticleField{"wetted", "1", "greatest share of the pores that was full so far", &N::collapses}, Column{&P::wetted});
  visit(ParticleField{"content", "1", "volume of the water without pressure, in a unit of initial volume", &N::wet}, Column{&P::content});
  visit(ParticleField{.name = "temperature", .unit = "degC", .definition = "temperature, degrees Celsius", .need = &N::heated,
                      .recorded = "temperature"},
        Column{&P::temperature});
  visit(ParticleField{"heated by", "J/m^3", "plastic work that has become heat, per initial volume", &N::heated}, Column{&P::heated_by});
  visit(ParticleField{"swelling", "1", "volume by which water and grains have swollen, in a unit of initial volume", &N::swells},
        Column{&P::swelling});
  visit(ParticleField{"shift", "Pa", "by how much strength sees less compression than the mean, as a Kirchhoff stress", &N::banded},
        Column{&P::shift, nullptr, nullptr, &L::shift});
  visit(ParticleField{"sheared", "1", "plastic strain at the last look at the width of bands' surroundings", &N::banded}, Column{&P::sheared});
  visit(ParticleField{"band work", "J/m^3", "plastic work that the band has not taken yet, per initial volume", &N::banded}, Column{&P::band_work});
  visit(ParticleField{.name = "band width", .unit = "L", .definition = "width into which the cells localise", .need = &N::banded,
                      .recorded = "band_width"},
        Column{&P::band_width});
  visit(ParticleField{"affine velocity", "1/s", "affine velocity field of APIC", &N::affine}, Column{&P::C_xx, &K::C_xx},
        Column{&P::C_xy, &K::C_xy}, Column{&P::C_yx, &K::C_yx}, Column{&P::C_yy, &K::C_yy});
  visit(ParticleField{"carried", "m", "by how much a tied side has set the point back (tied_sides.hpp)", &N::tied},
        Column{&P::carried_x}, Column{&P::carried_y});
  visit(ParticleField{"half", "1", "half side over the cell's (uGIMP)", &N::sized}, Column{&P::half, &K::half});
  visit(ParticleField{"cell", "", "lower left node of the stencil, or Particles::ended"}, Column{&P::cell});
  visit(ParticleField{"index", "", "place in the ParticleSet"}, Column{&P::index});
  visit(ParticleField{"natural place", "1", "natural coordinates before the points moved (Where::kept)", &N::kept, false},
        Column{&P::xi, &K::xi}, Column{&P::eta, &K::eta});
  visit(ParticleField{"increments", "1", "strain and rotation of the step, where stress follows apart", &N::increments, false},
        Column{&P::de_xx, nullptr, nullptr, &L::de_xx}, Column{&P::de_yy, nullptr, nullptr, &L::de_yy},
        Column{&P::de_zz, nullptr, nullptr, &L::de_zz}, Column{&P::de_xy, nullptr, nullptr, &L::de_xy},
        Column{&P::spin, nullptr, nullptr, &L::spin});
  visit(ParticleField{"softened_by", "1", "plastic strain of the surroundings (transfer/nonlocal.hpp)", &N::averaged, false},
        Column{&P::softened_by, nullptr, nullptr, &L::softened_by});
}

/// The points `begin` to `begin + size` of a body, as its law sees them.
StressBatch batch_of(Particles& p, const Particles::Body& body, std::size_t begin, std::size_t size);

}  // namespace pivnp::mpm

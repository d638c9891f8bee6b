// What a case's geometry comes to once the frames' size is known: camera, mask, grid, regions, seeds.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "mpm/step/solver.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/image/camera.hpp"
#include "pivnp/image/mask.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

struct Setting {
  int width = 0, height = 0;  // of the frames, px; 0 without frames
  image::Camera camera;
  image::Mask mask;
  Grid grid;                    // the shared nodes
  std::vector<Region> regions;  // in the world; the whole grid if the case names none
};

/// Throws InputError where grid, masks or regions do not fit the frames. `width` = 0: no frames; the grid then comes
/// from [grid] area_m and spacing_m, or from the MPM domain or the regions' extent.
Setting make_setting(const Case& c, int width, int height);

/// Where the grid's nodes are in the image.
piv::NodeLattice node_lattice(const Setting& setting);

/// Pixels from node to node at the image's centre.
double node_spacing_px(const Setting& setting);

/// Vectors of one pair brought to the world: both ends of a vector go through the camera.
VectorField world_vectors(const piv::PixelVectors& pixels, const piv::NodeLattice& lattice, const Setting& setting,
                          std::array<int, 2> pair);

/// The numerical particles at the first frame: none under the mask.
ParticleSet seed_particles(const Case& c, const Setting& setting);

/// The simulation's scene on the same nodes: `options` refine, extend and seed; materials by region. Material points
/// under the mask are kept (masks hide, they do not dig), those inside a rigid body are not seeded.
mpm::Scene make_scene(const Case& c, const Setting& setting, const mpm::MpmOptions& options,
                      const Named<mpm::MaterialOptions>& materials, const std::string& materials_table);

/// The case's simulation of make_scene(). What the solver refuses is told with the case's file.
mpm::Solver make_solver(const Case& c, const Setting& setting, int threads);

}  // namespace pivnp::app

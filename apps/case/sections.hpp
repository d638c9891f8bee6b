// The sections of a case, listed once: reading, writing and the reference walk this list.
#pragma once

#include "apps/case/case.hpp"

namespace pivnp::app {

/// Calls, in the order in which a case is written,
///   visit.always(path, options, text)    a section that is there whether or not the file has it,
///   visit.optional(path, options, text)  a std::optional of options: there if the file has it,
///   visit.named(path, list, text)        sections [path.NAME] with names of the user's choice.
/// A section under another ("synth.mpm" under "synth") follows it.
template <class C, class Visitor>
void for_each_section(C& c, Visitor&& visit) {
  visit.optional("frames", c.frames, "Images or a video of the experiment.");
  visit.optional("vectors", c.vectors,
                 "Displacement increments that another program measured, in place of [piv]; their grid is the grid of the "
                 "case. With [frames] the report shows them on the pictures.");
  visit.always("camera", c.camera, "Between pixels and the world. Without a scale or targets, lengths are in pixels.");
  visit.always("camera.motion", c.camera_motion,
               "A camera that was bumped, shakes, or drifts on its tripod: how it moved is measured against what is at rest, "
               "removed from every vector, and reported.");
  visit.always("grid", c.grid, "The one grid of PIV, numerical particles and simulation.");
  visit.named("region", c.regions,
              "Where material is at the first frame; one section per piece, with one outline. Without any region the "
              "whole grid is measured.");
  visit.named("mask", c.masks, "What must not be measured; one section per mask, with one shape.");
  visit.optional("preprocess", c.preprocess,
                 "What is done to frames before they are correlated. Left out: nothing, as the default methods follow "
                 "changes of light by "
                 "themselves; `pivnp check` shows on pairs made of the case's own frames which filter would help.");
  visit.optional("piv", c.piv, "Image correlation. There by default when there are frames and no [vectors].");
  visit.optional("np", c.np, "Numerical particles. There by default when there are frames or [vectors].");
  visit.named("material", c.materials, "What the regions are made of, for the simulation.");
  visit.optional("mpm", c.mpm, "The simulation; left out, the case only measures.");
  visit.named("initial", c.initial, "What the simulation of a region starts with; one section a region, of the region's name. Left out: at rest, with the stress of mpm.initial_equilibrium or mpm.k0.");
  visit.named("boundary", c.boundaries, "Restraints on the simulation's nodes; each with a line or a polygon.");
  visit.named("body", c.bodies, "Rigid bodies with prescribed motion; each a circle or a polygon.");
  visit.named("contact", c.contacts, "Contact between bodies of the simulated material, which may slide with friction and separate. Without any they stick together. Example: datasets/sand_slope_1g/glass.toml.");
  visit.optional("centrifuge", c.centrifuge, "The acceleration field of a centrifuge, beside mpm.gravity_m_s2, which is then stated: Earth's, as far as it acts in the plane of the simulation. Example: datasets/slope_50g/beam.toml.");
  visit.optional("water", c.water, "Water in the pores of materials that have a porosity. Example: datasets/terzaghi.");
  visit.optional("heat", c.heat, "Temperature: plastic work and the flow of the water produce heat, which expands water and soil. Materials then need a specific heat and a conductivity.");
  visit.always("compare", c.compare, "How measurement and simulation are compared.");
  visit.always("compare.limits", c.limits, "Limits; one that is exceeded ends the program with exit code 3.");
  visit.always("report", c.report, "What the report shows.");
  visit.always("report.hardware", c.report.hardware, "Camera and specimen as the report's table of the measurement states them; free text.");
  visit.named("report.line", c.report.lines, "Cross-sections and virtual extensometers that the report draws; one section per line.");
  visit.always("output", c.output, "What the record stores.");
  visit.optional("synth", c.synth,
                 "Synthetic frames with known truth: drawn by `pivnp synth`, and by `pivnp run` when "
                 "no frames are given.");
  visit.always("synth.texture", c.texture, "The look of synthetic frames.");
  visit.always("synth.camera", c.synth_camera, "How the camera that films synthetic frames moves.");
  visit.named("synth.material", c.synth_materials, "Materials of the simulation that carries the texture.");
  visit.optional("synth.mpm", c.synth_mpm,
                 "The simulation that carries the texture (motion = \"mpm\"); it uses the "
                 "regions, boundaries and bodies of the case.");
  visit.always("verify", c.verify, "Thresholds that `pivnp verify` checks in a case with known truth.");
}

}  // namespace pivnp::app

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
                 "Displacement increments of another program, in place of [piv]; their grid is that of the case.");
  visit.always("camera", c.camera, "From pixels to the world.");
  visit.always("camera.motion", c.camera_motion,
               "A camera that shakes or drifts: its motion against what is at rest is removed from every vector.");
  visit.always("grid", c.grid, "The one grid of PIV, numerical particles and simulation.");
  visit.named("region", c.regions,
              "Material at the first frame, one outline per section. Without regions the whole grid is measured.");
  visit.named("mask", c.masks, "What must not be measured, one shape per section.");
  visit.optional("preprocess", c.preprocess, "Filters before correlation; `pivnp check` shows which would help.");
  visit.optional("piv", c.piv, "Image correlation. Default: there with frames and without [vectors].");
  visit.optional("np", c.np, "Numerical particles. Default: there with frames or [vectors].");
  visit.named("material", c.materials, "What regions are made of. In brackets: the laws that use a key.");
  visit.optional("mpm", c.mpm, "The simulation.");
  visit.named("initial", c.initial,
              "Initial state of the region of that name. Stress and pressure hold at time 0, or where the search for the "
              "initial equilibrium begins. Default: at rest, stress by mpm.initial_equilibrium or mpm.k0.");
  visit.named("boundary", c.boundaries, "Restraints and loads on a line, or on the nodes inside a polygon.");
  visit.named("body", c.bodies, "Rigid bodies, each a circle or a polygon.");
  visit.named("contact", c.contacts,
              "Bodies of material that may slide and separate. Example: datasets/sand_slope_1g/glass.toml.");
  visit.optional("centrifuge", c.centrifuge,
                 "The acceleration of a centrifuge, added to mpm.gravity_m_s2. Example: datasets/slope_50g/beam.toml.");
  visit.optional("water", c.water, "Water in the pores of materials with a porosity. Example: datasets/terzaghi.");
  visit.optional("heat", c.heat, "Temperature, and heat from plastic work and seepage.");
  visit.always("compare", c.compare, "How measurement (the first) and simulation (the second) are compared.");
  visit.always("compare.limits", c.limits, "Greatest (`_min`: least) values; one that is missed gives exit code 3.");
  visit.always("report", c.report, "What the report shows.");
  visit.always("report.hardware", c.report.hardware, "Camera and specimen, free text for the report's table.");
  visit.named("report.line", c.report.lines, "Cross-sections and virtual extensometers in the report.");
  visit.always("output", c.output, "What the record stores.");
  visit.optional("synth", c.synth, "Synthetic frames with known truth, drawn by `pivnp synth`, or by `run` without frames.");
  visit.always("synth.texture", c.texture, "The look of synthetic frames.");
  visit.always("synth.camera", c.synth_camera, "How the camera of synthetic frames moves.");
  visit.named("synth.material", c.synth_materials, "Materials of the simulation that carries the texture.");
  visit.optional("synth.mpm", c.synth_mpm,
                 "The simulation that carries the texture (motion = \"mpm\"), with the regions, boundaries and bodies of "
                 "the case.");
  visit.always("verify", c.verify, "Greatest values that `pivnp verify` allows in a case with known truth.");
}

}  // namespace pivnp::app

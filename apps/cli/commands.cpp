#include "apps/cli/commands.hpp"

namespace pivnp::app {

const std::vector<Command>& commands() {
  static const std::vector<Command> table = {
      {"run", "run the whole chain of a case: frames, PIV, particles, simulation, comparison, report",
       "pivnp run\n"
       "pivnp run lab/case.toml --out out/lab\n"
       "pivnp run datasets/tbar --frames \"/data/tbar/IMG_*.jpg\" --threads 2",
       declare_run},
      {"init", "write a commented case for given frames",
       "pivnp init \"lab/frames/*.png\" --metres-per-pixel 2e-4 --out lab\n"
       "pivnp init lab/video.mp4 --rate-hz 240 > video_case.toml",
       declare_init},
      {"check", "validate a case and draw its first frame with grid, masks, regions and scale bar",
       "pivnp check lab/case.toml", declare_check},
      {"view", "open the window: set a case up on its frames, run it, look at its record",
       "pivnp view lab/video.mp4\n"
       "pivnp view out/lab/record.h5",
       declare_view},
      {"calibrate", "find a lens's distortion from pictures of a checkerboard, with a picture of the residuals",
       "pivnp calibrate \"board/*.png\" --corners 9x6 --square-m 0.01 --out lab/camera\n"
       "pivnp calibrate board/ --corners 11x8 --lens fisheye",
       declare_calibrate},
      {"piv", "measure a case's frames by image correlation, and stop there", "pivnp piv lab/case.toml", declare_piv},
      {"track", "measure, and follow numerical particles through the measurement", "pivnp track lab/case.toml --resume",
       declare_track},
      {"simulate", "run the simulation of a case alone", "pivnp simulate lab/case.toml --threads 4", declare_simulate},
      {"compare", "compare two motions, of one record or of two",
       "pivnp compare out/lab/record.h5:np out/lab/record.h5:mpm --slope-base-m 0.0\n"
       "pivnp compare out/a/record.h5:np out/b/record.h5:np --displacement-rms-m 1e-3 --out out/a_against_b\n"
       "pivnp compare out/lab/record.h5:np \"cbgeo=run/particles*.h5\" --step-s 1e-5 --junit limits.xml\n"
       "pivnp compare history=lab/front.csv front=out/lab/record.h5:mpm --history-rms 0.02",
       declare_compare},
      {"report", "write the report of a finished record again",
       "pivnp report out/lab/record.h5 --out out/again\n"
       "pivnp report out/lab/record.h5 --set \"report.line.crest.from_m=[0, 0.2]\" --set \"report.line.crest.to_m=[0.2, 0.2]\"",
       declare_report},
      {"query", "print a record's values and their uncertainty at points, along a line, in a rectangle, or between two points (CSV)",
       "pivnp query out/lab/record.h5:np --points \"[[0.12, 0.05], [0.2, 0.05]]\" --fields displacement_x,strain_dev\n"
       "pivnp query out/lab/record.h5:mpm --line \"[[0, 0.05], [0.3, 0.05]]\" --times 0.2,0.4\n"
       "pivnp query out/lab/record.h5:np --extensometer \"[[0.1, 0.02], [0.2, 0.02]]\" > strain.csv",
       declare_query},
      {"export", "write a record's fields as CSV, or for ParaView",
       "pivnp export out/lab/record.h5 --motions np --fields strain_dev,velocity_x --times 0.2,0.4\n"
       "pivnp export out/lab/record.h5 --format vtu --out out/paraview",
       declare_export},
      {"synth", "draw the synthetic frames of a case, with their truth",
       "pivnp synth datasets/affine_shear --out out/shear", declare_synth},
      {"verify", "run synthetic cases against their known truth and thresholds (JUnit XML); or check records for damage",
       "pivnp verify datasets/ --junit verify.xml\n"
       "pivnp verify out/lab/record.h5",
       declare_verify},
      {"frontier", "chart the speed of settings against their accuracy, on drawn texture or on a scene of your own",
       "pivnp frontier\n"
       "pivnp frontier lab/case.toml --stages piv --threads 1\n"
       "pivnp frontier --frames \"lab/frames/*.png\"",
       declare_frontier},
      {"stress", "map where methods are right, where they warn that they are not, and where they are wrong without a warning",
       "pivnp stress\n"
       "pivnp stress lab/case.toml --stages piv --seeds 4\n"
       "pivnp stress --stages piv --set piv.method=fft",
       declare_stress},
      {"sweep", "simulate a case with other values of its keys, and chart what comes of it",
       "pivnp sweep lab/case.toml --vary material.clay.permeability_m_s=1e-11,1e-9,1e-7 --vary material.clay.friction_deg=10,11,12\n"
       "pivnp sweep lab/case.toml --grid --vary grid.spacing_m=0.5,0.25 --vary material.clay.band_exchange=deviation,none --response peak_band_pressure",
       declare_sweep},
      {"element", "draw a laboratory's element tests on a material of a case: triaxial, biaxial, oedometer, isotropic, shear",
       "pivnp element lab/case.toml --test triaxial --pressure 50e3,100e3,200e3\n"
       "pivnp element lab/case.toml --material clay --test triaxial --undrained --lab tests/cu_100.csv --pressure 100e3",
       declare_element},
  };
  return table;
}

}  // namespace pivnp::app

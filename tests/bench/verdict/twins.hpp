// Twin experiments: frames drawn from a simulation's own material points, measured, and compared with that very simulation
// and with others whose soil differs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::twins {

/// What the soil is made of, and what it rests on.
struct Soil {
  double friction_deg = 30, cohesion_pa = 0;
  double base_friction = 0.4;
};

/// Something else than the drawn simulation.
struct Change {
  std::string name;  // "friction + 3 degrees"
  Soil soil;
};

/// A small test that a camera sees: 25 frames at most, cells of 8 mm.
struct Scene {
  std::string name;
  Soil soil;
  std::vector<Change> changes;
  std::string world;  // the case but for materials, camera and frames; @FRICTION@, @COHESION@ and @BASE@ stand for the soil's
  std::vector<double> area_m;  // x, y, width, height that the camera sees: 1 mm a pixel
  int frames = 25;
  double rate_hz = 100;
};
/// slope, column, punch, biaxial.
const std::vector<Scene>& scenes();

/// How the material looks in the frames.
struct Look {
  double noise = 0.02, loss = 0;
  bool soil = true, grains_deform = false;
  bool corrected = false;  // np.drift
  int seed = 1;
  std::string text() const;
};
/// Noise of 1 to 5 %, loss up to a tenth, both textures, round and deforming grains; the n-th differs from the others.
Look look(int n);

/// Shares of particles within one and two stated standard deviations of the simulation that moved them.
struct PathCoverage {
  double displacement = 0, displacement_two = 0;  // components
  double gradient = 0, gradient_two = 0;          // stretches along the axes in what F is off by
  double dev = 0, dev_two = 0, vol = 0, vol_two = 0;
};

/// Everything is written under `folder`; simulations are run once. `reuse`: records that an earlier run left there are taken as
/// they are (to compare them anew).
class Bench {
 public:
  Bench(std::filesystem::path folder, Progress& progress, bool reuse = false)
      : folder_(std::move(folder)), progress_(progress), reuse_(reuse) {}

  /// The measurement of frames drawn from the scene's own soil (motion "np").
  std::filesystem::path measured(const Scene& scene, const Look& look);
  /// How well it states its errors at a frame, against the simulation whose texture it followed.
  PathCoverage coverage(const Scene& scene, const std::filesystem::path& measured, int frame);
  /// That measurement against the simulation of a soil; `coarser`: with so many coarser grids for u_num.
  Comparison against(const Scene& scene, const std::filesystem::path& measured, const Soil& soil, int coarser = 0);
  /// Metrics of the same frames against the simulation of a soil, measured as they are ([compare] levelling) and plain.
  std::vector<Metric> levelled(const Scene& scene, const Look& look, const Soil& soil);

 private:
  std::string drawn_case(const Scene& scene, const Look& look, const Soil& soil);
  std::filesystem::path simulated(const Scene& scene, const Soil& soil, int level = 0);

  std::filesystem::path folder_;
  Progress& progress_;
  bool reuse_;
  std::map<std::string, std::filesystem::path> simulations_;
};

/// What is said of a difference: nothing (no uncertainty, or withheld), lost in it, or found.
enum class Said { nothing, lost, found };
Said said(const Metric& metric);
/// Of the displacement at the end: its RMS, or its mean, plain and weighted.
Said said_of_displacement(const Comparison& comparison);
/// The same of levelled metrics.
Said said_of_levelled_displacement(const std::vector<Metric>& metrics);
/// Of strain at the end, deviatoric or volumetric: its RMS, or its mean, plain and weighted.
Said said_of_strain(const Comparison& comparison);

}  // namespace pivnp::twins

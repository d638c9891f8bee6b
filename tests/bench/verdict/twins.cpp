#include "tests/bench/verdict/twins.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <sstream>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/studies/run.hpp"
#include "compare/compare.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"

namespace pivnp::twins {

namespace fs = std::filesystem;

namespace {

constexpr double cell_m = 0.008, pixel_m = 0.001, coarser_ratio = 1.3;

std::string digits(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

// What all scenes share.
std::string simulated_sand(const Scene& scene, const Soil& soil) {
  return R"([material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 1e6
poisson = 0.3
friction_deg = )" + digits(soil.friction_deg) + "\ncohesion_pa = " + digits(soil.cohesion_pa) + R"(
[mpm]
per_element = 4
initial_equilibrium = false
gravity_m_s2 = [0.0, -9.81]
end_s = )" + digits((scene.frames - 1) / scene.rate_hz) + "\noutput_rate_hz = " + digits(scene.rate_hz);
}

std::string world(const Scene& scene, const Soil& soil) {
  return replaced(replaced(scene.world, "@SAND@", simulated_sand(scene, soil)), "@BASE@", digits(soil.base_friction));
}

std::string area(const Scene& s) {
  const auto& a = s.area_m;
  return "area_m = [[" + digits(a[0]) + ", " + digits(a[1]) + "], [" + digits(a[0] + a[2]) + ", " + digits(a[1] + a[3]) + "]]\n";
}

app::RunSettings in(const fs::path& folder) {
  app::RunSettings settings;
  settings.out = folder;
  settings.report = false;
  settings.threads = 1;
  settings.command = "verdict_table";
  return settings;
}

// Grains as sand shows them, free to slide on a rough floor.
const char* const column = R"(
[region.sand]
polygon_m = [[0.0, 0.0], [0.12, 0.0], [0.12, 0.144], [0.0, 0.144]]
@SAND@
[body.floor]
polygon_m = [[-0.016, -0.016], [0.352, -0.016], [0.352, 0.0], [-0.016, 0.0]]
friction = @BASE@
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.16]]
type = "roller"
[compare]
slope_base_m = 0.0
)";

// A slope of 45 degrees that is too steep for its cohesion.
const char* const slope = R"(
[region.sand]
polygon_m = [[0.0, 0.0], [0.28, 0.0], [0.136, 0.144], [0.0, 0.144]]
@SAND@
[body.floor]
polygon_m = [[-0.016, -0.016], [0.368, -0.016], [0.368, 0.0], [-0.016, 0.0]]
friction = @BASE@
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.16]]
type = "roller"
[compare]
slope_base_m = 0.0
)";

// Half of a footing whose weight a bed does not bear.
const char* const punch = R"(
[region.bed]
polygon_m = [[0.0, 0.0], [0.256, 0.0], [0.256, 0.12], [0.0, 0.12]]
material = "sand"
@SAND@
domain_m = [[0.0, 0.0], [0.256, 0.152]]
[body.footing]
polygon_m = [[0.0, 0.12], [0.056, 0.12], [0.056, 0.152], [0.0, 0.152]]
mass_kg_m = 200.0
turns = false
[boundary.base]
line_m = [[0.0, 0.0], [0.256, 0.0]]
type = "fixed"
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.152]]
type = "roller"
[boundary.right]
line_m = [[0.256, 0.0], [0.256, 0.152]]
type = "roller"
)";

// A specimen under a plate that is too heavy for it.
const char* const biaxial = R"(
[region.specimen]
polygon_m = [[0.064, 0.0], [0.16, 0.0], [0.16, 0.16], [0.064, 0.16]]
material = "sand"
@SAND@
domain_m = [[0.0, -0.016], [0.224, 0.184]]
[body.plate]
polygon_m = [[0.04, 0.16], [0.184, 0.16], [0.184, 0.184], [0.04, 0.184]]
mass_kg_m = 75.0
turns = false
friction = @BASE@
[body.floor]
polygon_m = [[0.0, -0.016], [0.224, -0.016], [0.224, 0.0], [0.0, 0.0]]
friction = @BASE@
)";

}  // namespace

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> list{
      {"column", {30, 0, 0.4}, {{"friction + 3 degrees", {33, 0, 0.4}}, {"base friction + .1", {30, 0, 0.5}}, {"cohesion 300 Pa", {30, 300, 0.4}}},
       column, {0, 0, 0.336, 0.16}, 25, 100},
      {"slope", {25, 100, 0.4}, {{"friction + 3 degrees", {28, 100, 0.4}}, {"base friction + .1", {25, 100, 0.5}}, {"cohesion 200 Pa", {25, 200, 0.4}}},
       slope, {0, 0, 0.352, 0.16}, 21, 50},
      {"punch", {25, 1000, 0}, {{"friction + 3 degrees", {28, 1000, 0}}, {"cohesion 2000 Pa", {25, 2000, 0}}},
       punch, {0, 0, 0.256, 0.152}, 21, 200},
      {"biaxial", {25, 2000, 0.2}, {{"friction + 3 degrees", {28, 2000, 0.2}}, {"base friction + .1", {25, 2000, 0.3}}, {"cohesion 4000 Pa", {25, 4000, 0.2}}},
       biaxial, {0, -0.016, 0.224, 0.2}, 21, 160}};
  return list;
}

std::string Look::text() const {
  return "noise " + digits(100 * noise) + " %, loss " + digits(100 * loss) + " %, " + (soil ? "soil" : "blobs") +
         (grains_deform ? ", deforming" : "");
}

Look look(int n) {
  static constexpr std::array<double, 5> noise{0.02, 0.01, 0.05, 0.03, 0.04};
  static constexpr std::array<double, 3> loss{0, 0.05, 0.1};
  return {noise[std::size_t(n) % noise.size()],
          loss[std::size_t(n) % loss.size()],
          n % 4 != 3,
          n % 2 == 1,
          false,
          100 + 17 * n};
}

fs::path Bench::simulated(const Scene& scene, const Soil& soil, int level) {
  const std::string key = scene.name + "_" + digits(soil.friction_deg) + "_" + digits(soil.cohesion_pa) + "_" +
                          digits(soil.base_friction) + "_" + std::to_string(level);
  if (const auto at = simulations_.find(key); at != simulations_.end()) return at->second;
  const fs::path out = folder_ / "simulated" / key;
  if (reuse_ && fs::exists(out / "record.h5")) return simulations_[key] = out / "record.h5";
  const std::string text = "[grid]\nspacing_m = " + digits(cell_m * std::pow(coarser_ratio, level)) + "\n" + area(scene) +
                           world(scene, soil);
  const app::Case c = app::parse_case(text, key, fs::current_path());
  app::run_case(c, in(out), app::Stages::simulate, progress_);
  return simulations_[key] = out / "record.h5";
}

// Frames that the scene's own soil moves; the case simulates `soil`.
std::string Bench::drawn_case(const Scene& scene, const Look& look, const Soil& soil) {
  // A rim of two cells about the area.
  const double rim = 2 * cell_m;
  const int width = int(std::lround((scene.area_m[2] + 2 * rim) / pixel_m)),
            height = int(std::lround((scene.area_m[3] + 2 * rim) / pixel_m));
  const double column0 = (rim - scene.area_m[0]) / pixel_m, row0 = height - 1 - (rim - scene.area_m[1]) / pixel_m;
  std::ostringstream text;
  text << "[frames]\nrate_hz = " << scene.rate_hz << "\n[camera]\nmetres_per_pixel = " << pixel_m << "\norigin_px = ["
       << column0 << ", " << row0 << "]\n[grid]\nspacing_px = 8\n"
       << area(scene) << "[piv]\nanchor = \"forward\"\n"
       << world(scene, soil) << "\n[synth]\nmotion = \"record\"\nrecord = \"" << simulated(scene, scene.soil).string()
       << ":mpm\"\nwidth_px = " << width << "\nheight_px = " << height << "\nframes = " << scene.frames
       << "\ngrains_deform = " << (look.grains_deform ? "true" : "false") << "\n[synth.texture]\nnoise = " << look.noise
       << "\nloss = " << look.loss << "\nseed = " << look.seed << "\n";
  if (look.soil)
    text << "kind = \"soil\"\ndensity_per_px = 0.2\nbackground = 0.45\npeak_min = 0.08\npeak_max = 0.28\n";
  else
    text << "density_per_px = 0.1\n";
  if (look.corrected) text << "[np]\ndrift = \"corrected\"\n";
  return text.str();
}

fs::path Bench::measured(const Scene& scene, const Look& look) {
  const fs::path out =
      folder_ / "measured" / (scene.name + "_" + std::to_string(look.seed) + (look.corrected ? "_corrected" : ""));
  if (reuse_ && fs::exists(out / "record.h5")) return out / "record.h5";
  const app::Case c = app::parse_case(drawn_case(scene, look, scene.soil), scene.name, fs::current_path());
  app::run_case(c, in(out), app::Stages::track, progress_);
  return out / "record.h5";
}

PathCoverage Bench::coverage(const Scene& scene, const fs::path& measured, int frame) {
  const app::OpenedMotion first = app::open_motion(measured.string() + ":np", {}),
                          second = app::open_motion(simulated(scene, scene.soil).string() + ":mpm", {});
  const MotionFrame a = first.motion->frame(std::size_t(frame)), b = second.motion->frame(std::size_t(frame));
  const FieldValues& cov_F = a.field("cov_F");
  std::map<std::int64_t, std::size_t> place;
  for (std::size_t p = 0; p < b.u.size(); ++p)
    if (alive(b.status[p])) place[second.motion->particles().id[p]] = p;
  PathCoverage sum;
  double n = 0;
  for (std::size_t p = 0; p < a.u.size(); ++p) {
    const auto at = place.find(first.motion->particles().id[p]);
    if (!alive(a.status[p]) || at == place.end()) continue;
    const std::size_t q = at->second;
    const Mat2 F = matrix(a.F[p]), truth = matrix(b.F[q]), inverse = F.inverse(), L = (F - truth) * inverse;
    const std::array<double, 3> row{double(cov_F(p, 0)), double(cov_F(p, 1)), double(cov_F(p, 2))};
    Mat2 R;
    R << row[0], row[2], row[2], row[1];
    const Mat2 S = inverse.transpose() * R * inverse;
    const StrainVariance variance = strain_variance(F, row);
    const Strain e = log_strain(F), true_e = log_strain(truth);
    const auto count = [](double off, double square, double share, double& one, double& two) {
      one += std::abs(off) <= std::sqrt(square) ? share : 0, two += std::abs(off) <= 2 * std::sqrt(square) ? share : 0;
    };
    for (int k = 0; k < 2; ++k) {
      const auto c = std::size_t(k);
      count(double(a.u[p][c]) - double(b.u[q][c]), double(a.cov_u[p][c]), .5, sum.displacement, sum.displacement_two);
      count(L(k, k), S(k, k), .5, sum.gradient, sum.gradient_two);
    }
    count(deviatoric(e) - deviatoric(true_e), variance.dev, 1, sum.dev, sum.dev_two);
    count(volumetric(e) - volumetric(true_e), variance.vol, 1, sum.vol, sum.vol_two);
    ++n;
  }
  for (double* share : {&sum.displacement, &sum.displacement_two, &sum.gradient, &sum.gradient_two, &sum.dev,
                        &sum.dev_two, &sum.vol, &sum.vol_two})
    *share /= n;
  return sum;
}

std::vector<Metric> Bench::levelled(const Scene& scene, const Look& look, const Soil& soil) {
  const std::string key =
      scene.name + "_" + std::to_string(look.seed) + "_" + digits(soil.friction_deg) + "_" + digits(soil.cohesion_pa);
  app::Case c = app::parse_case(drawn_case(scene, look, soil), scene.name, fs::current_path());
  c.compare.levelling = true;
  return app::run_case(c, in(folder_ / "levelled" / key), app::Stages::all, progress_).metrics;
}

Comparison Bench::against(const Scene& scene, const fs::path& measured, const Soil& soil, int coarser) {
  const app::OpenedMotion first = app::open_motion(measured.string() + ":np", {}),
                          second = app::open_motion(simulated(scene, soil).string() + ":mpm", {});
  std::vector<app::OpenedMotion> grids;
  compare::Refinement refinement{{}, coarser_ratio};
  for (int level = 1; level <= coarser; ++level)
    grids.push_back(app::open_motion(simulated(scene, soil, level).string() + ":mpm", {}));
  for (const app::OpenedMotion& grid : grids) refinement.coarser.push_back(grid.motion.get());
  compare::CompareOptions options;
  if (scene.world.find("slope_base_m") != std::string::npos) options.slope_base_m = 0.0;
  return compare::compare(*first.motion, *second.motion, options, {}, progress_, refinement, {first.note, {}});
}

Said said(const Metric& m) {
  if (!std::isfinite(m.factor) || !std::isfinite(m.uncertainty) || m.verdict == Verdict::withheld) return Said::nothing;
  return m.told_apart() ? Said::found : Said::lost;
}

namespace {

constexpr std::initializer_list<const char*> of_displacement{"displacement_rms_final",    "displacement_bias_x_final",
                                                             "displacement_bias_y_final", "displacement_field_rms",
                                                             "displacement_field_x",      "displacement_field_y"};

Said most_said(const std::vector<Metric>& metrics, std::initializer_list<const char*> names,
               const std::string& prefix = "") {
  Said most = Said::nothing;
  for (const char* name : names)
    if (const Metric* m = find(metrics, prefix + name)) most = std::max(most, said(*m));
  return most;
}

}  // namespace

Said said_of_displacement(const Comparison& c) { return most_said(c.metrics, of_displacement); }

Said said_of_levelled_displacement(const std::vector<Metric>& metrics) {
  return most_said(metrics, of_displacement, "levelled_");
}

Said said_of_strain(const Comparison& c) {
  return most_said(c.metrics,
                   {"strain_dev_rms_final", "strain_dev_bias_final", "strain_dev_field_rms", "strain_dev_field_mean",
                    "strain_vol_rms_final", "strain_vol_bias_final", "strain_vol_field_rms", "strain_vol_field_mean"});
}

}  // namespace pivnp::twins

#include "apps/study/stress/piv_stress.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "apps/study/frontier/piv/known_pairs.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/synthetic_pair.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

namespace {

constexpr double right_px = 0.1, wrong_px = 0.5;
constexpr double node_px = 16, rim_px = 80;

// One combination: texture, motion and settings.
struct Scene {
  image::TextureOptions texture;
  image::Motion motion = image::uniform(1.4, -1.0);
  piv::PivOptions piv;
};

struct MapPlan {
  SurvivalMap map;
  std::function<void(Scene& scene, double x, double y)> put;
};

image::Motion moved_and_sheared(double displacement, double slope) {
  const image::Motion shear = image::triangle_shear(slope);
  const Vec2 all(displacement * std::cos(0.6), displacement * std::sin(0.6));
  return [=](const Vec2& p) -> Vec2 { return all + shear(p); };
}

std::vector<MapPlan> plans(const piv::PivOptions& piv) {
  const double window = piv.window_px, first = piv.first_window_px > 0 ? piv.first_window_px : 128, blob = image::TextureOptions().blob_diameter_px;
  std::vector<MapPlan> all;
  const auto add = [&](const std::string& name, const std::string& title, MapAxis x, MapAxis y, std::vector<TheoryLine> theory, auto put) {
    MapPlan plan;
    plan.map.name = name;
    plan.map.title = title;
    plan.map.x = std::move(x);
    plan.map.y = std::move(y);
    plan.map.theory = std::move(theory);
    plan.put = put;
    all.push_back(std::move(plan));
  };
  add("piv_displacement_gradient", "Displacement and gradient", {"displacement (px)", {0.3, 2, 5, 10, 20, 30, 45}},
      {"displacement gradient", {0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4}},
      {{"a quarter of the first window", {{first / 4, 0}, {first / 4, 0.4}}},
       {"a window's ends part by a blob", {{0.3, blob / window}, {45, blob / window}}}},
      [](Scene& s, double x, double y) { s.motion = moved_and_sheared(x, y); });
  TheoryLine five{"five partners a window", {}};
  for (const double loss : {0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8}) five.points.push_back({5 / (window * window * (1 - loss)), loss});
  add("piv_density_loss", "Grains and lost grains", {"grains per pixel", {0.002, 0.005, 0.01, 0.02, 0.05, 0.1}},
      {"share of grains lost", {0, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8}}, {five}, [](Scene& s, double x, double y) {
        s.texture.density_per_px = x;
        s.texture.loss = y;
      });
  add("piv_noise_window", "Noise and window", {"noise, share of white", {0, 0.02, 0.05, 0.1, 0.2, 0.3}}, {"window (px)", {16, 24, 32, 48, 64}}, {},
      [](Scene& s, double x, double y) {
        s.texture.noise = x;
        s.piv.window_px = int(y);
      });
  add("piv_blob_blur", "Size of grains and blur", {"diameter of a blob (px)", {0.8, 1, 1.5, 2, 3, 5, 8, 12}}, {"blur, standard deviation (px)", {0, 0.5, 1, 2, 3}},
      {{"two pixels a blob", {{2, 0}, {2, 3}}}}, [](Scene& s, double x, double y) {
        s.texture.blob_diameter_px = x;
        s.texture.blur_px = y;
        s.texture.density_per_px = std::min(0.2, 0.45 / (x * x));  // as much of the frame is covered
      });
  add("piv_light_noise", "Light that changes, and noise", {"swing of the light, share", {0, 0.1, 0.2, 0.4, 0.6, 0.8}}, {"noise, share of white", {0, 0.02, 0.05, 0.1}}, {},
      [](Scene& s, double x, double y) {
        s.texture.light_change = x;
        s.texture.light_slope = 0.3;
        s.texture.noise = y;
      });
  return all;
}

Survival survival(const image::SyntheticPair& pair, const piv::NodeLattice& nodes, const piv::PixelVectors& found) {
  Survival s;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    const bool trusted = found.status[k] == VectorStatus::valid;
    const Vec2 place(double(nodes.pixel[k][0]), double(nodes.pixel[k][1]));
    const double error = (Vec2(double(found.displacement[k][0]), double(found.displacement[k][1])) - pair.truth(place, found.anchor)).norm();
    if (!trusted) ++s.flagged;
    else if (error < right_px) ++s.good;
    else if (error <= wrong_px) ++s.fair;
    else ++s.wrong;
    if (found.status[k] == VectorStatus::failed || found.status[k] == VectorStatus::masked) continue;  // claims no value
    if (!(error <= wrong_px)) ++s.wrong_values, s.wrong_flagged += !trusted;
    if (error < right_px) ++s.right_values, s.right_flagged += !trusted;
  }
  return s;
}

}  // namespace

std::vector<SurvivalMap> piv_stress(const piv::PivOptions& options, int side, int seeds, int threads, Progress& progress) {
  const piv::NodeLattice nodes = even_nodes(side, node_px, rim_px);
  std::vector<MapPlan> all = plans(options);
  std::int64_t total = 0, done = 0;
  for (const MapPlan& plan : all) total += std::int64_t(plan.map.x.size() * plan.map.y.size());
  std::vector<SurvivalMap> maps;
  for (MapPlan& plan : all) {
    SurvivalMap& map = plan.map;
    map.made_of = "Drawn texture, frames of " + std::to_string(side) + " x " + std::to_string(side) + " px, blobs of 3 px and .05 a pixel where nothing else is said, " +
                  std::to_string(seeds) + (seeds == 1 ? " pair" : " pairs") + " of " + std::to_string(nodes.pixel.size()) +
                  " vectors a combination. Right: less than " + number(right_px) + " px off; wrong: more than " + number(wrong_px) + " px.";
    map.cells.resize(map.x.size() * map.y.size());
    for (std::size_t j = 0; j < map.y.size(); ++j)
      for (std::size_t i = 0; i < map.x.size(); ++i) {
        progress.update("correlation under stress", done++, total);
        if (progress.stop_requested()) throw Interrupted();
        for (int seed = 1; seed <= seeds; ++seed) {
          Scene scene;
          scene.piv = options;
          scene.piv.replace = false;  // a vector that was replaced would hide what was measured
          scene.texture.seed = int(1000 * std::size_t(seed) + 37 * i + j);
          plan.put(scene, map.x.levels[i], map.y.levels[j]);
          const image::SyntheticPair pair = image::synthetic_pair(scene.motion, side, side, scene.texture);
          piv::PairCorrelator correlator(scene.piv, nodes, side, side, threads);
          map.at(i, j).add(survival(pair, nodes, correlator.correlate(pair.first.view(), pair.second.view(), {})));
        }
      }
    maps.push_back(std::move(map));
  }
  progress.update("correlation under stress", total, total);
  return maps;
}

}  // namespace pivnp::app

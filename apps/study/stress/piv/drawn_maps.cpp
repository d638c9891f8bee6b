#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "apps/study/methods/frames/known_pairs.hpp"
#include "apps/study/stress/piv/piv_maps.hpp"
#include "apps/study/stress/piv/vectors.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/files/write.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"

namespace pivnp::app {

namespace {

constexpr double node_px = 16, rim_px = 80;
constexpr double speed_px = 2, grains_lost = 0.01;  // a frame

// One combination: texture, motion and settings.
struct Stressed {
  image::TextureOptions texture;
  image::Motion motion = image::uniform(1.4, -1.0);
  piv::PivOptions piv;
  int jpeg_quality = 0;  // 0: frames as drawn
};

image::Motion moved_and_sheared(double displacement, double slope) {
  const image::Motion shear = image::triangle_shear(slope);
  const Vec2 all(displacement * std::cos(0.6), displacement * std::sin(0.6));
  return [=](const Vec2& p) -> Vec2 { return all + shear(p); };
}

using PutStress = std::function<void(Stressed& scene, double x, double y)>;

Survival survival(const piv::PivOptions& options, int side, int seeds, std::size_t i, std::size_t j, const std::function<void(Stressed&)>& put,
                  const Progress& progress) {
  const piv::NodeLattice nodes = even_nodes(side, node_px, rim_px);
  Survival sum;
  for (int seed = 1; seed <= seeds; ++seed) {
    if (progress.stop_requested()) throw Interrupted();
    Stressed scene;
    scene.piv = options;
    scene.texture.seed = int(1000 * std::size_t(seed) + 37 * i + j);
    put(scene);
    image::SyntheticPair pair = image::synthetic_pair(scene.motion, side, side, scene.texture);
    if (scene.jpeg_quality > 0)
      for (Image* frame : {&pair.first, &pair.second}) *frame = image::through_jpeg(frame->view(), scene.jpeg_quality);
    sum.add(measured(scene.piv, nodes, {pair.first, pair.second, [&](const Vec2& place, Anchor anchor) { return pair.truth(place, anchor); }}));
  }
  return sum;
}

}  // namespace

std::vector<MapPlan> piv_maps(const piv::PivOptions& piv, int side, int seeds) {
  const double window = piv.window_px, first = piv.first_window_px > 0 ? piv.first_window_px : 128, blob = image::TextureOptions().blob_diameter_px;
  const std::size_t nodes = even_nodes(side, node_px, rim_px).pixel.size();
  std::vector<MapPlan> all;
  const auto add = [&](const std::string& name, const std::string& title, MapAxis x, MapAxis y, std::vector<LimitLine> theory, const PutStress& put) {
    MapPlan plan;
    plan.map.name = name;
    plan.map.title = title;
    plan.map.made_of = "Drawn texture, frames of " + std::to_string(side) + " x " + std::to_string(side) + " px, blobs of 3 px and 0.05 a pixel where nothing else is said, " +
                       std::to_string(seeds) + (seeds == 1 ? " pair" : " pairs") + " of " + std::to_string(nodes) +
                       " vectors a combination. Right: less than " + number(vector_bounds.right) + " px off; wrong: more than " + number(vector_bounds.wrong) + " px.";
    plan.map.x = std::move(x);
    plan.map.y = std::move(y);
    plan.map.theory = std::move(theory);
    plan.settings = words_of(piv);
    plan.result = [=, x = plan.map.x.levels, y = plan.map.y.levels](std::size_t i, std::size_t j, Progress& progress) {
      return survival(piv, side, seeds, i, j, [&](Stressed& s) { put(s, x[i], y[j]); }, progress);
    };
    all.push_back(std::move(plan));
  };
  const LimitLine quarter{"a quarter of the first window", {{first / 4, 0}, {first / 4, 0.4}}}, ends{"a window's ends part by a blob", {{0.3, blob / window}, {45, blob / window}}};
  add("piv_displacement_gradient", "Displacement and gradient", {"displacement (px)", {0.3, 2, 5, 10, 20, 30, 45}},
      {"displacement gradient", {0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4}}, {quarter, ends}, [](Stressed& s, double x, double y) { s.motion = moved_and_sheared(x, y); });
  LimitLine five{"five partners a window", {}};
  for (const double loss : {0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8}) five.points.push_back({5 / (window * window * (1 - loss)), loss});
  add("piv_density_loss", "Grains and lost grains", {"grains per pixel", {0.002, 0.005, 0.01, 0.02, 0.05, 0.1}},
      {"share of grains lost", {0, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8}}, {five}, [](Stressed& s, double x, double y) {
        s.texture.density_per_px = x;
        s.texture.loss = y;
      });
  add("piv_noise_window", "Noise and window", {"noise, share of white", {0, 0.02, 0.05, 0.1, 0.2, 0.3}}, {"window (px)", {16, 24, 32, 48, 64}}, {},
      [](Stressed& s, double x, double y) {
        s.texture.noise = x;
        s.piv.window_px = int(y);
      });
  add("piv_blob_blur", "Size of grains and blur", {"diameter of a blob (px)", {0.8, 1, 1.5, 2, 3, 5, 8, 12}}, {"blur, standard deviation (px)", {0, 0.5, 1, 2, 3}},
      {{"two pixels a blob", {{2, 0}, {2, 3}}}}, [](Stressed& s, double x, double y) {
        s.texture.blob_diameter_px = x;
        s.texture.blur_px = y;
        s.texture.density_per_px = std::min(0.2, 0.45 / (x * x));  // as much of the frame is covered
      });
  const std::vector<double> intervals = {1, 2, 4, 8, 12, 16, 24};
  LimitLine part{ends.name, {}};
  for (const double n : intervals) part.points.push_back({n, blob / window / n});
  add("piv_interval_strain", "Frame interval and strain rate", {"frames from one image to the next", intervals},
      {"shear strain a frame", {0, 0.001, 0.0025, 0.005, 0.01, 0.02}}, {{quarter.name, {{first / 4 / speed_px, 0}, {first / 4 / speed_px, 0.02}}}, part},
      [](Stressed& s, double x, double y) {  // what moves further also loses more of its grains
        s.motion = moved_and_sheared(speed_px * x, y * x);
        s.texture.loss = 1 - std::pow(1 - grains_lost, x);
      });
  add("piv_jpeg_window", "JPEG and window", {"quality of JPEG (weak texture)", {5, 10, 20, 30, 40, 50, 60, 75, 90}}, {"window (px)", {16, 24, 32, 48, 64}}, {},
      [](Stressed& s, double x, double y) {
        s.texture.noise = 0.01;
        s.texture.peak_min = 0.05;  // of white: a texture that compression takes away
        s.texture.peak_max = 0.12;
        s.jpeg_quality = int(x);
        s.piv.window_px = int(y);
      });
  const MapAxis swing{"swing of the light, share", {0, 0.1, 0.2, 0.4, 0.6, 0.8}};
  add("piv_light_noise", "Light that changes, and noise", swing, {"noise, share of white", {0, 0.02, 0.05, 0.1}}, {}, [](Stressed& s, double x, double y) {
    s.texture.light_change = x;
    s.texture.light_slope = 0.3;
    s.texture.noise = y;
  });
  add("piv_light_texture", "Light that changes, and texture", swing, {"grains per pixel", {0.002, 0.005, 0.01, 0.02, 0.05, 0.1}},
      {{five.name, {{0, five.points.front().x()}, {0.8, five.points.front().x()}}}}, [](Stressed& s, double x, double y) {
        s.texture.light_change = x;
        s.texture.light_slope = 0.3;
        s.texture.noise = 0.02;
        s.texture.density_per_px = y;
      });
  return all;
}

}  // namespace pivnp::app

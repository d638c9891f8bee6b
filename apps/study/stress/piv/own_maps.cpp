#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/study/methods/frames/known_pairs.hpp"
#include "apps/study/stress/piv/piv_maps.hpp"
#include "apps/study/stress/piv/vectors.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

std::vector<MapPlan> piv_own_maps(const Case& c, const Setting& setting, image::FrameSource& source, int threads, Progress& progress) {
  const auto frame = std::make_shared<CarriedFrame>(carried_frame(c, setting, source, threads, progress));
  const piv::PivOptions options = *c.piv;
  const double blob = image::TextureOptions().blob_diameter_px;
  std::vector<MapPlan> all;
  const auto add = [&](const std::string& name, const std::string& title, MapAxis x, MapAxis y, std::vector<LimitLine> theory, auto put) {
    MapPlan plan;
    plan.map = {name, title,
                frame->from + ", carried by known fields with noise of " + number(std::sqrt(frame->noise), 2) + " grey values, a pair a combination. (From one frame to the next it moves by " +
                    number(frame->shift, 2) + " px, with gradients of " + number(100 * frame->slope, 2) + " %.) Right: less than " + number(vector_bounds.right) +
                    " px off; wrong: more than " + number(vector_bounds.wrong) + " px.",
                std::move(x), std::move(y), {}, std::move(theory)};
    plan.settings = words_of(options) + plan.map.made_of + std::to_string(frame->known.width) + " " + std::to_string(frame->known.nodes.pixel.size());
    plan.result = [=, x = plan.map.x.levels, y = plan.map.y.levels](std::size_t i, std::size_t j, Progress& watched) {
      if (watched.stop_requested()) throw Interrupted();
      piv::PivOptions own = options;
      double displacement = 0, slope = 0;
      put(own, displacement, slope, x[i], y[j]);
      const image::Motion shear = image::triangle_shear(slope);
      const Vec2 along(displacement * std::cos(0.6), displacement * std::sin(0.6));
      const KnownPair pair = frame->pair(name, [=](const Vec2& p) -> Vec2 { return along + shear(p); }, 1 + 37 * i + j);
      // Beyond its edges the frame is mirrored: what comes from there is no texture that moves.
      const double rim = 0.5 * (displacement + 64 * slope + own.window_px);
      std::vector<std::uint8_t> scored = frame->known.scored;
      for (std::size_t k = 0; k < scored.size(); ++k) {
        const double x_px = double(frame->known.nodes.pixel[k][0]), y_px = double(frame->known.nodes.pixel[k][1]);
        if (x_px < rim || y_px < rim || x_px > frame->known.width - 1 - rim || y_px > frame->known.height - 1 - rim) scored[k] = 0;
      }
      return measured(own, frame->known.nodes, {pair.first, pair.second, pair.truth, frame->known.mask.view()}, scored);
    };
    all.push_back(std::move(plan));
  };
  const double first = options.first_window_px > 0 ? options.first_window_px : 128;
  add("piv_own_displacement_gradient", "The case's own texture: displacement and gradient", {"displacement (px)", {0.3, 2, 5, 10, 20, 30}},
      {"displacement gradient", {0, 0.02, 0.05, 0.1, 0.2, 0.3}}, {{"a quarter of the first window", {{first / 4, 0}, {first / 4, 0.3}}}},
      [](piv::PivOptions&, double& displacement, double& slope, double x, double y) { displacement = x, slope = y; });
  LimitLine ends{"a window's ends part by 3 px", {}};
  for (const double w : {16, 24, 32, 48, 64}) ends.points.push_back({w, blob / w});
  add("piv_own_window_gradient", "The case's own texture: window and gradient", {"window (px)", {16, 24, 32, 48, 64}}, {"displacement gradient", {0, 0.02, 0.05, 0.1, 0.2, 0.3}},
      {ends}, [](piv::PivOptions& own, double& displacement, double& slope, double x, double y) {
        own.window_px = int(x);
        displacement = 2, slope = y;
      });
  return all;
}

}  // namespace pivnp::app

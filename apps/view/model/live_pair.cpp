#include "apps/view/model/live_pair.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/scene/placed.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::view {

void measure_live(const app::Case& asked, SharedFrames& frames, int frame, const std::optional<PixelBox>& visible, int threads,
                  const std::function<bool()>& stop, const std::function<void(LivePair)>& done) {
  app::Case given = asked;
  for (auto& [name, mask] : given.masks) mask.follow = false;
  const int count = int(frames.frames().size());
  int first = std::clamp(frame, 0, std::max(0, count - 2));
  if (app::in_twos(given)) first -= first % 2;
  if (count < 2 || first + 1 >= count) return;
  const auto measured = [&](const app::Case& c, bool part) {
    const auto start = std::chrono::steady_clock::now();
    LivePair pair;
    app::placed(c, {}, [&] {
      app::Setting setting = app::make_setting(c, frames.width(), frames.height());
      if (c.preprocess && c.preprocess->any() && !c.preprocess->choose)
        setting.filter = std::make_shared<const image::FrameFilter>(app::filter_of(*c.preprocess, frames));
      pair.field = app::measure_pair(c, setting, frames, {first, first + 1}, threads);
      pair.camera = setting.camera;
      pair.spacing_px = app::node_spacing_px(setting);
      return 0;
    });
    pair.part = part;
    pair.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    done(std::move(pair));
  };
  const bool own_area = !given.grid.area_m.empty() || !given.grid.area_px.empty();
  if (visible && !own_area) {
    const double margin = given.piv ? given.piv->window_px : 32;
    const PixelBox box{std::max(visible->left, margin), std::max(visible->top, margin), std::min(visible->right, frames.width() - 1 - margin),
                       std::min(visible->bottom, frames.height() - 1 - margin)};
    const double share = (box.right - box.left) * (box.bottom - box.top) / (double(frames.width()) * frames.height());
    if (box.right - box.left > 2 * margin && box.bottom - box.top > 2 * margin && share < 0.5) {
      app::Case c = given;
      c.grid.area_px = {{box.left, box.top}, {box.right, box.bottom}};
      measured(c, true);
    }
  }
  if (!stop()) measured(given, false);
}

std::string csv_of(const LivePair& pair) {
  const std::string unit = pair.camera.length_unit();
  std::string out = "column [px],row [px],x [" + unit + "],y [" + unit + "],displacement_x [" + unit + "],displacement_y [" + unit +
                    "],sigma_x [" + unit + "],sigma_y [" + unit + "],status,score\n";
  const auto cell = [](double value) { return std::isfinite(value) ? number(value, 9) : std::string(); };
  for (int j = 0; j < pair.field.grid.ny; ++j)
    for (int i = 0; i < pair.field.grid.nx; ++i) {
      const std::size_t n = pair.field.grid.node(i, j);
      const Vec2 x = pair.field.grid.position(i, j), px = pair.camera.to_pixel(x);
      for (const double value : {px.x(), px.y(), x.x(), x.y(), double(pair.field.displacement[n][0]), double(pair.field.displacement[n][1]),
                                 std::sqrt(double(pair.field.cov[n][0])), std::sqrt(double(pair.field.cov[n][1]))})
        out += cell(value) + ",";
      out += std::to_string(int(pair.field.status[n])) + "," + cell(n < pair.field.score.size() ? double(pair.field.score[n]) : nan_value) + "\n";
    }
  return out;
}

}  // namespace pivnp::view

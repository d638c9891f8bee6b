#include "apps/study/studies/check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/report/figures/check_figure.hpp"
#include "apps/study/methods/peak_locking.hpp"
#include "apps/study/pipeline/scene.hpp"
#include "apps/study/pipeline/simulation_scene.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

std::vector<Vec2> vertices(const Points& points) {
  std::vector<Vec2> out;
  for (const Pair& p : points) out.emplace_back(p[0], p[1]);
  return out;
}

std::vector<Vec2> circle(const std::vector<double>& c) {
  std::vector<Vec2> out;
  for (int k = 0; k < 72; ++k) {
    const double a = 2 * std::numbers::pi * k / 72;
    out.emplace_back(c[0] + c[2] * std::cos(a), c[1] + c[2] * std::sin(a));
  }
  return out;
}

}  // namespace

CheckOutcome check_case(const Case& given, const RunSettings& settings, Progress& progress) {
  Case c = given;
  // Of frames that are to be drawn two are enough, in a folder of their own: a run to be resumed must not find them.
  RunSettings own = settings;
  if (c.synth) {
    own.out = settings.out / "check_frames";
    own.resume = false;
    c.synth->frames = std::min(c.synth->frames, 2);
  }
  const std::unique_ptr<image::FrameSource> source = case_frames(c, own, progress);
  const Setting setting = make_setting(c, source ? source->width() : 0, source ? source->height() : 0);
  if (source) seed_particles(c, setting);  // throws where a region holds none
  if (c.mpm) make_solver(c, setting, 1);   // likewise
  if (!source) return {};

  report::CheckInput input;
  const Image first = source->read(0);
  std::error_code ignored;
  if (c.synth) std::filesystem::remove_all(own.out, ignored);
  input.image = first.view();
  input.mask = setting.mask.view();
  input.world_from_pixel = setting.camera.world_from_pixel();
  input.length_unit = setting.camera.length_unit();
  input.grid = setting.grid;
  using Kind = report::Outline::Kind;
  for (const Region& region : setting.regions)
    input.outlines.push_back({Kind::region, region.name, region.polygon.vertices(), true});
  for (const auto& [name, b] : c.boundaries)
    input.outlines.push_back({Kind::boundary, name, vertices(b.line_m.empty() ? b.polygon_m : b.line_m), b.line_m.empty()});
  for (const auto& [name, b] : c.bodies)
    input.outlines.push_back({Kind::body, name, b.circle_m.empty() ? vertices(b.polygon_m) : circle(b.circle_m), true});
  const std::filesystem::path file = settings.out / "check.png";
  report::write_check(input, file);
  return {file, texture_remarks(setting, first)};
}

}  // namespace pivnp::app

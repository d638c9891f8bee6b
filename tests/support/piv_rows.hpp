// The synthetic pairs that every PIV method is held to, and what is asked of the default on each of them.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "pivnp/image/synthetic/synthetic_pair.hpp"

namespace pivnp::piv {

using image::Motion;

/// What is asked of valid vectors, 32 px class; 0: nothing.
struct RowLimits {
  double rms = 0;    // px, of the worse component
  double valid = 0;  // share of nodes, at least
  double bias = 0;   // px
  double gain = 0;   // recovered share of the displacement, at least
};

enum class RowKind { clean, gradient, noise, loss, illumination };

struct Row {
  std::string name = {};
  std::string group = {};  // rows of one group count as one, by their worst figures; empty: alone
  RowKind kind = RowKind::clean;
  Motion motion = {};
  double noise = 0, loss = 0, light_slope = 0, light_change = 0;
  RowLimits limits = {};
  std::string clean_row = {};                      // limits.rms is a multiple of this row's figure, not px
  std::function<bool(const Vec2&)> scored = {};    // empty: everywhere
  double band_amplitude = 0, band_half_width = 0;  // of a band: its width is measured

  image::TextureOptions texture(image::TextureOptions base) const {
    base.noise = noise, base.loss = loss, base.light_slope = light_slope, base.light_change = light_change;
    return base;
  }
};

/// Within 24 px of the middles of the triangle wave's slopes, at 64 px, 192 px ...
inline bool on_slopes(const Vec2& p) { return std::abs(p.y() - 64 - 128 * std::round((p.y() - 64) / 128)) < 24; }

/// The table, for square frames of this side. `more`: fields beside the table, with nothing asked of them.
inline std::vector<Row> piv_rows(int side, bool more = false) {
  using namespace image;
  const double c = 0.5 * (side - 1);
  const auto moved = [] { return uniform(2.3, -1.4); };
  std::vector<Row> rows;
  for (int k = 0; k <= 10; ++k)
    rows.push_back({.name = "uniform " + std::string(k < 10 ? "0." : "1.") + std::to_string(k % 10),
                    .group = "uniform 0..1",
                    .motion = uniform(0.1 * k, 0),
                    .limits = {.rms = .0020, .valid = 1, .bias = .0015}});
  const auto clean = [&](const char* name, Motion motion, RowLimits limits) {
    rows.push_back({.name = name, .motion = std::move(motion), .limits = limits});
  };
  const auto steep = [&](const char* name, Motion motion, RowLimits limits) {
    rows.push_back({.name = name, .kind = RowKind::gradient, .motion = std::move(motion), .limits = limits});
  };
  const auto bad = [&](const char* name, Motion motion, double noise, double loss, RowLimits limits) {
    rows.push_back({.name = name,
                    .kind = loss > 0 ? RowKind::loss : RowKind::noise,
                    .motion = std::move(motion),
                    .noise = noise,
                    .loss = loss,
                    .limits = limits});
  };
  const auto banded = [&](double half_width, double amplitude) {
    rows.back().band_amplitude = amplitude, rows.back().band_half_width = half_width;
  };
  clean("rotation 1 deg", rotation(1, c, c), {.rms = .0015, .valid = 1});
  clean("rotation 3 deg", rotation(3, c, c), {.rms = .0015, .valid = 1});
  steep("shear 10 %", triangle_shear(.1), {.rms = .0025, .valid = .99});
  rows.back().scored = on_slopes;
  steep("shear 20 %", triangle_shear(.2), {.rms = .0035, .valid = .99});
  rows.back().scored = on_slopes;
  steep("band w=16 A=4", band(4, 16, c, c), {.rms = .010, .valid = .97}), banded(16, 4);
  steep("band w=8 A=2", band(2, 8, c, c), {.rms = .025, .valid = .97}), banded(8, 2);
  steep("band w=4 A=2", band(2, 4, c, c), {.rms = .090, .valid = .97}), banded(4, 2);
  clean("sine 128", sine(1, 128), {.rms = .004, .valid = .97, .gain = .99});
  steep("sine 64", sine(1, 64), {.rms = .010, .valid = .97, .gain = .98});
  steep("sine 32", sine(1, 32), {.rms = .070, .valid = .97, .gain = .92});
  bad("noise 5 %", moved(), .05, 0, {.rms = .018, .valid = .99});
  bad("noise 10 %", moved(), .10, 0, {.rms = .035, .valid = .99});
  bad("loss 10 %", moved(), 0, .1, {.rms = .010, .valid = .97});
  bad("loss 20 %", moved(), 0, .2, {.rms = .015, .valid = .97});
  bad("loss 30 %", moved(), 0, .3, {.rms = .025, .valid = .97});
  bad("noise 5 loss 20 %", moved(), .05, .2, {.rms = .030, .valid = .97});
  clean("shift 20.3 -5.7", uniform(20.3, -5.7), {.rms = .002, .valid = 1});
  bad("sine 128 noise 5 %", sine(1, 128), .05, 0, {.rms = .024, .valid = .97, .gain = .97});
  bad("sine 64 noise 5 %", sine(1, 64), .05, 0, {.rms = .042, .valid = .97, .gain = .97});
  bad("sine 32 noise 5 %", sine(1, 32), .05, 0, {.rms = .065, .valid = .97, .gain = .92});
  bad("sine 128 A=.2 noise 5 %", sine(.2, 128), .05, 0, {.rms = .020, .valid = .97, .gain = .93});
  bad("sine 64 loss 20 %", sine(1, 64), 0, .2, {.rms = .035, .valid = .95});
  bad("band w=8 loss 20 %", band(2, 8, c, c), 0, .2, {.rms = .045, .valid = .95}), banded(8, 2);
  rows.push_back({.name = "sine 64 uneven illumination",
                  .kind = RowKind::illumination,
                  .motion = sine(1, 64),
                  .light_slope = .4,
                  .light_change = .1,
                  .limits = {.rms = 1.5, .valid = .97},
                  .clean_row = "sine 64"});
  if (!more) return rows;
  steep("plain shear 5 %", plain_shear(.05, c), {});
  steep("vortex r=60 A=4", vortex(4, 60, c, c), {});
  steep("strain 2+10 % s=16", strain_concentration(.02, .10, 16, c, c), {});
  bad("noise 10 loss 30 %", moved(), .10, .3, {});
  bad("sine 64 noise 10 %", sine(1, 64), .10, 0, {});
  bad("band w=16 noise 5 %", band(4, 16, c, c), .05, 0, {}), banded(16, 4);
  bad("rotation 3 deg loss 50 %", rotation(3, c, c), 0, .5, {});
  return rows;
}

}  // namespace pivnp::piv

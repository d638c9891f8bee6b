#include "tests/unit/report/synthetic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::report {

namespace {

constexpr double rate_hz = 50;
constexpr float not_known = std::numeric_limits<float>::quiet_NaN();

const Polygon& slope() {
  static const Polygon polygon({Vec2(0, 0), Vec2(0.33, 0), Vec2(0.186, 0.25), Vec2(0, 0.25)}, "slope");
  return polygon;
}

struct Motion {
  double amplitude, line, width;  // slip line through (0.33, 0): y = line (0.33 - x)

  double time_factor(double t) const {
    return amplitude * std::pow(std::sin(std::min(t / 0.5, 1.0) * std::acos(-1.0) / 2), 3);
  }
  Vec2 u(const Vec2& x, double t) const {
    const double above = (x.y() - line * (0.33 - x.x())) / std::hypot(1, line);
    const double m = 0.5 * (1 + std::tanh((above - 0.012) / width)) * (0.6 + 1.6 * std::max(0.0, x.x() + 0.3 * x.y()));
    const double s = time_factor(t) * m;
    return {0.11 * s * (1.25 - 2 * x.y()), -0.33 * s * x.y() * (0.9 - x.x())};
  }
  Mat2 F(const Vec2& x, double t) const {
    const double h = 1e-6;
    Mat2 f;
    f.col(0) = (u(x + Vec2(h, 0), t) - u(x - Vec2(h, 0), t)) / (2 * h);
    f.col(1) = (u(x + Vec2(0, h), t) - u(x - Vec2(0, h), t)) / (2 * h);
    return Mat2::Identity() + f;
  }
};

ParticleSet particles(double spacing) {
  ParticleSet set;
  std::int64_t id = 0;
  for (double y = spacing / 2; y < 0.25; y += spacing)
    for (double x = spacing / 2; x < 0.33; x += spacing, ++id) {
      if (!slope().contains({x, y})) continue;
      set.id.push_back(id);
      set.label.push_back(0);
      set.x0.emplace_back(x, y);
      set.area.push_back(spacing * spacing);
      set.born.push_back(0);
      set.end.push_back(std::numeric_limits<double>::quiet_NaN());
      set.end_reason.push_back(EndReason::none);
    }
  set.label_names = {"sand"};
  return set;
}

std::shared_ptr<MotionMemory> make_motion(const SyntheticOptions& o, const Motion& motion, bool measured) {
  ParticleSet set = particles(o.spacing_m);
  std::mt19937 random(measured ? 7u : 8u);
  std::normal_distribution<double> normal;
  if (measured)
    for (std::size_t p = 0; p < set.size(); ++p)
      if (o.frames > 4 && set.x0[p].x() > 0.29 && p % 3 == 0) {
        set.end[p] = (o.frames / 2 + int(p % 7)) / rate_hz;
        set.end_reason[p] = p % 2 ? EndReason::no_vectors : EndReason::left_image;
      }
  auto result = std::make_shared<MotionMemory>(measured ? "np" : "mpm", "m", "s", set);
  std::vector<Vec2> noise(set.size(), Vec2::Zero());
  for (int k = 0; k < o.frames; ++k) {
    MotionFrame frame;
    frame.time = k / rate_hz;
    const double sigma = measured ? 4e-5 * std::sqrt(double(k)) : 0;
    for (std::size_t p = 0; p < set.size(); ++p) {
      const bool ended = set.end_reason[p] != EndReason::none && frame.time > set.end[p];
      const double t = ended ? set.end[p] : frame.time;
      if (measured && k > 0) noise[p] += 4e-5 * Vec2(normal(random), normal(random));
      const Vec2 u = motion.u(set.x0[p], t) + noise[p];
      const Mat2 F = motion.F(set.x0[p], t);
      frame.u.push_back({float(u.x()), float(u.y())});
      frame.F.push_back({float(F(0, 0)), float(F(0, 1)), float(F(1, 0)), float(F(1, 1))});
      frame.status.push_back(ended         ? ParticleStatus::ended
                             : p % 50 == 0 ? ParticleStatus::flagged
                                           : ParticleStatus::active);
      if (measured) frame.cov_u.push_back({float(sigma * sigma), float(sigma * sigma), 0});
    }
    result->add(std::move(frame));
  }
  return result;
}

Comparison make_comparison(const MotionSource& a, const MotionSource& b, const Motion& first, const Motion& second) {
  Comparison c;
  c.names = {a.name(), b.name()};
  c.tables = {{std::string(over_space_table), "statistics over the particles", {{"time", "s", a.times()}}}};
  const auto field = [&](const char* name, const char* unit, const char* definition) {
    return ComparisonField{name, unit, definition, a.times(), a.particles().id, {}};
  };
  ComparisonField x = field("difference_x", "m", "u_x, second minus first"), y = field("difference_y", "m", "u_y"),
                  magnitude = field("difference_magnitude", "m", "|u2 - u1|"),
                  strain = field("difference_strain_dev", "1", "strain_dev");
  double sum = 0, strain_sum = 0, n = 0, largest = 0;
  for (std::size_t k = 0; k < a.times().size(); ++k) {
    const MotionFrame fa = a.frame(k), fb = b.frame(k);
    for (std::size_t p = 0; p < a.particles().size(); ++p) {
      const bool ended = fa.status[p] == ParticleStatus::ended;
      const double dx = double(fb.u[p][0] - fa.u[p][0]), dy = double(fb.u[p][1] - fa.u[p][1]);
      const double ds = deviatoric(log_strain(matrix(fb.F[p]))) - deviatoric(log_strain(matrix(fa.F[p])));
      x.values.push_back(ended ? not_known : float(dx));
      y.values.push_back(ended ? not_known : float(dy));
      magnitude.values.push_back(ended ? not_known : float(std::hypot(dx, dy)));
      strain.values.push_back(ended ? not_known : float(ds));
      if (ended) continue;
      sum += dx * dx + dy * dy;
      strain_sum += ds * ds;
      largest = std::max(largest, std::hypot(dx, dy));
      n += 1;
    }
  }
  c.fields = {x, y, magnitude, strain};
  const double rms = std::sqrt(sum / n);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  c.metrics = {
      {"displacement_rms", rms, "m", 0.000204, "root mean square of |u_second - u_first|, all times",
       Verdict::larger, 2, LostIn::nothing, rms > 0.002 ? LimitFate::exceeded : LimitFate::met},
      {"displacement_max", largest, "m", 0.00031, "greatest |u_second - u_first|, all times"},
      {"displacement_bias_x", 0.00011, "m", 0.0002, "mean of u_x of the second minus that of the first",
       Verdict::agrees, 2},
      {"strain_dev_rms", std::sqrt(strain_sum / n), "1", 0.0043,
       "root mean square of the difference of deviatoric log strain"},
      {"slope_angle_difference", -1.83, "deg", 0.62, "angle of the line fitted to the final slope, second minus first"},
      {"coverage_first", 0.973, "1", unknown, "share of the first's particles that found a partner"},
      {"coverage_second", 0.981, "1", unknown, "share of the second's particles that found a partner"},
  };
  const double end = a.times().back();
  auto outline = [&](const Motion& m) {
    std::vector<Vec2> loop;
    const std::vector<Vec2>& v = slope().vertices();
    for (std::size_t k = 0; k < v.size(); ++k)
      for (int s = 0; s < 60; ++s) {
        const Vec2 at = v[k] + (s / 60.0) * (v[(k + 1) % v.size()] - v[k]);
        loop.push_back(at + m.u(at, end));
      }
    return std::vector<std::vector<Vec2>>{loop};
  };
  c.outlines = {outline(first), outline(second)};
  return c;
}

// Sand in front of a dark wall, lit from the left.
Picture make_picture(const SyntheticOptions& o, double metres_per_pixel, int frame) {
  Picture picture{frame, Image(o.width_px, o.height_px, PixelDepth::u8, 255)};
  std::mt19937 random(unsigned(frame) + 1);
  std::normal_distribution<double> normal;
  for (int r = 0; r < o.height_px; ++r)
    for (int c = 0; c < o.width_px; ++c) {
      const Vec2 x(c * metres_per_pixel, (o.height_px - 1 - r) * metres_per_pixel);
      const double grey = slope().contains(x) ? 120 - 0.03 * c + 40 * normal(random) : 25 + 4 * normal(random);
      picture.image.row<std::uint8_t>(r)[c] = std::uint8_t(std::clamp(grey, 0.0, 255.0));
    }
  return picture;
}

VectorField make_field(const SyntheticOptions& o, const Motion& motion, double metres_per_pixel, std::size_t k) {
  VectorField field;
  field.pair = {int(k), int(k) + 1};
  const double h = 16 * metres_per_pixel * o.width_px / 720;
  field.grid = {Vec2(h, h), Vec2(h, h), int(o.width_px * metres_per_pixel / h) - 1,
                int(o.height_px * metres_per_pixel / h) - 1};
  std::mt19937 random(unsigned(k) + 100);
  std::uniform_real_distribution<double> chance;
  std::normal_distribution<double> normal;
  const bool bad = k == 15;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const Vec2 x = field.grid.position(i, j),
                 d = motion.u(x, double(k + 1) / rate_hz) - motion.u(x, double(k) / rate_hz);
      const double c = chance(random);
      const VectorStatus s = !slope().contains(x)       ? VectorStatus::masked
                             : c < (bad ? 0.12 : 0.004) ? VectorStatus::failed
                             : c < (bad ? 0.45 : 0.015) ? VectorStatus::rejected
                             : c < (bad ? 0.60 : 0.045) ? VectorStatus::replaced
                                                        : VectorStatus::valid;
      const bool none = s == VectorStatus::masked || s == VectorStatus::failed;
      field.displacement.push_back(
          {none ? not_known : float(d.x() + 4e-5 * normal(random)), none ? not_known : float(d.y())});
      field.status.push_back(s);
      field.cov.push_back({1.6e-9f, 1.6e-9f, 0});
      field.score.push_back(none ? not_known : float((bad ? 0.45 : 0.93) - 0.04 * std::abs(normal(random))));
    }
  return field;
}

}  // namespace

Synthetic make_synthetic(const SyntheticOptions& o) {
  Synthetic s;
  const Motion truth{o.amplitude, 0.62, 0.012}, model{1.16 * o.amplitude, 0.70, 0.02};
  const double metres_per_pixel = 0.36 / o.width_px;
  Content& c = s.content;
  c.name = "gate slope, 60 degrees";
  c.command = "pivnp run datasets/gate_slope --out out/gate_slope";
  c.case_text =
      "name = \"gate slope\"\n\n[frames]\npath = \"frames/*.png\"\nrate_hz = 50.0\n\n[material.sand]\nmodel = "
      "\"mohr_coulomb\"\n";
  for (int k = 0; k < 60; ++k) c.case_text += "option_" + std::to_string(k) + " = " + std::to_string(k * 0.25) + "\n";
  c.world_from_pixel << metres_per_pixel, 0, 0, 0, -metres_per_pixel, (o.height_px - 1) * metres_per_pixel, 0, 0, 1;
  c.camera_residual = 0.00003;
  for (int k = 0; k < o.frames; ++k) {
    std::string number = std::to_string(k);
    number.insert(0, 4 - number.size(), '0');
    c.frames.push_back(
        {"IMG_" + number + ".png", k / rate_hz, std::uint8_t(k == 16 && o.pairs ? frame_decorrelated : frame_ok)});
  }
  if (o.measured) c.measured = make_motion(o, truth, true);
  if (o.simulated) c.simulated = make_motion(o, model, false);
  if (o.measured && o.simulated && o.comparison)
    c.comparison = make_comparison(*c.measured, *c.simulated, truth, model);
  if (o.pairs) {
    c.pair_count = std::size_t(o.frames - 1);
    c.pair = [o, truth, metres_per_pixel](std::size_t k) { return make_field(o, truth, metres_per_pixel, k); };
  }
  if (o.pictures) s.pictures.push_back(make_picture(o, metres_per_pixel, o.frames > 12 ? 12 : 0));
  c.pictures = s.pictures;
  if (o.energy && o.simulated)
    for (int k = 0; k < o.frames; ++k) {
      EnergyRow e;
      e.time = k / rate_hz;
      const double a = std::sin(e.time / 0.5 * 3.14159);
      e.kinetic = 9 * a * a;
      e.elastic = 3.1 - 0.8 * e.time;
      e.plastic = 34 * std::pow(e.time / 0.5, 2.4);
      e.contact = 6 * std::pow(e.time / 0.5, 2);
      e.external = e.kinetic + e.plastic + e.contact - 0.8 * e.time;
      e.residual = -0.05 * e.time * e.external;
      c.energy.push_back(e);
    }
  if (o.reactions && o.simulated) {
    std::vector<ReactionRow> rows;
    for (int k = 0; k < o.frames; ++k) {
      const double t = k / rate_hz;
      rows.push_back({t, t, {{{0, 900 * t}, 40 * t, {0, 0}, 0}, {{-300 * t * t, 20 * t}, 5 * t, {-0.1 * t, 0}, 0}}});
    }
    c.reactions = reactions_of({"boundary.base", "body.plate"}, rows);
  }
  if (o.measured && o.pairs)
    c.remarks = {{"The node column nearest to the gate is masked where the gate's shadow falls.", RemarkWeight::doubt}};
  return s;
}

}  // namespace pivnp::report

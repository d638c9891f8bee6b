// A small run with known content, for the tests of the record.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>

#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::io::sample {

struct Size {
  std::size_t pairs = 5;
  int nx = 7, ny = 4;
  std::size_t particles = 11;
};

inline RecordHead head(const Size& s) {
  RecordHead h;
  h.command = "pivnp run case.toml";
  h.case_text = "name = \"sample, 1 g\"\n[piv]\nwindow_px = 32\n";
  h.grid.origin = Vec2(0.25, -1.5);
  h.grid.spacing = Vec2(0.5, 0.25);
  h.grid.nx = s.nx;
  h.grid.ny = s.ny;
  h.world_from_pixel << 2e-4, 0, 0.25, 0, -2e-4, 0.5, 0, 0, 1;
  h.camera_residual = 1.25e-5;
  h.metres_per_pixel = 2e-4;
  return h;
}

inline float value(std::size_t a, std::size_t b, std::size_t c) {
  return static_cast<float>(std::sin(0.7 * double(a) + 0.13 * double(b) + 1.9 * double(c)));
}

inline VectorField pair(const Size& s, std::size_t k) {
  VectorField f;
  f.pair = {static_cast<int>(k), static_cast<int>(k) + 1};
  f.anchor = Anchor::central;
  f.grid = head(s).grid;
  const std::size_t n = f.grid.node_count();
  f.displacement.resize(n);
  f.cov.resize(n);
  f.score.resize(n);
  f.status.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    f.displacement[i] = {value(k, i, 0), value(k, i, 1)};
    f.cov[i] = {value(k, i, 2), value(k, i, 3), value(k, i, 4)};
    f.score[i] = value(k, i, 5);
    if (k > 0) f.path_factor.push_back(value(k, i, 6));  // the first has none
    f.status[i] = static_cast<VectorStatus>((k + i) % 5);
    if (f.status[i] == VectorStatus::failed)
      f.displacement[i][0] = f.score[i] = std::numeric_limits<float>::quiet_NaN();
  }
  return f;
}

inline ParticleSet particles(const Size& s) {
  ParticleSet p;
  p.label_names = {"sand", "Schicht ü, wet"};
  for (std::size_t k = 0; k < s.particles; ++k) {
    p.id.push_back(static_cast<std::int64_t>(5'000'000'000LL + 3 * static_cast<std::int64_t>(k)));
    p.label.push_back(static_cast<std::int32_t>(k % 2));
    p.x0.push_back(Vec2(0.1 + 1.0 / 3.0 * double(k), -0.7 / double(k + 1)));
    p.area.push_back(0.03125f);
    p.born.push_back(0.0);
    p.end.push_back(std::numeric_limits<double>::quiet_NaN());
    p.end_reason.push_back(EndReason::none);
  }
  return p;
}

/// The same after the run: one particle has left.
inline ParticleSet particles_at_end(const Size& s) {
  ParticleSet p = particles(s);
  p.end[2] = 0.04;
  p.end_reason[2] = EndReason::no_vectors;
  return p;
}

inline double time(std::size_t k) { return 0.02 * double(k); }

inline MotionFrame frame(const Size& s, std::size_t k, bool simulated) {
  MotionFrame f;
  f.time = time(k);
  const std::size_t n = s.particles, side = simulated ? 100 : 0;
  std::span<float> stress, plastic_dev;
  if (simulated) stress = f.add("stress", n), plastic_dev = f.add("plastic_dev", n);
  for (std::size_t p = 0; p < n; ++p) {
    f.u.push_back({value(k, p, side), value(k, p, side + 1)});
    f.F.push_back({1 + 0.1f * value(k, p, side + 2), 0.1f * value(k, p, side + 3), 0.1f * value(k, p, side + 4),
                   1 + 0.1f * value(k, p, side + 5)});
    f.status.push_back(p == 2 && k > 2 ? ParticleStatus::ended : ParticleStatus::active);
    if (simulated) {
      f.v.push_back({value(k, p, side + 6), value(k, p, side + 7)});
      for (std::size_t c = 0; c < 4; ++c) stress[4 * p + c] = value(k, p, side + 8 + c);
      plastic_dev[p] = std::abs(value(k, p, side + 12));
    } else {
      f.cov_u.push_back({value(k, p, 6), value(k, p, 7), value(k, p, 8)});
    }
  }
  return f;
}

inline EnergyRow energy(std::size_t k) {
  EnergyRow r;
  r.time = time(k);
  r.kinetic = 0.1 * double(k);
  r.elastic = 2.0;
  r.plastic = 1e-9 * double(k);
  r.residual = -1e-12;
  return r;
}

inline const std::vector<std::string> reaction_names = {"boundary.base/left", "body.plate"};
inline ReactionRow reactions(std::size_t k) {
  ReactionRow r{.time = time(k), .stepped = time(k), .of = {}};
  r.of.push_back({{0.5 * double(k), -3.0 * double(k)}, 0.25 * double(k), {0, 0}, 0});
  r.of.push_back({{double(k * k), 0}, -1.0, {0.01 * double(k), 0}, 0.125});
  return r;
}

inline std::vector<Frame> frames(const Size& s) {
  std::vector<Frame> out;
  for (std::size_t k = 0; k <= s.pairs; ++k)
    out.push_back({"bild grün " + std::to_string(k) + ".png", time(k), k == 3 ? frame_decorrelated : frame_ok});
  return out;
}

inline Comparison comparison(const Size& s) {
  Comparison c;
  c.names = {"np", "mpm"};
  c.metrics = {{"displacement_rms", 0.004, "m", 0.0001, "RMS of the difference", Verdict::not_resolved, 2, LostIn::mesh,
                LimitFate::met, 0.00008},
               {"bias_x", -0.001, "m", std::numeric_limits<double>::quiet_NaN(), "mean difference", Verdict::none}};
  ComparisonField f{"difference_x", "m", "simulated minus measured", {0.0, 0.02}, particles(s).id, {}};
  for (std::size_t k = 0; k < 2 * s.particles; ++k) f.values.push_back(value(k, 0, 50));
  f.values[3] = std::numeric_limits<float>::quiet_NaN();
  c.fields.push_back(f);
  c.tables = {{"over_space", "statistics over the particles, time by time",
               {{"time", "s", {0.0, 0.02}}, {"displacement_rms", "m", {0.0, 0.004}, "RMS of the difference"}}}};
  return c;
}

/// A whole run as an engine chain would do it: every stage goes on from its last checkpoint. `pace` is called before
/// each item; `close_every`: a checkpoint is taken after so many items, or when the segment is full.
inline void run(
    const std::filesystem::path& directory, const Size& s, bool resume, std::size_t close_every = 64,
    const std::function<void()>& pace = [] {}, const std::vector<std::string>& fields = {"strain_dev", "velocity_x"}) {
  RecordWriter w(directory, head(s), resume);
  // The engine's state: the sum of what it did, so that a wrong checkpoint shows.
  const auto restore = [](const StageState& state) {
    double sum = 0;
    if (state.checkpoint.size() == sizeof sum) std::memcpy(&sum, state.checkpoint.data(), sizeof sum);
    return sum;
  };
  const auto store = [](double sum) {
    std::vector<std::byte> bytes(sizeof sum);
    std::memcpy(bytes.data(), &sum, sizeof sum);
    return bytes;
  };
  const StageState piv = w.stage("piv");
  if (!piv.complete) {
    double sum = restore(piv);
    for (std::size_t k = piv.items; k < s.pairs; ++k) {
      pace();
      VectorField f = pair(s, k);
      sum += f.cov[1][0];
      f.cov[0][0] = static_cast<float>(sum);
      w.add_pair(f);
      if (w.segment_full("piv") || (k + 1) % close_every == 0) w.close_segment("piv", store(sum));
    }
    w.end_stage("piv", nullptr);
  }
  for (const bool simulated : {false, true}) {
    const std::string name = simulated ? "mpm" : "np", stage = "motion/" + name;
    w.begin_motion(name, particles(s));
    const StageState state = w.stage(stage);
    if (state.complete) continue;
    double sum = restore(state);
    for (std::size_t k = state.items; k <= s.pairs; ++k) {
      pace();
      MotionFrame f = frame(s, k, simulated);
      sum += f.u[1][0];
      f.u[0][0] = static_cast<float>(sum);
      if (simulated) w.add_energy(name, energy(k));
      if (simulated) w.add_reactions(name, reaction_names, reactions(k));
      w.add_frame(name, f);
      if (w.segment_full(stage) || (k + 1) % close_every == 0) w.close_segment(stage, store(sum));
    }
    const ParticleSet last = particles_at_end(s);
    w.end_stage(stage, &last);
  }
  w.set_frames(frames(s));
  w.set_output_fields(fields);
  w.set_comparison(comparison(s));
  w.finish();
}

template <class Error>
std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "more than one line: " << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing thrown";
  return "";
}

/// Same bits, NaN included.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// A folder for a record.
class OfARecord : public ::testing::Test {
 protected:
  Size size;
  test::Scratch directory;
  std::filesystem::path record = directory.path / "record.h5";
};

}  // namespace pivnp::io::sample

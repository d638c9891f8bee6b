// The motion that the files of these tests hold, and the folder they are written to.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/import_motion.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::io {

namespace fs = std::filesystem;

constexpr double h = 0.5;
constexpr int nx = 6, ny = 5, steps = 3, every = 10;  // files are numbered 0, 10, 20

inline Vec2 material(int p) { return {2 + h * (p % nx), -1 + h * (p / nx)}; }
// x = X + u, affine: what comes back must be exact for any reader.
inline Mat2 gradient(int k) {
  Mat2 G;
  G << 0.10, 0.05, -0.04, -0.08;
  return double(k) * G;
}
inline Vec2 displacement(int p, int k) { return gradient(k) * material(p) + k * Vec2(0.3, -0.2); }
inline Vec2 velocity(int p) { return Vec2(0.1 * p, -1); }

class ImportTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  std::unique_ptr<MotionSource> open(const std::string& format, const std::string& pattern, double step = 0.01) const {
    return open_import(format + "=" + (folder / pattern).string(), {.step = step});
  }
  std::string refusal(const std::string& format, const std::string& pattern) const {
    try {
      const auto motion = open(format, pattern);
      motion->frame(motion->times().size() - 1);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  // Ids are 100 + p; `digits`: what the file's numbers are good for.
  void expect_motion(const MotionSource& m, bool ids, bool v, double digits) const {
    ASSERT_EQ(m.particles().size(), std::size_t(nx * ny));
    ASSERT_EQ(m.times().size(), std::size_t(steps));
    EXPECT_NEAR(m.times()[2], 2 * every * 0.01, 1e-12);
    EXPECT_EQ(m.length_unit(), "m");
    for (int k = 0; k < steps; ++k) {
      const MotionFrame f = m.frame(std::size_t(k));
      ASSERT_EQ(f.v.size(), v ? std::size_t(nx * ny) : 0U);
      for (int q = 0; q < nx * ny; ++q) {
        const std::size_t at = std::size_t(q);
        const int p = ids ? int(m.particles().id[at]) - 100 : q;
        EXPECT_NEAR((m.particles().x0[at] - material(p)).norm(), 0, digits);
        EXPECT_EQ(f.status[at], ParticleStatus::active);
        const Vec2 u = displacement(p, k);
        EXPECT_NEAR(double(f.u[at][0]), u.x(), digits);
        EXPECT_NEAR(double(f.u[at][1]), u.y(), digits);
        const Mat2 F = Mat2::Identity() + gradient(k);
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(double(f.F[at][std::size_t(c)]), F(c / 2, c % 2), 20 * digits);
        if (v) {
          EXPECT_NEAR(double(f.v[at][0]), velocity(p).x(), 1e-5);
        }
      }
    }
    EXPECT_TRUE(std::isnan(m.particles().end[0]));
  }
  const test::Scratch scratch;
  const fs::path& folder = scratch.path;
};

}  // namespace pivnp::io

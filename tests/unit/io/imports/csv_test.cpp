// Tables of tracks.
#include <algorithm>
#include <cstdio>

#include "import_sample.hpp"

namespace pivnp::io {
namespace {

TEST_F(ImportTest, TracksInOneTable) {
  std::string text = "\xef\xbb\xbf# tracked by hand\r\nframe; particle; x; y; sigma_x; sigma_y; quality\r\n";
  for (int p = nx * ny - 1; p >= 0; --p)
    for (int k = steps - 1; k >= 0; --k) {
      const Vec2 x = material(p) + displacement(p, k);
      char row[160];
      std::snprintf(row, sizeof row, "%d;%d; %.9f;%.9f;0.02;0.03;good\r\n", k * every, 100 + p, x.x(), x.y());
      text += row;
    }
  write("tracks.csv", text);
  const auto m = open("csv", "tracks.csv");
  expect_motion(*m, true, false, 1e-6);
  EXPECT_NEAR(double(m->frame(1).cov_u[4][1]), 0.0009, 1e-8);
}

TEST_F(ImportTest, OneTableAStep) {
  for (int k = 0; k < steps; ++k) {
    std::string text = "Particle Id,Points:0,Points:1,Displacement:0,Displacement:1,Velocity:0,Velocity:1\n";
    for (int p = 0; p < nx * ny; ++p) {
      const Vec2 u = displacement(p, k), x = material(p) + u;
      char row[200];
      std::snprintf(row, sizeof row, "%d,%.9g,%.9g,%.9g,%.9g,%.9g,-1\n", 100 + p, x.x(), x.y(), u.x(), u.y(),
                    velocity(p).x());
      text += row;
    }
    write("p" + std::to_string(k * every) + ".csv", text);
  }
  expect_motion(*open("csv", "p*.csv"), true, true, 1e-6);
}

TEST_F(ImportTest, TracksBeginAndEnd) {
  write("t.csv", "t,id,x,y\n0,1,0,0\n1,1,1,0\n2,1,2,0\n0,2,5,5\n1,2,5,6\n1,3,9,9\n2,3,9,8\n");
  const auto m = open("csv", "t.csv");
  ASSERT_EQ(m->particles().size(), 3U);
  EXPECT_TRUE(std::isnan(m->particles().end[0]));
  EXPECT_EQ(m->particles().end[1], 1);
  EXPECT_EQ(m->particles().born[2], 1);
  EXPECT_EQ(m->frame(0).status[2], ParticleStatus::unborn);
  EXPECT_EQ(m->frame(2).status[1], ParticleStatus::ended);
  EXPECT_NEAR(double(m->frame(2).u[2][1]), -1, 1e-6);  // from its first place
  EXPECT_TRUE(std::isnan(m->frame(1).F[0][0]));        // too few neighbours to say
}

// A tracker that finds a mark later, or loses it for good, writes nan.
TEST_F(ImportTest, ATrackMayBeginAndEndUnknown) {
  std::string text = "id,time,x,y\n";
  for (int t = 0; t < 4; ++t)
    for (int p = 0; p < 9; ++p) {
      const bool unknown = (p == 4 && t < 2) || (p == 7 && t > 1) || p == 8;
      text += std::to_string(p) + "," + std::to_string(t) + "," + (unknown ? "nan" : std::to_string(p % 3 + 0.5 * t)) + "," +
              std::to_string(p / 3) + "\n";
    }
  write("a.csv", text);
  const auto m = open("csv", "a.csv");
  const ParticleSet& set = m->particles();
  ASSERT_EQ(set.size(), 8u);  // the last is never seen
  const auto place = [&](std::int64_t id) {
    return std::size_t(std::find(set.id.begin(), set.id.end(), id) - set.id.begin());
  };
  const std::size_t late = place(4), lost = place(7);
  EXPECT_EQ(set.born[late], 2);
  EXPECT_EQ(set.x0[late], Vec2(2, 1));
  EXPECT_TRUE(std::isnan(set.end[late]));
  EXPECT_EQ(m->frame(1).status[late], ParticleStatus::unborn);
  EXPECT_EQ(m->frame(3).status[late], ParticleStatus::active);
  EXPECT_EQ(set.end[lost], 1);
  EXPECT_EQ(m->frame(2).status[lost], ParticleStatus::ended);
  // All move alike: displacements that count from different times strain nothing.
  const MotionFrame last = m->frame(3);
  EXPECT_EQ(last.F[place(0)], (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_TRUE(std::isnan(last.F[late][0]));
}

}  // namespace
}  // namespace pivnp::io

// A camera that moves, followed by what is at rest.
//   criterion: at most .02 px of its motion left anywhere in the image, by a zone, by targets and by the dominant motion; a
//     zone of which a part moves, a zone that is lost, and a zone that moves though nothing was to be removed are said.
#include "apps/study/methods/frames/camera_motion.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "tests/support/drawn_source.hpp"

namespace pivnp::app {
namespace camera_motion_tests {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int columns = 288, rows = 208;
const Vec2 middle((columns - 1) / 2.0, (rows - 1) / 2.0);

// Blobs that move by `place` (column and row), seen by a camera that moves; blank from frame `blank` on.
class Filmed final : public test::DrawnSource {
 public:
  using Place = std::function<Vec2(const Vec2& first, int frame)>;
  Filmed(CameraMotion camera, Place place, int blank = 1000)
      : DrawnSource(columns, rows, int(camera.at.size()), 1), camera_(std::move(camera)), place_(std::move(place)), blank_(blank), renderer_(texture(), columns, rows) {
    for (std::uint64_t n = 0; n < 6000; ++n)
      blobs_.emplace_back(uniform(7, 2 * n) * (columns + 80) - 40, uniform(7, 2 * n + 1) * (rows + 80) - 40);
  }
  Image read(int index) override {
    std::vector<Vec2> at;
    const Mat3 T = camera_.matrix(std::size_t(index));
    if (index < blank_)
      for (const Vec2& b : blobs_) {
        const Vec2 p = place_(b, index);
        at.push_back((T * Eigen::Vector3d(p.x(), p.y(), 1)).head<2>());
      }
    return renderer_.draw(at, index, int(frames().size()));
  }

 private:
  static image::TextureOptions texture() {
    image::TextureOptions o;
    o.noise = 0.01;
    return o;
  }
  CameraMotion camera_;
  Place place_;
  int blank_;
  image::BlobRenderer renderer_;
  std::vector<Vec2> blobs_;
};

Vec2 block_moves(const Vec2& p, int k) { return p.x() > 110 ? Vec2(p + k * Vec2(1.2, 0.6)) : p; }

CameraMotion camera(int frames = 4) {
  CameraMotion motion{middle, {}};
  for (int k = 0; k < frames; ++k) {
    CameraPlace p;
    p.shift = k == 0 ? Vec2(0, 0) : Vec2(k % 2 == 0 ? 3.1 : -2.7, 0.4 * k);
    p.turn = k > 1 ? 0.0035 : 0;
    p.scale = 1 + 0.0005 * k;
    motion.at.push_back(p);
  }
  return motion;
}

Case scene(const std::string& motion) {
  return parse_case(
      "name = \"moved\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 16\n"
      "[region.block]\npolygon_px = [[120, 8], [280, 8], [280, 200], [120, 200]]\n[piv]\nwindow_px = 32\n" + motion,
      "test", ".");
}

const std::string by_zone = "[camera.motion]\nfrom = \"still_zone\"\nsubset_px = 31\nzone_px = [[0, 0], [104, 0], [104, 207], [0, 207]]\n";

CameraMotion followed(const Case& c, image::FrameSource& source) {
  SilentProgress silent;
  return find_camera_motion(c, make_setting(c, columns, rows), source, 2, silent);
}

double left(const CameraMotion& found, const CameraMotion& truth) {
  double most = 0;
  for (std::size_t k = 0; k < truth.at.size(); ++k)
    for (const double c : {0.0, columns - 1.0})
      for (const double r : {0.0, rows - 1.0}) {
        const Eigen::Vector3d p(c, r, 1);
        most = std::max(most, (found.matrix(k).inverse() * truth.matrix(k) * p - p).head<2>().norm());
      }
  return most;
}

TEST(CameraMotion, IsFoundByZoneTargetsAndDominance) {
  const CameraMotion truth = camera();
  Filmed source(truth, block_moves);
  const std::string targets = "[camera.motion]\nfrom = \"targets\"\ntargets_px = [[30, 30], [80, 40], [30, 170], [80, 160], [50, 100]]\n";
  for (const std::string& how : {by_zone, targets, std::string("[camera.motion]\nfrom = \"dominant\"\nsubset_px = 31\n")}) {
    const Case c = scene(how);
    const CameraMotion found = followed(c, source);
    ASSERT_EQ(found.at.size(), truth.at.size()) << how;
    EXPECT_LT(left(found, truth), how == targets ? 0.06 : 0.02) << how;  // five targets at one side of the image
    const auto remarks = camera_motion_remarks(c, found, source.frames());
    ASSERT_EQ(remarks.size(), 1u) << how;
    EXPECT_THAT(remarks[0].text, HasSubstr("The camera moved"));
  }
}

TEST(CameraMotion, LeavesVectorsAsWithACameraAtRest) {
  Filmed moving(camera(), block_moves), resting({middle, std::vector<CameraPlace>(4)}, block_moves);
  const Case c = scene(by_zone), plain = scene("");
  Setting setting = make_setting(c, columns, rows);
  set_camera_motion(followed(c, moving), setting);
  for (const std::array<int, 2> pair : {std::array{0, 1}, {1, 2}, {2, 3}, {0, 3}}) {
    const VectorField here = measure_pair(c, setting, moving, pair, 2);
    const VectorField there = measure_pair(plain, make_setting(plain, columns, rows), resting, pair, 2);
    std::size_t both = 0;
    double sum = 0;
    for (std::size_t n = 0; n < here.status.size(); ++n) {
      const Vec2 x = setting.grid.position(int(n) % setting.grid.nx, int(n) / setting.grid.nx);
      const double column = setting.camera.to_pixel(x).x();
      if (here.status[n] != VectorStatus::valid || there.status[n] != VectorStatus::valid || std::abs(column - 112) < 40) continue;
      sum += std::pow(double(here.displacement[n][0] - there.displacement[n][0]), 2) +
             std::pow(double(here.displacement[n][1] - there.displacement[n][1]), 2);
      ++both;
    }
    EXPECT_GT(both, 60u);
    EXPECT_LT(std::sqrt(sum / double(both)), 0.03) << pair[0] << " to " << pair[1];
  }
}

TEST(CameraMotion, SaysThatAZoneIsNotAtRest) {
  Filmed source(camera(), [](const Vec2& p, int k) { return p.y() > 140 ? Vec2(p + k * Vec2(1.5, 0)) : p; });
  const Case c = scene(by_zone);
  const CameraMotion found = followed(c, source);
  EXPECT_LT(left(found, camera()), 0.06);  // what most of the zone shares is still the camera
  const auto remarks = camera_motion_remarks(c, found, source.frames());
  ASSERT_EQ(remarks.size(), 2u);
  EXPECT_THAT(remarks[1].text, HasSubstr("Not all of the still zone is at rest"));
}

TEST(CameraMotion, SaysWhereItIsLost) {
  Filmed source(camera(), block_moves, 2);
  const Case c = scene(by_zone);
  const CameraMotion found = followed(c, source);
  EXPECT_EQ(found.at[2].points, 0);
  EXPECT_EQ(found.at[2].shift, found.at[1].shift);
  const auto remarks = camera_motion_remarks(c, found, source.frames());
  EXPECT_THAT(remarks.back().text, HasSubstr("not known in 2 frames, first in frame 2"));
}

TEST(CameraMotion, IsSuspectedWhereAStillZoneMoves) {
  Filmed source(camera(), [](const Vec2& p, int) { return p; });
  const Case c = scene("[np]\nstill_zone_px = [[0, 0], [104, 0], [104, 207], [0, 207]]\n");
  const Setting setting = make_setting(c, columns, rows);
  const auto pair = [&](std::size_t k) { return measure_pair(c, setting, source, {int(k), int(k) + 1}, 2); };
  const auto remarks = still_zone_remarks(c, setting, 3, pair);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_THAT(remarks[0], HasSubstr("The still zone is not at rest"));
  Filmed resting({middle, std::vector<CameraPlace>(3)}, [](const Vec2& p, int) { return p; });
  EXPECT_THAT(still_zone_remarks(c, setting, 2, [&](std::size_t k) { return measure_pair(c, setting, resting, {int(k), int(k) + 1}, 2); }),
              IsEmpty());
}

// At rest, and measured with an error of 0.02 px that all its nodes share: after 120 steps it has added up to more than 0.1 px.
TEST(CameraMotion, IsNotSuspectedForTheVectorsOwnError) {
  const Case c = scene("[np]\nstill_zone_px = [[0, 0], [104, 0], [104, 207], [0, 207]]\n");
  const Setting setting = make_setting(c, columns, rows);
  double drift = 0, place = 0, most = 0;
  const auto pair = [&](std::size_t k) {
    VectorField field;
    field.pair = {int(k), int(k) + 1};
    field.grid = setting.grid;
    field.correlation_length = 1e4f;
    const double error = 0.02 * std::sqrt(12.0) * (uniform(77, k) - 0.5) + drift;
    place += error;
    most = std::max(most, std::abs(place));
    field.displacement.assign(setting.grid.node_count(), {float(error), 0});
    field.status.assign(setting.grid.node_count(), VectorStatus::valid);
    field.cov.assign(setting.grid.node_count(), {4e-4f, 4e-4f, 0});
    return field;
  };
  EXPECT_THAT(still_zone_remarks(c, setting, 120, pair), IsEmpty());
  EXPECT_GT(most, 0.1);
  drift = 0.03;
  EXPECT_EQ(still_zone_remarks(c, setting, 120, pair).size(), 1u);
}

// A tool with texture that sinks and turns before still ground: its mask goes with it, pixel by pixel of its outline.
TEST(MovingMasks, FollowATool) {
  const auto at = [](const Vec2& p, int k) {
    const Vec2 r = p - Vec2(150, 80);
    if (std::abs(r.x()) > 40 || std::abs(r.y()) > 30) return p;
    const double a = 0.01 * k;
    return Vec2(Vec2(150, 80) + Vec2(std::cos(a) * r.x() - std::sin(a) * r.y(), std::sin(a) * r.x() + std::cos(a) * r.y()) + k * Vec2(0.8, 3.3));
  };
  Filmed source({middle, std::vector<CameraPlace>(4)}, at);
  const Case c = scene("[mask.tool]\npolygon_px = [[110, 50], [190, 50], [190, 110], [110, 110]]\nfollow = true\n");
  Setting setting = make_setting(c, columns, rows);
  SilentProgress silent;
  follow_masks(c, setting, source, 2, silent);
  const std::vector<Vec2> outline = setting.moving_masks.outlines(3).at(0), start = setting.moving_masks.outlines(0).at(0);
  for (std::size_t k = 0; k < outline.size(); ++k) EXPECT_LT((outline[k] - at(start[k], 3)).norm(), 0.15) << k;
  const Image last = source.read(3);
  const image::Mask mask = mask_of(setting, 3, last.view());
  EXPECT_FALSE(mask.view().usable(152, 90));
  EXPECT_FALSE(mask.view().usable(152, 116));  // below where the tool began
  EXPECT_TRUE(mask.view().usable(152, 55));    // above where it is
  // No vector is measured on it, and the ground beside it keeps its own.
  const VectorField field = measure_pair(c, setting, source, {2, 3}, 2);
  for (std::size_t n = 0; n < field.status.size(); ++n) {
    const Vec2 p = setting.camera.to_pixel(setting.grid.position(int(n) % setting.grid.nx, int(n) / setting.grid.nx));
    if (std::abs(p.x() - 152) < 20 && std::abs(p.y() - 88) < 12) {
      EXPECT_EQ(field.status[n], VectorStatus::masked);
    }
    if (p.x() < 60 && field.status[n] == VectorStatus::valid) {
      EXPECT_LT(std::abs(field.displacement[n][1]), 0.05f);
    }
  }
}

TEST(CameraMotion, RefusesWhatCannotBeFollowed) {
  Filmed source(camera(), block_moves);
  const auto error = [&](const std::string& motion) {
    try {
      followed(scene(motion), source);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(error("[camera.motion]\nfrom = \"still_zone\"\n"), HasSubstr("zone_px: missing"));
  EXPECT_THAT(error("[camera.motion]\nfrom = \"still_zone\"\nzone_px = [[0, 0], [20, 0], [20, 20]]\n"), HasSubstr("a larger zone"));
  EXPECT_THAT(error("[camera.motion]\nfrom = \"targets\"\ntargets_px = [[5, 100], [50, 50]]\n"), HasSubstr("from the image's edge"));
  EXPECT_THAT(error("[camera.motion]\nfrom = \"targets\"\n"), HasSubstr("targets_px: missing"));
  EXPECT_THAT(error("[camera.motion]\nfrom = \"targets\"\nzone_px = [[0, 0], [20, 0], [20, 20]]\n"), HasSubstr("expected from = \"still_zone\""));
}

}  // namespace camera_motion_tests
}  // namespace pivnp::app

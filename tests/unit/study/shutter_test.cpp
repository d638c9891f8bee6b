// Rolling shutter and exposure.
//   criterion: on frames drawn row by row, each at its own time, of material that accelerates by .6 px a frame each frame, the
//     recorded vectors are those of a global shutter within .03 px RMS (those that are not corrected are off by .1 and more), for
//     both ways of reading; a camera's mask in the world goes with what a moving camera sees; blur is said.
#include "apps/study/pipeline/measure/shutter.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>

#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/drawn_source.hpp"

namespace pivnp::app {
namespace shutter_tests {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int columns = 224, rows = 192, count = 6;

Vec2 moved(double t) { return {1.1 * t - 0.2 * t * t, 1.5 * t + 0.3 * t * t}; }  // px, since frame 0

// Row r of frame k shows the time k + row_time (r - middle row), a frame a second.
class Scanned final : public test::DrawnSource {
 public:
  explicit Scanned(double row_time) : DrawnSource(columns, rows, count, 1), row_time_(row_time), renderer_(texture(), columns, rows) {
    for (std::uint64_t n = 0; n < 4800; ++n)
      blobs_.emplace_back(uniform(17, 2 * n) * (columns + 100) - 60, uniform(17, 2 * n + 1) * (rows + 100) - 70);
  }
  Image read(int index) override {
    std::vector<Vec2> at;
    for (const Vec2& b : blobs_) {
      double t = index;  // when the row that shows the blob is read
      for (int n = 0; n < 30; ++n) t = index + row_time_ * (b.y() + moved(t).y() - (rows - 1) / 2.0);
      at.push_back(b + moved(t));
    }
    return renderer_.draw(at, index, count);
  }

 private:
  static image::TextureOptions texture() {
    image::TextureOptions o;
    o.density_per_px = 0.07;
    o.noise = 0.01;
    return o;
  }
  double row_time_;
  image::BlobRenderer renderer_;
  std::vector<Vec2> blobs_;
};

Case scene(const std::string& camera, const std::vector<std::string>& set = {}) {
  return parse_case("name = \"rows\"\n[frames]\npath = \"drawn\"\nrate_hz = 1.0\n[camera]\n" + camera +
                        "[grid]\nspacing_px = 16\n[piv]\nwindow_px = 32\n", "test", ".", set);
}

// RMS distance of the recorded vectors from those at the frames' own times, px.
double off(const Case& c, double row_time) {
  Scanned source(row_time);
  const Setting setting = make_setting(c, columns, rows);
  const auto folder = std::filesystem::temp_directory_path() / ("pivnp_shutter_" + std::to_string(::getpid()));
  SilentProgress silent;
  double sum = 0;
  std::size_t vectors = 0;
  {
    io::RecordHead head;
    head.grid = setting.grid;
    io::RecordWriter writer(folder, head, false);
    measure(c, setting, source, writer, 2, silent);
    for (int k = 0; k + 1 < count; ++k) {
      const VectorField field = writer.pair(std::size_t(k));
      EXPECT_EQ(field.pair[0], k);
      const Vec2 truth = moved(k + 1) - moved(k);
      for (std::size_t n = 0; n < field.status.size(); ++n) {
        if (field.status[n] != VectorStatus::valid) continue;
        sum += (Vec2(double(field.displacement[n][0]), -double(field.displacement[n][1])) - truth).squaredNorm();
        ++vectors;
      }
    }
  }
  std::filesystem::remove_all(folder);
  EXPECT_GT(vectors, 5u * 60u);
  return std::sqrt(sum / double(vectors));
}

TEST(RollingShutter, IsTakenOffTheVectors) {
  constexpr double row_time = 0.8 / rows;
  EXPECT_LT(off(scene(""), 0), 0.02);
  EXPECT_GT(off(scene(""), row_time), 0.1);
  const double left = off(scene("row_time_s = " + std::to_string(row_time) + "\n"), row_time);
  EXPECT_LT(left, 0.03);
  RecordProperty("left_px", std::to_string(left));
  EXPECT_LT(off(scene("row_time_s = " + std::to_string(-row_time) + "\n"), -row_time), 0.03);
}

TEST(RollingShutter, CorrectsTheDurationOfAPairAlone) {
  Scanned source(0.4 / rows);
  const Case c = scene("row_time_s = " + std::to_string(0.4 / rows) + "\n");
  const Setting setting = make_setting(c, columns, rows);
  const VectorField with = measure_pair(c, setting, source, {3, 4}, 2), without = measure_pair(scene(""), setting, source, {3, 4}, 2);
  for (std::size_t n = 0; n < with.status.size(); ++n)
    if (with.status[n] == VectorStatus::valid) {
      const double down = -double(without.displacement[n][1]);
      EXPECT_NEAR(double(with.displacement[n][1]), -down / (1 + 0.4 / rows * down), 1e-4);
    }
}

TEST(Shutter, SaysWhatBlursAndWhatIsCorrected) {
  Scanned source(0);
  const Setting setting = make_setting(scene(""), columns, rows);
  const auto pair = [&](std::size_t k) { return measure_pair(scene(""), setting, source, {int(k), int(k) + 1}, 2); };
  const auto said = [&](const std::string& camera) { return shutter_remarks(scene(camera), setting, source.frames(), 2, pair); };
  EXPECT_THAT(said(""), IsEmpty());
  EXPECT_THAT(said("exposure_s = 0.1\n"), IsEmpty());  // .25 px
  const auto blurred = said("exposure_s = 0.3\nrow_time_s = 0.001\n");
  ASSERT_EQ(blurred.size(), 2u);
  EXPECT_THAT(blurred[0].text, HasSubstr("blurred by motion"));  // .3 s of 2.4 px/s
  EXPECT_THAT(blurred[0].text, HasSubstr("0.7"));
  EXPECT_THAT(blurred[1].text, HasSubstr("Rows are read one after the other, in 0.191 s"));
}

TEST(RollingShutter, RefusesWhatItCannotGoWith) {
  const auto error = [](const std::string& rest, const std::vector<std::string>& set = {}) {
    try {
      scene("row_time_s = 1e-4\n" + rest, set);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(error(""), "");
  EXPECT_THAT(error("[camera.motion]\nfrom = \"dominant\"\n"), HasSubstr("camera.row_time_s: given together with [camera.motion]"));
  EXPECT_THAT(error("", {"piv.method=fft", "piv.ensemble=4"}), HasSubstr("camera.row_time_s: given together with piv.ensemble"));
  EXPECT_THAT(error("[np]\ndrift = \"corrected\"\n"), HasSubstr("camera.row_time_s: given together with np.drift"));
}

// A polygon in the world goes with the camera; one in pixels stays in the image.
TEST(MovingMasks, InTheWorldGoWithTheCamera) {
  const Case c = parse_case(
      "name = \"moved\"\n[frames]\npath = \"drawn\"\n[camera]\nmetres_per_pixel = 0.01\n[camera.motion]\nfrom = \"dominant\"\n"
      "[mask.base]\npolygon_m = [[0.5, 0.5], [1.0, 0.5], [1.0, 0.9], [0.5, 0.9]]\n"
      "[mask.dirt]\npolygon_px = [[150, 20], [170, 20], [170, 40], [150, 40]]\n", "test", ".");
  Setting setting = make_setting(c, columns, rows);
  const Image frame = Scanned(0).read(0);
  EXPECT_FALSE(setting.mask.view().usable(51, rows - 1 - 51));  // first frame: (0.51, 0.51) m
  CameraMotion motion{Vec2((columns - 1) / 2.0, (rows - 1) / 2.0), std::vector<CameraPlace>(2)};
  motion.at[1].shift = {12, 5};
  set_camera_motion(motion, setting);
  const image::Mask first = mask_of(setting, 0, frame.view()), second = mask_of(setting, 1, frame.view());
  EXPECT_FALSE(first.view().usable(52, rows - 1 - 60));
  EXPECT_TRUE(first.view().usable(110, rows - 1 - 60));
  EXPECT_TRUE(second.view().usable(52, rows - 1 - 60));
  EXPECT_FALSE(second.view().usable(110, rows - 1 - 60));
  EXPECT_TRUE(second.view().usable(75, rows - 1 - 88));
  for (const image::Mask* mask : {&first, &second}) EXPECT_FALSE(mask->view().usable(151, 21));
  EXPECT_TRUE(second.view().usable(175, 42));
}

}  // namespace shutter_tests
}  // namespace pivnp::app

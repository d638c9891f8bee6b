// A record as it is shown: with frames and without, values that are those of the record.
#include "apps/view/model/record_look.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/refusal.hpp"
#include "tests/unit/view/drawn_shear.hpp"

namespace pivnp::view {
namespace {

TEST(RecordLook, ShowsWhatTheRecordHolds) {
  const test::Scratch scratch;
  std::filesystem::copy(test::drawn_shear(), scratch.path / "frames");
  const std::filesystem::path record = test::measured_record(scratch.path / "frames", scratch.path / "out");
  {
    const RecordLook look(record);
    EXPECT_EQ(look.motions(), std::vector<std::string>{"np"});
    EXPECT_EQ(look.times().size(), std::size_t(test::drawn_frames));
    EXPECT_TRUE(look.has_frames());
    EXPECT_NEAR(look.box().width(), test::drawn_width * 2e-4, 1e-3);
    const double last = look.times().back();
    const ParticlePicture moved = look.picture("np", "displacement_y", last);
    ASSERT_TRUE(moved.known);
    const plot::Scale scale = scale_of({&moved}, 0.01);
    EXPECT_NEAR(scale.upper, 0.3 * 2e-4 * (test::drawn_frames - 1), 3e-5);
    EXPECT_EQ(moved.sigma.size(), moved.field.value.size());
    const ParticlePicture error = look.picture("np", "displacement_error", last);
    EXPECT_GT(scale_of({&error}, 0.01).upper, 0);
    EXPECT_EQ(look.frame(last)->width(), test::drawn_width);
    EXPECT_EQ(look.vectors(look.times()[2])->pair, (std::array{2, 3}));
    const plot::Raster raster = raster_of(moved, scale, look.box(), 120);
    EXPECT_EQ(raster.width, 120);
    // Where it is clicked, the history ends with what was read there.
    const Vec2 middle = (look.box().lower + look.box().upper) / 2;
    const History history = look.history("np", moved, middle, {"np"});
    ASSERT_EQ(history.sides.size(), 1u);
    const auto& curve = history.sides[0].curve;
    ASSERT_EQ(curve.time.size(), std::size_t(test::drawn_frames));
    EXPECT_GT(curve.displacement.back(), 0.5 * 2e-4 * (test::drawn_frames - 1));
    EXPECT_EQ(curve.sigma.size(), curve.time.size());
    EXPECT_NE(test::refusal([&] { look.history("np", moved, {1, 1}, {"np"}); }), "");
    EXPECT_THAT(csv_of(moved, look.motion("np"), {"displacement_y", "", "m"}), testing::StartsWith("id,x0 [m],y0 [m],x [m],y [m],status,displacement_y [m],sigma [m]\n"));
    // A motion less itself is nothing.
    const ParticlePicture zero = RecordLook::difference(moved, moved, look.motion("np"), look.motion("np"));
    for (const double v : zero.field.value) EXPECT_TRUE(v == 0 || std::isnan(v));
  }
  std::filesystem::remove_all(scratch.path / "frames");
  const RecordLook without(record);
  EXPECT_FALSE(without.has_frames());
  EXPECT_NE(without.complaint(), "");
  EXPECT_EQ(without.frame(0), nullptr);
  EXPECT_TRUE(without.picture("np", "strain_dev", without.times().back()).known);
}

TEST(RecordLook, AHostileFileIsRefused) {
  const test::Scratch scratch;
  std::ofstream(scratch.path / "record.h5") << "this is no record";
  EXPECT_THAT(test::refusal([&] { RecordLook look(scratch.path); }), testing::HasSubstr("record.h5"));
}

}  // namespace
}  // namespace pivnp::view

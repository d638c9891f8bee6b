// Regions that move with their material, as masks of what is correlated.
//   criterion: along a layer that slides over ground of the material's own texture, vectors whose window is at least half
//   inside are right within .05 px by every method (without the mask they are off by .15 px and more), by 2 and 12 px a
//   frame; particles of the outer half window are right within .1 px or flagged. Ground that is bared or buried is told by
//   its motion. A check draws outlines within 1.5 px of where they are. A region that ends within material that moves, and one at rest, leave the vectors' bits as they are. A run
//   that is taken up again has the same vectors; a region that is lost is said.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/pipeline/measure/material_masks.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/pipeline/measure/moving_regions.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "apps/study/studies/check_regions.hpp"
#include "tests/support/drawn_source.hpp"
#include "tests/support/piv_sequence.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace moving_regions_tests {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int side = 256, surface = 128;

class Drawn final : public test::DrawnSource {
 public:
  explicit Drawn(piv::Sequence s) : DrawnSource(s.width, s.height, s.frames, 1), s_(std::move(s)) {}
  Image read(int index) override { return piv::draw(s_, index); }

 private:
  piv::Sequence s_;
};

// A layer below the middle row that slides to the right over ground.
piv::Sequence sliding(double step, double behind, int frames = 4, double shear = 0) {
  piv::Sequence s{.width = side, .height = side, .frames = frames, .seed = 31, .behind = behind, .noise = .01};
  s.place = [=](const Vec2& X, int k) -> Vec2 { return X + k * Vec2(step - shear * (X.y() - surface), 0); };
  s.material = [](const Vec2& X) { return X.y() > surface; };
  return s;
}

struct Measured {
  Setting setting;
  std::vector<VectorField> pairs;
  std::vector<std::string> remarks;
  std::shared_ptr<MotionMemory> motion;
};

Case scene(const std::string& keys, const std::string& polygon) {
  return parse_case("name = \"surface\"\n[frames]\npath = \"drawn\"\nrate_hz = 1\n[grid]\nspacing_px = 8\n[region.sand]\npolygon_px = " + polygon + "\n[piv]\n" + keys,
                    "test", ".");
}

const std::string layer = "[[-60, 128.5], [316, 128.5], [316, 300], [-60, 300]]";

Measured measured(const piv::Sequence& s, const std::string& keys, const std::string& polygon = layer) {
  const Case c = scene(keys, polygon);
  Drawn source(s);
  test::Scratch scratch;
  Measured out;
  out.setting = make_setting(c, s.width, s.height);
  RunSettings settings;
  settings.out = scratch.path;
  io::RecordWriter writer(scratch.path, record_head(c, out.setting, settings), false);
  for (const Remark& r : measure(c, out.setting, source, writer, 1, silent)) out.remarks.push_back(r.text);
  for (int k = 0; k + 1 < s.frames; ++k) out.pairs.push_back(writer.pair(std::size_t(k)));
  track(c, out.setting, source.frames(), &source, {}, writer, 1, silent);
  writer.set_frames(source.frames());
  writer.pack();
  const auto motion = writer.motion("np");
  out.motion = std::make_shared<MotionMemory>("np", motion->length_unit(), motion->time_unit(), motion->particles());
  for (std::size_t k = 0; k < motion->times().size(); ++k) out.motion->add(motion->frame(k));
  return out;
}

// Of valid vectors within 16 px of the surface (`rim`) and well inside, against what the layer moves by.
struct Errors {
  double rim = 0, inside = 0, valid = 0;
};

Errors errors(const Measured& m, const piv::Sequence& s) {
  constexpr int top = surface;
  Errors e;
  double rim = 0, inside = 0, asked = 0;
  for (const VectorField& field : m.pairs)
    for (std::size_t n = 0; n < field.status.size(); ++n) {
      const Vec2 px = m.setting.camera.to_pixel(field.grid.position(int(n % std::size_t(field.grid.nx)), int(n / std::size_t(field.grid.nx))));
      if (px.x() < 48 || px.y() <= top || (px.y() > top + 16 && px.y() < top + 48)) continue;
      const double truth = s.place(px, 1).x() - px.x();
      const bool near = px.y() <= top + 16, valid = field.status[n] == VectorStatus::valid;
      asked += near, e.valid += near && valid;
      if (!valid) continue;
      const double off = std::pow(double(field.displacement[n][0]) - truth, 2) + std::pow(double(field.displacement[n][1]), 2);
      near ? (e.rim += off, ++rim) : (e.inside += off, ++inside);
    }
  e.rim = std::sqrt(e.rim / (2 * rim)), e.inside = std::sqrt(e.inside / (2 * inside)), e.valid /= asked;
  return e;
}

bool same(const Measured& a, const Measured& b) {
  for (std::size_t k = 0; k < a.pairs.size(); ++k)
    for (std::size_t n = 0; n < a.pairs[k].status.size(); ++n)
      for (const std::size_t part : {std::size_t(0), std::size_t(1)}) {
        const float x = a.pairs[k].displacement[n][part], y = b.pairs[k].displacement[n][part];
        if (a.pairs[k].status[n] != b.pairs[k].status[n] || (x != y && !(std::isnan(x) && std::isnan(y)))) return false;
      }
  return true;
}

TEST(MovingRegions, VectorsAtASurfaceAreOfTheMaterialAlone) {
  for (const char* method : {"gn", "fast", "fft"})
    for (const double step : {2.0, 12.0}) {
      const piv::Sequence s = sliding(step, 1, 3);
      const std::string keys = std::string("method = \"") + method + "\"\n";
      const Errors with = errors(measured(s, keys), s), without = errors(measured(s, keys + "follow_regions = false\n"), s);
      EXPECT_LT(with.rim, 0.02) << method << " " << step;
      EXPECT_GT(with.valid, 0.9) << method << " " << step;
      EXPECT_GT(without.rim, 0.03) << method << " " << step;
      EXPECT_GT(without.rim, 4 * with.rim) << method << " " << step;
    }
}

TEST(MovingRegions, MeansOfPairsAndRowsThatAreReadInTurnObeyThem) {
  const piv::Sequence s = sliding(6, 1, 5);
  for (const std::string keys : {"method = \"fft\"\nensemble = 2\n", "[camera]\nrow_time_s = 0.002\n"}) {
    const Errors with = errors(measured(s, keys), s), without = errors(measured(s, keys[0] == '[' ? "follow_regions = false\n" + keys : keys + "follow_regions = false\n"), s);
    EXPECT_LT(with.rim, 0.03) << keys;
    EXPECT_GT(with.valid, 0.8) << keys;
    EXPECT_GT(without.rim, 4 * with.rim) << keys;
  }
}

// Pairs of frames further apart, as closure and dropped frames ask for.
TEST(MovingRegions, DirectPairsObeyThem) {
  const piv::Sequence s = sliding(3, 1, 5);
  const Case c = scene("", layer);
  Drawn source(s);
  const Measured m = measured(s, "");
  MaterialMasks material(c, m.setting, [&](int k) { return m.pairs[std::size_t(k)]; });
  for (MaterialMasks* masks : {&material, static_cast<MaterialMasks*>(nullptr)}) {
    Measured direct;
    direct.setting = m.setting;
    direct.pairs = {measure_pair(c, m.setting, source, {1, 4}, 1, masks)};
    piv::Sequence far = s;
    far.place = [&](const Vec2& X, int) { return s.place(X, 3); };
    const Errors e = errors(direct, far);
    if (masks) EXPECT_LT(e.rim, 0.02);
    else EXPECT_GT(e.rim, 0.1);
  }
}

TEST(MovingRegions, FaintGroundIsLeftOutAndSaid) {
  const piv::Sequence s = sliding(2, .3);
  const Measured m = measured(s, "");
  const Errors e = errors(m, s);
  EXPECT_LT(e.rim, 2 * e.inside);
  EXPECT_THAT(m.remarks, Contains(HasSubstr("as masks")));
}

TEST(MovingRegions, NothingIsLeftOutWithinMaterialBeforePlainGroundAndAtRest) {
  const piv::Sequence whole = [] { piv::Sequence s = sliding(3, 1); s.material = {}; return s; }();
  EXPECT_TRUE(same(measured(whole, ""), measured(whole, "follow_regions = false\n")));
  const piv::Sequence still = sliding(0, 1), plain = sliding(3, 0);
  EXPECT_TRUE(same(measured(still, ""), measured(still, "follow_regions = false\n")));
  EXPECT_TRUE(same(measured(plain, ""), measured(plain, "follow_regions = false\n")));
}

// A block that moves to the right over ground: bared behind it, buried before it.
TEST(MovingRegions, GroundIsBaredAndBuried) {
  piv::Sequence s = sliding(6, 1, 5);
  s.material = [](const Vec2& X) { return X.x() > 60.5 && X.x() < 160.5 && X.y() > 40.5 && X.y() < 200.5; };
  const auto off = [&](const std::string& keys) {
    const Measured m = measured(s, keys, "[[60.5, 40.5], [160.5, 40.5], [160.5, 200.5], [60.5, 200.5]]");
    double sum = 0, count = 0;
    for (const VectorField& field : m.pairs)
      for (std::size_t n = 0; n < field.status.size(); ++n) {
        const Vec2 px = m.setting.camera.to_pixel(field.grid.position(int(n % std::size_t(field.grid.nx)), int(n / std::size_t(field.grid.nx)))),
                   from = px - Vec2(6 * field.pair[0] + 3, 0);
        if (!s.material(from) || field.status[n] != VectorStatus::valid) continue;
        sum += std::pow(double(field.displacement[n][0]) - 6, 2) + std::pow(double(field.displacement[n][1]), 2), ++count;
      }
    return std::sqrt(sum / (2 * count));
  };
  EXPECT_LT(off(""), 0.03);
  EXPECT_GT(off("follow_regions = false\n"), 0.3);
}

// What `pivnp check` draws: the outline in the first, the middle and the last frame.
TEST(MovingRegions, ACheckDrawsThemWhereTheBlockIs) {
  piv::Sequence s = sliding(6, 1, 5);
  s.material = [](const Vec2& X) { return X.x() > 60.5 && X.x() < 160.5 && X.y() > 40.5 && X.y() < 200.5; };
  const std::string block = "[[60.5, 40.5], [160.5, 40.5], [160.5, 200.5], [60.5, 200.5]]";
  Drawn source(s);
  const Case c = scene("", block);
  const Setting setting = make_setting(c, side, side);
  const RegionsAlongFrames drawn = regions_along_frames(c, setting, source, 1, silent);
  ASSERT_EQ(drawn.seen.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) {
    const RegionsInFrame& frame = drawn.seen[n];
    ASSERT_EQ(frame.frame, int(2 * n));
    ASSERT_EQ(frame.outlines.size(), 1u);
    double left = 1e9, right = -1e9;
    for (const OutlinePoint& p : frame.outlines[0].points) {
      const double x = setting.camera.to_pixel(p.place).x();
      left = std::min(left, x), right = std::max(right, x);
    }
    EXPECT_NEAR(left, 60.5 + 12.0 * double(n), 1.5) << frame.frame;
    EXPECT_NEAR(right, 160.5 + 12.0 * double(n), 1.5) << frame.frame;
  }
  EXPECT_TRUE(regions_along_frames(scene("follow_regions = false\n", block), setting, source, 1, silent).seen.empty());
}

TEST(MovingRegions, ParticlesBelowTheSurfaceAreRightOrFlagged) {
  const piv::Sequence s = sliding(6, 1, 6, 0.02);
  const Measured m = measured(s, "");
  const ParticleSet& set = m.motion->particles();
  const MotionFrame last = m.motion->frame(5);
  double near = 0, wrong = 0, one = 0, two = 0, told = 0;
  for (std::size_t p = 0; p < set.size(); ++p) {
    const Vec2 px = m.setting.camera.to_pixel(set.x0[p]);
    if (px.x() < 48 || px.x() > 180 || px.y() > surface + 16 || last.status[p] == ParticleStatus::ended) continue;
    const Vec2 d = s.place(px, 5) - px, off(double(last.u[p][0]) - d.x(), double(last.u[p][1]) + d.y());
    ++near, wrong += off.norm() > 0.1 && last.status[p] == ParticleStatus::active;
    for (const int c : {0, 1}) {
      const double sigma = std::sqrt(double(last.cov_u[p][std::size_t(c)]));
      ++told, one += std::abs(off[c]) < sigma, two += std::abs(off[c]) < 2 * sigma;
    }
  }
  EXPECT_GT(near, 100);
  EXPECT_LE(wrong, 0.02 * near);
  EXPECT_GE(two, 0.9 * told) << one / told << " within one, " << two / told << " within two";
}

// Ground at rest is told from material by less than half a pixel of slip too: otherwise the rows beside it fall behind, unflagged.
TEST(MovingRegions, SlowSlipIsNotTakenForRest) {
  for (const double step : {.14, .37}) {
    piv::Sequence s = sliding(step, 1, 21);
    s.width = 208, s.height = 160;
    s.material = [](const Vec2& X) { return X.y() > 72; };
    const Measured m = measured(s, "", "[[-60, 72.5], [268, 72.5], [268, 220], [-60, 220]]");
    const MotionFrame last = m.motion->frame(20);
    double near = 0, silent = 0, behind = 0;
    for (std::size_t p = 0; p < m.motion->particles().size(); ++p) {
      const Vec2 px = m.setting.camera.to_pixel(m.motion->particles().x0[p]);
      if (px.x() < 40 || px.x() > 160 || px.y() > 72 + 8 || last.status[p] == ParticleStatus::ended) continue;
      const double off = double(last.u[p][0]) - 20 * step;
      ++near, silent += last.status[p] == ParticleStatus::active && std::abs(off) > 3 * std::sqrt(double(last.cov_u[p][0])), behind -= off;
    }
    ASSERT_GT(near, 40);
    EXPECT_LE(silent, .02 * near) << step;
    EXPECT_LT(behind / near, .02 * 20 * step) << step;
  }
}

TEST(MovingRegions, ARegionThatIsLostIsSaid) {
  piv::Sequence s = sliding(2, 1, 4);
  const auto place = s.place;
  s.place = [=](const Vec2& X, int k) { return k < 2 ? place(X, k) : Vec2(X + Vec2(5000, 0)); };  // the material is gone
  s.material = [](const Vec2& X) { return X.y() > surface; };
  s.behind = 0;
  EXPECT_THAT(measured(s, "").remarks, Contains(HasSubstr("Region 'sand' was lost after frame")));
}

// Two groups of pairs; the second is measured by a run that is taken up again.
TEST(MovingRegions, ARunThatIsTakenUpAgainHasTheSameVectors) {
  struct Stopping final : Progress {
    int left;
    explicit Stopping(int pairs) : left(pairs) {}
    void update(std::string_view, std::int64_t, std::int64_t) override { --left; }
    bool stop_requested() const override { return left <= 0; }
  };
  piv::Sequence s = sliding(.6, 1, 67);
  s.width = 128, s.height = 96;
  s.material = [](const Vec2& X) { return X.y() > 48; };
  const Case c = scene("", "[[-80, 48.5], [200, 48.5], [200, 140], [-80, 140]]");
  Drawn source(s);
  const Setting setting = make_setting(c, s.width, s.height);
  const auto vectors = [&](bool stops) {
    test::Scratch scratch;
    RunSettings settings;
    settings.out = scratch.path;
    if (stops) {
      io::RecordWriter writer(scratch.path, record_head(c, setting, settings), false);
      Stopping progress(65);
      EXPECT_THROW(measure(c, setting, source, writer, 1, progress), Interrupted);
    }
    io::RecordWriter writer(scratch.path, record_head(c, setting, settings), stops);
    EXPECT_EQ(writer.stage("piv").items, stops ? 64 : 0);
    Measured out;
    for (const Remark& r : measure(c, setting, source, writer, 1, silent)) out.remarks.push_back(r.text);
    for (int k = 0; k + 1 < s.frames; ++k) out.pairs.push_back(writer.pair(std::size_t(k)));
    return out;
  };
  const Measured whole = vectors(false);
  EXPECT_THAT(whole.remarks, Contains(HasSubstr("as masks")));
  EXPECT_TRUE(same(whole, vectors(true)));
}

}  // namespace moving_regions_tests
}  // namespace pivnp::app

// Texture that stands still in front of material that moves.
//   criterion: dirt on the glass is found by itself, and neither clean frames nor material at rest, nor a floor at rest, are taken
//   for it; taken out, paths are at most a fifth as wrong; of material at rest nothing is taken out, and nothing unasked.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/methods/frames/fixed_pattern.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "pivnp/core/progress.hpp"
#include "tests/support/drawn_source.hpp"
#include "tests/support/piv_sequence.hpp"
#include "tests/support/shaded_grains.hpp"

namespace pivnp::app {
namespace fixed_pattern_tests {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int side = 256;

class Drawn final : public test::DrawnSource {
 public:
  explicit Drawn(piv::Sequence s) : DrawnSource(s.width, s.height, s.frames, 1), s_(std::move(s)) {}
  Image read(int index) override { return piv::draw(s_, index); }

 private:
  piv::Sequence s_;
};

// Material that moves by `step` px a frame behind dirt of so much of its own contrast.
piv::Sequence behind_dirt(double step, double dirt, int frames) {
  piv::Sequence s{.width = side, .height = side, .frames = frames, .seed = 41, .noise = .01};
  s.place = piv::sequence::uniform(step, 0.3 * step);
  std::vector<Vec2> blobs;
  for (std::uint64_t n = 0; n < 1500; ++n)
    blobs.push_back(Vec2(side * piv::sequence::random01(3, 77, 2 * n), side * piv::sequence::random01(3, 77, 2 * n + 1)));
  const auto grey = std::make_shared<std::vector<double>>(piv::sequence::grey_of(s.texture, blobs, side, side));
  if (dirt > 0)
    s.pattern = [=, background = s.texture.background](double x, double y) {
      return dirt * ((*grey)[std::size_t(y) * side + std::size_t(x)] - background);
    };
  return s;
}

Case scene() { return parse_case("name = \"glass\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 16\n", "test", "."); }

std::vector<VectorField> vectors(const piv::Sequence& s, const Setting& setting) {
  Drawn source(s);
  std::vector<VectorField> out;
  for (int k = 0; k + 1 < s.frames; ++k) out.push_back(measure_pair(scene(), setting, source, {k, k + 1}, 1));
  return out;
}

std::vector<std::string> remarks(const piv::Sequence& s, const Setting& setting) {
  Drawn source(s);
  const std::vector<VectorField> pairs = vectors(s, setting);
  return pattern_remarks(setting, source, [&](std::size_t k) { return pairs.at(k); });
}

// Of the sum of all pairs at the nodes.
double path_error(const piv::Sequence& s, const Setting& setting) {
  const std::vector<VectorField> pairs = vectors(s, setting);
  const Vec2 truth = s.place({0, 0}, s.frames - 1);
  double sum = 0, count = 0;
  for (std::size_t n = 0; n < pairs.front().status.size(); ++n) {
    Vec2 path(0, 0);
    for (const VectorField& pair : pairs) path += Vec2(double(pair.displacement[n][0]), -double(pair.displacement[n][1]));
    if (!path.allFinite()) continue;
    sum += (path - truth).squaredNorm(), ++count;
  }
  return std::sqrt(sum / (2 * count));
}

Setting filtered(const piv::Sequence& s, image::Background kind) {
  Setting setting = make_setting(scene(), side, side);
  image::FilterOptions options;
  options.background = kind;
  Drawn source(s);
  if (kind != image::Background::none) setting.filter = std::make_shared<const image::FrameFilter>(filter_of(options, source));
  return setting;
}

TEST(FixedPattern, DirtIsFoundAndTakenOut) {
  const piv::Sequence dirty = behind_dirt(1.4, 1, 10), clean = behind_dirt(1.4, 0, 10);
  const Setting plain = filtered(dirty, image::Background::none);
  const auto said = remarks(dirty, plain);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said.front(), HasSubstr("preprocess.background = \"pattern\""));
  EXPECT_THAT(remarks(clean, plain), IsEmpty());
  const double before = path_error(dirty, plain), after = path_error(dirty, filtered(dirty, image::Background::pattern));
  EXPECT_GT(before, 0.3);
  EXPECT_LT(after, before / 5);
  EXPECT_THAT(remarks(dirty, filtered(dirty, image::Background::pattern)), IsEmpty());
}

TEST(FixedPattern, MaterialAtRestIsNone) {
  const piv::Sequence still = behind_dirt(0, 0, 6);
  EXPECT_THAT(remarks(still, filtered(still, image::Background::none)), IsEmpty());
  Drawn source(still);
  const Image pattern = pattern_on_glass(source, 25);
  float most = 0;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) most = std::max(most, std::abs(pattern.view().row<float>(r)[c]));
  EXPECT_EQ(most, 0.0f);
}

// As a run of a case with these keys measures.
Setting run_with(const std::string& preprocess, const piv::Sequence& s) {
  Case c = scene();
  if (!preprocess.empty()) c = parse_case("name = \"glass\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 16\n" + preprocess, "test", ".");
  Setting setting = make_setting(c, side, side);
  Drawn source(s);
  SilentProgress none;
  EXPECT_THAT(set_filter(c, source, 1, none, setting), IsEmpty());
  return setting;
}
const std::string asked = "[preprocess]\nbackground = \"pattern\"\n";

TEST(FixedPattern, IsTakenOutWhereAskedFor) {
  for (const int frames : {6, 12}) {  // too few to tell where material moves, and enough
    const piv::Sequence dirty = behind_dirt(frames == 6 ? 2.5 : 1.4, 1, frames);
    const Setting own = run_with(asked, dirty);
    EXPECT_LT(path_error(dirty, own), path_error(dirty, filtered(dirty, image::Background::none)) / (frames == 6 ? 2 : 5));
    EXPECT_THAT(remarks(dirty, own), IsEmpty());
  }
}

TEST(FixedPattern, NothingIsTakenOutUnasked) {
  EXPECT_EQ(run_with("", behind_dirt(1.4, 1, 12)).filter, nullptr);
  EXPECT_EQ(run_with("", behind_dirt(1.4, 0, 12)).filter, nullptr);
}

// Opaque grains slide over a floor of the same grains at rest: the scene of every slide and collapse.
class Grains final : public test::DrawnSource {
 public:
  Grains(const grains::Scene& s, int frames) : DrawnSource(s.width, s.height, frames, 1) {
    for (int k = 0; k < frames; ++k) grey_.push_back(grains::draw(s, k));
  }
  Image read(int index) override {
    Image out(width(), height(), PixelDepth::u8, 255);
    std::copy(grey_.at(std::size_t(index)).begin(), grey_.at(std::size_t(index)).end(), out.row<std::uint8_t>(0));
    return out;
  }

 private:
  std::vector<std::vector<std::uint8_t>> grey_;
};

TEST(FixedPattern, AFloorAtRestIsNone) {
  constexpr int frames = 11;
  for (const grains::Soil& soil : grains::soils()) {
    grains::Scene s;
    s.soil = soil, s.seed = 71;
    s.place = [](grains::Place X, int k) { return grains::Place{X.x + (X.y < 128 ? 0.33 * k * k : 0.0), X.y}; };
    s.body = [](grains::Place X) { return X.y < 128 ? 0 : 1; };
    s.holds = [](double, double row, int body, int) { return (row < 128) == (body == 0); };
    Grains source(s, frames);
    const Setting setting = make_setting(scene(), side, side);
    std::vector<VectorField> pairs;
    for (int k = 0; k + 1 < frames; ++k) pairs.push_back(measure_pair(scene(), setting, source, {k, k + 1}, 1));
    EXPECT_THAT(pattern_remarks(setting, source, [&](std::size_t k) { return pairs.at(k); }), IsEmpty()) << soil.name;
  }
}

// Left of column 96 material is at rest, or creeps by half of its grains' size, and from 160 on it moves on: texture that stays must not be taken
// for the pattern before what moves.
TEST(FixedPattern, MaterialAtRestStaysBesideOne) {
  for (const double creep : {0.0, 0.2}) {  // px a frame
    const auto share = [](double x) { return std::clamp((x - 96) / 64, 0.0, 1.0); };
    piv::Sequence s = behind_dirt(0, 1.5, 16);
    s.place = [=](const Vec2& from, int k) { return Vec2(from.x(), from.y() + k * (creep + (1.6 - creep) * share(from.x()))); };
    const Setting own = run_with(asked, s);
    Drawn source(s);
    const Image as_is = source.read(0), freed = prepared(own, source.read(0));
    const auto changed = [&](int r, int c) { return double(freed.view().row<std::uint8_t>(r)[c]) - double(as_is.view().row<std::uint8_t>(r)[c]); };
    double level = 0;  // the filter keeps the mean of what it takes off
    for (int r = 40; r < 216; ++r) level += changed(r, 20) / 176;
    double still = 0, moving = 0;
    for (int r = 40; r < 216; ++r)
      for (int c = 20; c < 60; ++c) {
        still = std::max(still, std::abs(changed(r, c) - level));
        moving = std::max(moving, std::abs(changed(r, side - c) - level));
      }
    EXPECT_LE(still, 1.5) << creep;
    EXPECT_GT(moving, 10) << creep;
  }
}

}  // namespace fixed_pattern_tests
}  // namespace pivnp::app

// Speed against accuracy: the front, known pairs made of frames, settings on them, and a simulation's own refinement.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "apps/study/frontier/frontier.hpp"
#include "apps/study/frontier/mpm/mpm_frontier.hpp"
#include "apps/study/frontier/piv/piv_frontier.hpp"
#include "apps/study/frontier/tables.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {

FrontierPoint point(const std::string& name, double seconds, double error) {
  FrontierPoint p;
  p.name = name;
  p.keys = "key=" + name;
  p.seconds = seconds;
  p.error = error;
  return p;
}

TEST(Frontier, TheFrontIsWhatNothingBeats) {
  FrontierStage stage;
  stage.points = {point("slow", 4, 1), point("best", 2, 1), point("quick", 1, 3), point("worse", 1.5, 3), point("none", NAN, 1)};
  find_front(stage.points);
  std::vector<bool> on;
  for (const FrontierPoint& p : stage.points) on.push_back(p.on_front);
  EXPECT_EQ(on, (std::vector<bool>{false, true, true, false, false}));

  stage.points[0].own = true;  // 4 s, error 1
  const auto has = [](const std::vector<std::string>& words, const std::string& part) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& w) { return w.find(part) != std::string::npos; });
  };
  const std::vector<std::string> words = what_to_change(stage);
  EXPECT_TRUE(has(words, "key=best) takes 0.5 of the time, with 1 times the error"));
  ASSERT_EQ(words.size(), 3u);  // faster, more accurate (nothing), and that it is beaten
  stage.points[0].own = false;
  stage.points[2].standard = true;
  EXPECT_TRUE(has(what_to_change(stage), "key=best) takes 2 times the time, with 0.33 of the error"));
}

// Frames that a known motion carried: what is made of them has the displacement it is said to have, and their noise.
TEST(Frontier, PairsMadeOfFramesMoveAsTheySay) {
  class Frames final : public image::FrameSource {
   public:
    Frames() {
      image::TextureOptions texture;
      texture.noise = 0.03;  // 7.65 grey values
      pair_ = image::synthetic_pair(image::triangle_shear(0.04), 256, 256, texture);
      for (int k = 0; k < 2; ++k) frames_.push_back({.name = "", .time = double(k)});
    }
    const std::vector<Frame>& frames() const override { return frames_; }
    bool has_rate() const override { return true; }
    int width() const override { return 256; }
    int height() const override { return 256; }
    Image read(int index) override {
      const ImageView v = (index == 0 ? pair_.first : pair_.second).view();
      Image copy(v.width, v.height, v.depth, v.white);
      std::copy_n(v.data, v.stride * v.height, reinterpret_cast<std::byte*>(copy.row<std::uint8_t>(0)));
      return copy;
    }

   private:
    image::SyntheticPair pair_;
    std::vector<Frame> frames_;
  } frames;
  const Case c = parse_case("[frames]\npath = \"x.png\"\n[grid]\nspacing_px = 16\n", "a case", ".");
  const KnownPairs known = carried_pairs(c, make_setting(c, 256, 256), frames, 1, silent);
  ASSERT_GE(known.pairs.size(), 6u);
  const Vec2 far = known.pairs.front().truth({100, 100}, Anchor::central);
  EXPECT_EQ(known.pairs.front().truth({30, 200}, Anchor::forward), far);  // an even shift

  piv::PairCorrelator correlator(*c.piv, known.nodes, 256, 256, 1);
  const auto unlike = [&](const piv::PixelVectors& found) {  // mean of what does not correlate
    double sum = 0, n = 0;
    for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k)
      if (known.scored[k] && found.status[k] == VectorStatus::valid) sum += 1 - double(found.score[k]), ++n;
    return sum / n;
  };
  const Image first = frames.read(0), second = frames.read(1);
  const double of_frames = unlike(correlator.correlate(first.view(), second.view(), {}));
  for (const KnownPair& pair : known.pairs) {
    const piv::PixelVectors found = correlator.correlate(pair.first.view(), pair.second.view(), {});
    double square = 0, moved = 0, n = 0;
    for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k) {
      if (!known.scored[k] || found.status[k] != VectorStatus::valid) continue;
      const Vec2 truth = pair.truth({double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1])}, found.anchor);
      square += (Vec2(double(found.displacement[k][0]), double(found.displacement[k][1])) - truth).squaredNorm();
      moved += truth.squaredNorm();
      ++n;
    }
    EXPECT_GT(n, 100) << pair.name;
    EXPECT_LT(std::sqrt(square / n), 0.12 * std::sqrt(moved / n) + 0.02) << pair.name;
    if (pair.wavelength >= 128) {  // found as it is said to be: no share of it lags
      double cross = 0;
      for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k) {
        if (!known.scored[k] || found.status[k] != VectorStatus::valid) continue;
        cross += pair.truth({double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1])}, found.anchor).dot(Vec2(double(found.displacement[k][0]), double(found.displacement[k][1])));
      }
      EXPECT_NEAR(cross / moved, 1, 0.05) << pair.name;
    }
    EXPECT_NEAR(unlike(found), of_frames, 0.3 * of_frames) << pair.name;  // noise as in the frames
  }
}

TEST(Frontier, KnownPairsTellMethodsApart) {
  KnownPairs known = drawn_pairs(224, 5);
  const FrontierStage stage = piv_frontier(known, {}, true, 1, 1, silent);
  const auto at = [&](const std::string& name) {
    const auto p = std::find_if(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& q) { return q.name == name; });
    EXPECT_NE(p, stage.points.end()) << name;
    return *p;
  };
  const FrontierPoint standard = at("default, 32 px"), fast = at("fast, 32 px"), fft = at("fft, 32 px"), wide = at("default, 64 px, subsets");
  EXPECT_TRUE(standard.standard && standard.own);
  EXPECT_LT(standard.error, 0.5 * fast.error);
  EXPECT_LT(standard.error, 0.5 * fft.error);
  constexpr std::size_t valid = 1, wave = 4;
  EXPECT_LT(standard.columns[wave], fft.columns[wave]);  // resolves shorter waves
  EXPECT_LT(fft.columns[wave], wide.columns[wave]);
  for (const FrontierPoint& p : stage.points) {
    EXPECT_GT(p.seconds, 0) << p.name;
    EXPECT_GE(p.worst, p.error * (1 - 1e-9)) << p.name;
    EXPECT_LE(p.columns[valid], 1) << p.name;
  }
  const std::string text = csv(stage);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), std::ptrdiff_t(stage.points.size()) + 1);
}

TEST(Frontier, ASimulationIsJudgedByItsOwnRefinement) {
  const Case c = parse_case(R"([grid]
spacing_m = 0.05
area_m = [[0.0, 0.0], [1.2, 0.5]]
[region.sand]
polygon_m = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.4], [0.0, 0.4]]
[material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 1e6
poisson = 0.3
friction_deg = 30.0
[mpm]
end_s = 0.3
output_rate_hz = 10.0
initial_equilibrium = false
[boundary.base]
line_m = [[0.0, 0.0], [1.2, 0.0]]
type = "fixed"
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.5]]
type = "roller"
)", "column", ".");
  test::Scratch scratch;
  RunSettings settings;
  settings.out = scratch.path / "out";
  settings.threads = 1;
  const FrontierOutcome outcome = frontier(&c, {}, settings, silent);
  ASSERT_EQ(outcome.stages.size(), 1u);  // nothing to measure
  const FrontierStage& stage = outcome.stages.front();
  EXPECT_TRUE(stage.left_out.empty());
  double fine = 0, coarse = 0;
  for (const FrontierPoint& p : stage.points) {
    if (p.own) fine = p.error;
    if (p.name == "bspline, apic, cells 2 times") coarse = p.error;
    EXPECT_GT(p.columns.back(), 0.99) << p.name;  // partners
  }
  EXPECT_GT(fine, 0);
  EXPECT_LT(fine, 0.7 * coarse);
  for (const char* name : {"frontier.html", "frontier.pdf", "frontier.h5", "mpm.csv", "mpm.svg", "mpm.png"})
    EXPECT_GT(std::filesystem::file_size(settings.out / name), 1000u) << name;
}

TEST(Frontier, WantsSomethingToMeasure) {
  test::Scratch scratch;
  RunSettings settings;
  settings.out = scratch.path;
  const Case c = parse_case("name = \"nothing\"\n", "a case", ".");
  EXPECT_THROW(frontier(&c, {}, settings, silent), InputError);
}

}  // namespace
}  // namespace pivnp::app

// Direct correlation at given places: known affine motion, its error estimate, and when it says no.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "pivnp/core/error.hpp"
#include "pivnp/piv/window/subset.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

image::TextureOptions texture(double noise, double loss = 0) {
  image::TextureOptions t;
  t.noise = noise;
  t.loss = loss;
  t.seed = 7;
  return t;
}

struct Affine {
  Mat2 A;
  Vec2 centre, shift;
  Vec2 operator()(const Vec2& x) const { return centre + A * (x - centre) + shift; }
};

const Affine far_away = {(Mat2() << 1.05, 0.12, -0.06, 0.97).finished(), {100, 100}, {13.3, -8.6}};

Scene scene_of(const Affine& map, const image::TextureOptions& t) {
  return make_scene([map](const Vec2& x) { return Vec2(map(x) - x); }, 200, 200, t);
}

std::vector<AffinePrediction> predictions(const Affine& map, const Vec2& off, const Mat2& A) {
  std::vector<AffinePrediction> all;
  for (double y = 45.3; y < 160; y += 11.7)
    for (double x = 45.8; x < 160; x += 12.9) all.push_back({{x, y}, map({x, y}) + off, A});
  return all;
}

TEST(Subset, FindsAKnownAffineMotionAtAnyPlace) {
  const Scene scene = scene_of(far_away, texture(0));
  const SubsetImage first(scene.first.view(), {}, 1), second(scene.second.view(), {}, 1);
  const auto asked = predictions(far_away, {0.6, -0.5}, far_away.A + (Mat2() << 0.01, -0.01, 0.01, 0).finished());
  const auto found = match_subsets(first, second, asked, {}, 1);
  double sum = 0, sum_A = 0;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    ASSERT_TRUE(found[k].found) << k;
    EXPECT_GT(found[k].score, 0.99);
    sum += (found[k].to - far_away(asked[k].from)).squaredNorm() / 2 / double(asked.size());
    sum_A += (found[k].A - far_away.A).squaredNorm() / 4 / double(asked.size());
  }
  EXPECT_LT(std::sqrt(sum), 0.012);  // rounding to 8 bit, interpolation
  EXPECT_LT(std::sqrt(sum_A), 2e-3);
}

// u_x = c y^2 / 2: an affine subset ends up half the side's square over six times c off; one that bends likewise does not.
TEST(Subset, FollowsABendThatIsGiven) {
  constexpr double c = .012;
  const Scene scene = make_scene([](const Vec2& x) { return Vec2(c / 2 * (x.y() - 100) * (x.y() - 100), 0); }, 200, 200, texture(.01));
  const SubsetImage first(scene.first.view(), {}, 1), second(scene.second.view(), {}, 1);
  std::vector<AffinePrediction> asked;
  for (double y = 60.3; y < 140; y += 9)
    for (double x = 50.8; x < 120; x += 12) {
      AffinePrediction at;
      at.from = Vec2(x, y), at.to = at.from + Vec2(c / 2 * (y - 100) * (y - 100), 0);
      at.A(0, 1) = c * (y - 100);
      asked.push_back(at);
    }
  const auto off = [&] {
    const auto found = match_subsets(first, second, asked, {}, 1);
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < asked.size(); ++k)
      if (found[k].found) sum += std::pow(found[k].to.x() - asked[k].to.x(), 2), ++count;
    EXPECT_GT(count, .9 * double(asked.size()));
    return std::sqrt(sum / count);
  };
  EXPECT_GT(off(), .3);  // 15.5^2 / 6 c = .48
  for (AffinePrediction& at : asked) at.bend(0, 2) = c / 2;
  EXPECT_LT(off(), .02);
}

// Along its rows too, u_y = c x^2 / 2, and across both, u_x = c x y.
TEST(Subset, FollowsBendsAlongRowsAndAcross) {
  constexpr double c = .008;
  const auto along = [](const Vec2& x) { return Vec2(c * x.x() * x.y(), c / 2 * x.x() * x.x()); };
  const Vec2 middle(100, 100);
  const Scene scene = make_scene([&](const Vec2& x) { return along(x - middle); }, 200, 200, texture(.01));
  const SubsetImage first(scene.first.view(), {}, 1), second(scene.second.view(), {}, 1);
  double sum = 0, count = 0;
  for (double y = -20.3; y < 20; y += 9)
    for (double x = -20.2; x < 20; x += 9) {
      AffinePrediction at;
      at.from = middle + Vec2(x, y), at.to = at.from + along({x, y});
      at.A << 1 + c * y, c * x, c * x, 1;
      at.bend << 0, c, 0, c / 2, 0, 0;
      const SubsetMatch m = match_subsets(first, second, std::vector{at}, {}, 1)[0];
      if (m.found) sum += (m.to - at.to).squaredNorm() / 2, ++count;
    }
  EXPECT_GT(count, 22);
  EXPECT_LT(std::sqrt(sum / count), .03);
}

TEST(Subset, StatedErrorFitsNoiseAndLoss) {
  for (const auto& [noise, loss] : {std::pair{0.02, 0.0}, {0.05, 0.0}, {0.0, 0.2}}) {
    const Scene scene = scene_of(far_away, texture(noise, loss));
    const SubsetImage first(scene.first.view(), {}, 1), second(scene.second.view(), {}, 1);
    const auto asked = predictions(far_away, {0.2, 0.3}, far_away.A);
    const auto found = match_subsets(first, second, asked, {}, 1);
    double seen = 0, stated = 0, seen_A = 0, stated_A = 0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < asked.size(); ++k) {
      if (!found[k].found) continue;
      ++count;
      seen += (found[k].to - far_away(asked[k].from)).squaredNorm() / 2;
      stated += (found[k].cov[0] + found[k].cov[1]) / 2;
      seen_A += (found[k].A - far_away.A).squaredNorm() / 4;
      stated_A += found[k].var_A;
    }
    EXPECT_GT(count, asked.size() * 9 / 10);
    EXPECT_GT(std::sqrt(stated / seen), 0.6) << noise << " " << loss;
    EXPECT_LT(std::sqrt(stated / seen), 1.8) << noise << " " << loss;
    EXPECT_GT(std::sqrt(stated_A / seen_A), 0.6) << noise << " " << loss;
    EXPECT_LT(std::sqrt(stated_A / seen_A), 1.8) << noise << " " << loss;
  }
}

TEST(Subset, SaysNoWhereThereIsNothingToFind) {
  const Scene scene = scene_of(far_away, texture(0));
  image::TextureOptions other = texture(0);
  other.seed = 99;
  const Scene stranger = scene_of(far_away, other);
  const SubsetImage first(scene.first.view(), {}, 1), second(stranger.second.view(), {}, 1);
  const auto asked = predictions(far_away, {0, 0}, far_away.A);
  for (const SubsetMatch& m : match_subsets(first, second, asked, {}, 1))
    if (m.found) {
      EXPECT_LT(m.score, 0.6);
    }

  // Outside, masked, flat, not finite.
  const SubsetImage right(scene.second.view(), {}, 1);
  std::vector<std::uint8_t> mask(200 * 200, 0);
  const SubsetImage masked(scene.first.view(), MaskView{mask.data(), 200, 200, 200}, 1);
  Image grey(200, 200, PixelDepth::u8, 255);
  for (int r = 0; r < 200; ++r) std::fill(grey.row<std::uint8_t>(r), grey.row<std::uint8_t>(r) + 200, std::uint8_t{90});
  const SubsetImage flat(grey.view(), {}, 1);
  const AffinePrediction middle{{100, 100}, far_away({100, 100}), far_away.A};
  EXPECT_TRUE(match_subsets(first, right, std::vector{middle}, {}, 1)[0].found);
  EXPECT_FALSE(match_subsets(masked, right, std::vector{middle}, {}, 1)[0].found);
  EXPECT_FALSE(match_subsets(flat, right, std::vector{middle}, {}, 1)[0].found);
  EXPECT_FALSE(match_subsets(first, flat, std::vector{middle}, {}, 1)[0].found);
  AffinePrediction outside = middle, unknown = middle;
  outside.from = {3, 3};
  unknown.to.x() = std::nan("");
  EXPECT_FALSE(match_subsets(first, right, std::vector{outside}, {}, 1)[0].found);
  EXPECT_FALSE(match_subsets(first, right, std::vector{unknown}, {}, 1)[0].found);
}

TEST(Subset, SameBitsForAnyNumberOfThreadsAndRefusals) {
  const Scene scene = scene_of(far_away, texture(0.02));
  const SubsetImage first(scene.first.view(), {}, 1), second(scene.second.view(), {}, 2);
  const auto asked = predictions(far_away, {0.2, 0.3}, far_away.A);
  const auto one = match_subsets(first, second, asked, {}, 1), three = match_subsets(first, second, asked, {}, 3);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    EXPECT_EQ(one[k].to, three[k].to);
    EXPECT_EQ(one[k].cov, three[k].cov);
  }
  SubsetOptions even;
  even.side_px = 20;
  EXPECT_THROW(match_subsets(first, second, asked, even, 1), InputError);
  Image small(100, 100, PixelDepth::u8, 255);
  for (int r = 0; r < 100; ++r) std::fill(small.row<std::uint8_t>(r), small.row<std::uint8_t>(r) + 100, std::uint8_t(r));
  EXPECT_THROW(match_subsets(first, SubsetImage(small.view(), {}, 1), asked, {}, 1), InputError);
}

}  // namespace
}  // namespace pivnp::piv

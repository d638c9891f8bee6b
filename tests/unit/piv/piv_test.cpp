// Displacements measured on synthetic pairs against their truth, and what becomes of windows that show nothing.
// Limits are those asked of 32 px windows (peers on such images: uniform bias .003-.010, rotation 3 deg .002-.04,
// shear 10 % .002-.12, noise 5 % .019-.038 px).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pivnp/core/error.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

constexpr int side = 256;
const double middle = 0.5 * (side - 1);

Errors errors_of(Motion motion, const image::TextureOptions& texture = {}, const PivOptions& options = {},
                 double margin = 32) {
  const Scene scene = make_scene(std::move(motion), side, side, texture);
  const NodeLattice nodes = even_nodes(side, side, 16, margin, 0.25);
  return errors(scene, nodes, measure(scene, nodes, options));
}

TEST(Piv, UniformShifts) {
  for (const double u : {0.0, 0.25, 0.5, 0.9}) {
    SCOPED_TRACE(u);
    const Errors e = errors_of(uniform(u, -0.4 * u));
    EXPECT_LE(e.rms, 0.01);
    EXPECT_LE(e.bias, 0.004);
    EXPECT_EQ(e.valid, 1.0);
  }
}

TEST(Piv, Rotations) {
  for (const Anchor anchor : {Anchor::central, Anchor::forward}) {
    PivOptions options;
    options.anchor = anchor;
    for (const double degrees : {1.0, 3.0}) {
      SCOPED_TRACE(std::string(name_of(anchor)) + " " + std::to_string(degrees));
      const Errors e = errors_of(rotation(degrees, middle, middle), {}, options);
      EXPECT_LE(e.rms, 0.01);
      EXPECT_EQ(e.valid, 1.0);
    }
  }
}

TEST(Piv, PlainShears) {
  for (const Anchor anchor : {Anchor::central, Anchor::forward}) {
    PivOptions options;
    options.anchor = anchor;
    for (const double slope : {0.1, 0.2}) {
      SCOPED_TRACE(std::string(name_of(anchor)) + " " + std::to_string(slope));
      const Errors e = errors_of(plain_shear(slope, middle), {}, options);
      EXPECT_LE(e.rms, slope == 0.1 ? 0.01 : 0.02);
      EXPECT_GE(e.valid, 0.99);
    }
  }
}

TEST(Piv, ReversingShearKeepsItsVectors) {
  const Scene scene = make_scene(triangle_shear(0.2), side, side, {});
  const NodeLattice nodes = even_nodes(side, side, 8, 32);
  const auto strips = [](const Vec2& p) { return std::abs(p.y() - 64 - 128 * std::round((p.y() - 64) / 128)) < 24; };
  const Errors e = errors(scene, nodes, measure(scene, nodes), strips);
  EXPECT_LE(e.rms, 0.03);
  EXPECT_GE(e.valid, 0.97);
}

// By their own definitions the two anchors differ by half the displacement times its gradient: 20 % shear of 20 px
// moves the place by 10 px and the displacement by 2 px where the motion has a component across. Each is held to its
// truth above; here, that the difference is the predicted one.
TEST(Piv, AnchorsDifferAsDefined) {
  const Motion spin = rotation(4, middle, middle);
  const Scene scene = make_scene(spin, side, side, {});
  const NodeLattice nodes = even_nodes(side, side, 32, 48);
  PivOptions forward;
  forward.anchor = Anchor::forward;
  const PixelVectors f = measure(scene, nodes, forward), c = measure(scene, nodes);
  EXPECT_EQ(f.anchor, Anchor::forward);
  EXPECT_EQ(c.anchor, Anchor::central);
  double largest = 0;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    const Vec2 place(nodes.pixel[k][0], nodes.pixel[k][1]);
    const Vec2 expected = scene.truth(place, true) - scene.truth(place, false);
    const Vec2 found(c.displacement[k][0] - f.displacement[k][0], c.displacement[k][1] - f.displacement[k][1]);
    EXPECT_LE((found - expected).norm(), 0.03);
    largest = std::max(largest, expected.norm());
  }
  EXPECT_GT(largest, 0.15);  // far above the tolerance
}

TEST(Piv, LargeShiftsAreFound) {
  EXPECT_LE(errors_of(uniform(20.3, -5.7), {}, {}, 48).rms, 0.01);
  const Errors far = errors_of(uniform(-27.4, 24.6), {}, {}, 56);
  EXPECT_LE(far.rms, 0.01);
  EXPECT_EQ(far.valid, 1.0);
  PivOptions options;
  options.first_window_px = 256;
  const Scene scene = make_scene(uniform(61.3, -20.2), 512, 384, {});
  const NodeLattice nodes = even_nodes(512, 384, 32, 96);
  const Errors e = errors(scene, nodes, measure(scene, nodes, options, 2));
  EXPECT_LE(e.rms, 0.01);
  EXPECT_EQ(e.valid, 1.0);
}

TEST(Piv, StatedErrorFollowsTheNoise) {
  const Errors five = errors_of(uniform(2.3, -1.4), {.noise = 0.05}),
               ten = errors_of(uniform(2.3, -1.4), {.noise = 0.10});
  EXPECT_LE(five.rms, 0.03);
  EXPECT_GE(five.valid, 0.99);
  EXPECT_LE(ten.rms, 0.06);
  EXPECT_NEAR(ten.sigma / five.sigma, 2.0, 0.25);
  // Errors of neighbours are alike over most of so small a frame: the shares are means over sixteen frames.
  for (const double noise : {0.05, 0.10}) {
    double one = 0, two = 0;
    constexpr int frames = 16;
    for (int seed = 1; seed <= frames; ++seed) {
      const Errors e = errors_of(uniform(2.3, -1.4), {.noise = noise, .seed = seed});
      one += e.within_one / frames, two += e.within_two / frames;
    }
    EXPECT_GE(one, 0.55) << noise;
    EXPECT_LE(one, 0.85) << noise;
    EXPECT_GE(two, 0.88) << noise;
  }
}

TEST(Piv, LostParticlesRaiseTheStatedError) {
  const Errors e = errors_of(uniform(2.3, -1.4), {.loss = 0.2});
  EXPECT_LE(e.rms, 0.1);
  EXPECT_GE(e.valid, 0.97);
  EXPECT_GE(e.within_two, 0.75);
}

TEST(Piv, UnevenAndChangingIlluminationDoesNotMatter) {
  const Errors e = errors_of(uniform(1.4, 0.7), {.light_slope = 0.4, .light_change = 0.1});
  EXPECT_LE(e.rms, 0.01);
  EXPECT_EQ(e.valid, 1.0);
}

TEST(Piv, DepthDoesNotMatter) {
  for (const int bits : {12, 16}) EXPECT_LE(errors_of(uniform(1.4, 0.7), {.bits = bits}).rms, 0.01);
  const Scene scene = make_scene(uniform(1.4, 0.7), side, side, {.bits = 16});
  Scene floating{scene.motion, side, side, Image(side, side, PixelDepth::f32, 1.0f),
                 Image(side, side, PixelDepth::f32, 1.0f)};
  for (const auto& [from, to] : {std::pair{&scene.first, &floating.first}, {&scene.second, &floating.second}})
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) to->row<float>(r)[c] = from->view().row<std::uint16_t>(r)[c] / 65535.0f;
  const NodeLattice nodes = even_nodes(side, side, 32, 48);
  const Errors e = errors(floating, nodes, measure(floating, nodes));
  EXPECT_LE(e.rms, 0.01);
  EXPECT_EQ(e.valid, 1.0);
}

TEST(Piv, SameBitsForAnyNumberOfThreadsAndOnReuse) {
  const Scene scene = make_scene(rotation(2, middle, middle), side, side, {.noise = 0.03, .loss = 0.1});
  const NodeLattice nodes = even_nodes(side, side, 12, 20);
  PairCorrelator one({}, nodes, side, side, 1), three({}, nodes, side, side, 3);
  three.correlate(scene.second.view(), scene.first.view(), {});  // another pair before
  const PixelVectors a = one.correlate(scene.first.view(), scene.second.view(), {});
  const PixelVectors b = three.correlate(scene.first.view(), scene.second.view(), {});
  EXPECT_EQ(
      std::memcmp(a.displacement.data(), b.displacement.data(), a.displacement.size() * sizeof(a.displacement[0])), 0);
  EXPECT_EQ(std::memcmp(a.cov.data(), b.cov.data(), a.cov.size() * sizeof(a.cov[0])), 0);
  EXPECT_EQ(std::memcmp(a.score.data(), b.score.data(), a.score.size() * sizeof(a.score[0])), 0);
  EXPECT_EQ(a.status, b.status);
}

TEST(Piv, MaskedPixelsHaveNoSay) {
  // a disc with a texture of its own that stands still, in a flow
  Scene scene = make_scene(uniform(3.2, 1.1), side, side, {.seed = 1});
  const Scene still = make_scene(uniform(0, 0), side, side, {.seed = 2});
  std::vector<std::uint8_t> use(side * side, 1);
  const double radius = 45;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      if (std::hypot(c - middle, r - middle) > radius) continue;
      use[std::size_t(r * side + c)] = 0;
      scene.first.row<std::uint8_t>(r)[c] = still.first.view().row<std::uint8_t>(r)[c];
      scene.second.row<std::uint8_t>(r)[c] = still.second.view().row<std::uint8_t>(r)[c];
    }
  const NodeLattice nodes = even_nodes(side, side, 8, 24);
  const PixelVectors found = measure(scene, nodes, {}, 1, {use.data(), side, side, side});
  int masked = 0, beside = 0;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    const double distance = std::hypot(nodes.pixel[k][0] - middle, nodes.pixel[k][1] - middle);
    if (distance < radius - 15) {
      EXPECT_EQ(found.status[k], VectorStatus::masked);
      EXPECT_TRUE(std::isnan(found.displacement[k][0]));
      ++masked;
    } else if (distance > radius + 2) {
      EXPECT_EQ(found.status[k], VectorStatus::valid);
      EXPECT_NEAR(found.displacement[k][0], 3.2, 0.05);
      EXPECT_NEAR(found.displacement[k][1], 1.1, 0.05);
      beside += distance < radius + 15;
    }
  }
  EXPECT_GT(masked, 30);
  EXPECT_GT(beside, 30);
}

// Frames are cut to what the mask leaves; another mask is another cut.
TEST(Piv, HalfTheSceneMaskedAndThenNot) {
  Scene scene = make_scene(uniform(3.2, 1.1), side, side, {.seed = 1});
  const NodeLattice nodes = even_nodes(side, side, 8, 24);
  PairCorrelator correlator({}, nodes, side, side, 1);
  const auto measured = [&](const MaskView& mask) {
    return correlator.correlate(scene.first.view(), scene.second.view(), mask);
  };
  const PixelVectors before = measured({});
  std::vector<std::uint8_t> use(side * side, 0);
  for (int r = 150; r < side; ++r) std::fill_n(use.begin() + r * side, side, std::uint8_t{1});
  const PixelVectors half = measured({use.data(), side, side, side});
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (nodes.pixel[k][1] < 130) {
      EXPECT_EQ(half.status[k], VectorStatus::masked);
      EXPECT_TRUE(std::isnan(half.displacement[k][0]));
    } else if (nodes.pixel[k][1] > 156) {
      EXPECT_EQ(half.status[k], VectorStatus::valid);
      EXPECT_NEAR(half.displacement[k][0], 3.2, 0.02);
      EXPECT_NEAR(half.displacement[k][1], 1.1, 0.02);
    }
  }
  EXPECT_EQ(measured({}).displacement, before.displacement);
  std::fill(use.begin(), use.end(), 0);
  for (const VectorStatus s : measured({use.data(), side, side, side}).status) EXPECT_EQ(s, VectorStatus::masked);
}

TEST(Piv, NodesThatAreOffAreMaskedAndTheOthersUnchanged) {
  const Scene scene = make_scene(uniform(1.3, 0.2), side, side, {});
  NodeLattice nodes = even_nodes(side, side, 16, 32);
  nodes.on.assign(nodes.pixel.size(), 1);
  for (std::size_t k = 0; k < nodes.on.size() / 2; ++k) nodes.on[k] = 0;
  const PixelVectors found = measure(scene, nodes);
  for (std::size_t k = 0; k < nodes.on.size(); ++k)
    EXPECT_EQ(found.status[k], nodes.on[k] ? VectorStatus::valid : VectorStatus::masked);
  EXPECT_LE(errors(scene, nodes, found).rms, 0.01);
}

TEST(Piv, NothingIsClaimedWithoutTextureOrOutside) {
  Scene scene = make_scene(uniform(1.3, 0.2), side, side, {});
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < 100; ++c) scene.first.row<std::uint8_t>(r)[c] = scene.second.row<std::uint8_t>(r)[c] = 40;
  NodeLattice nodes{4, 1, {{60, 128}, {160, 128}, {-5, 128}, {128, 300}}, {}};
  const PixelVectors found = measure(scene, nodes);
  for (const std::size_t k : {0u, 2u, 3u}) {
    EXPECT_EQ(found.status[k], VectorStatus::failed) << k;
    EXPECT_TRUE(std::isnan(found.displacement[k][0]));
    EXPECT_TRUE(std::isnan(found.score[k]));
  }
  EXPECT_EQ(found.status[1], VectorStatus::valid);
  EXPECT_NEAR(found.displacement[1][0], 1.3, 0.03);
}

TEST(Piv, AnEvenImageFailsEverywhere) {
  Scene scene{uniform(0, 0), 128, 128, Image(128, 128, PixelDepth::u8, 255), Image(128, 128, PixelDepth::u8, 255)};
  for (Image* image : {&scene.first, &scene.second})
    for (int r = 0; r < 128; ++r) std::memset(image->row<std::uint8_t>(r), 77, 128);
  const NodeLattice nodes = even_nodes(128, 128, 16, 24);
  const PixelVectors found = measure(scene, nodes);
  for (const VectorStatus s : found.status) EXPECT_EQ(s, VectorStatus::failed);
}

TEST(Piv, UnrelatedImagesAreNotCalledValid) {
  Scene scene = make_scene(uniform(0, 0), side, side, {.seed = 1});
  scene.second = make_scene(uniform(0, 0), side, side, {.seed = 2}).second;
  const NodeLattice nodes = even_nodes(side, side, 16, 32);
  const PixelVectors found = measure(scene, nodes);
  const auto valid = std::count(found.status.begin(), found.status.end(), VectorStatus::valid);
  EXPECT_LE(static_cast<double>(valid), 0.10 * static_cast<double>(found.status.size()));
}

TEST(Piv, ADecorrelatedPatchIsRejectedOrReplaced) {
  Scene scene = make_scene(uniform(2.1, 0.4), side, side, {.seed = 1});
  const Scene other = make_scene(uniform(0, 0), side, side, {.seed = 9});
  for (int r = 100; r < 148; ++r)
    std::memcpy(scene.second.row<std::uint8_t>(r) + 100, other.second.view().row<std::uint8_t>(r) + 100, 48);
  const NodeLattice nodes = even_nodes(side, side, 8, 32);
  PivOptions keep;
  keep.replace = false;
  const PixelVectors with = measure(scene, nodes), without = measure(scene, nodes, keep);
  int rejected = 0, replaced = 0, wrong = 0;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    rejected += without.status[k] == VectorStatus::rejected;
    replaced += with.status[k] == VectorStatus::replaced;
    wrong += with.status[k] == VectorStatus::valid &&
             std::hypot(with.displacement[k][0] - 2.1, with.displacement[k][1] - 0.4) > 0.5;
  }
  EXPECT_GE(rejected, 4);
  EXPECT_GE(replaced, 4);
  EXPECT_LE(wrong, 3);
}

TEST(Piv, SparseAndSingleNodesAreMeasured) {
  const Scene scene = make_scene(rotation(1, middle, middle), side, side, {});
  const NodeLattice one{1, 1, {{100.4f, 90.7f}}, {}};
  const PixelVectors found = measure(scene, one);
  ASSERT_EQ(found.status[0], VectorStatus::valid);
  const Vec2 truth = scene.truth({100.4, 90.7}, true);
  EXPECT_NEAR(found.displacement[0][0], truth.x(), 0.03);
  EXPECT_NEAR(found.displacement[0][1], truth.y(), 0.03);
  const NodeLattice row = {5, 1, {{40, 100}, {80, 101}, {121, 102}, {163, 103}, {206, 104}}, {}};
  EXPECT_LE(errors(scene, row, measure(scene, row)).rms, 0.02);
}

TEST(Piv, EveryNumberOfPassesAndWindowWorks) {
  for (const int passes : {1, 2, 3, 6}) {
    PivOptions options;
    options.passes = passes;
    EXPECT_LE(errors_of(uniform(2.6, -1.3), {}, options).rms, 0.02) << passes;
  }
  for (const int window : {16, 24, 33, 48, 96}) {
    PivOptions options;
    options.window_px = window;
    const Errors e = errors_of(uniform(2.6, -1.3), {}, options, 60);
    EXPECT_LE(e.rms, 0.02) << window;
    EXPECT_GE(e.valid, 0.98) << window;
  }
}

TEST(Piv, BadOptionsAndSizesAreRefusedInOneLine) {
  const NodeLattice nodes = even_nodes(128, 128, 16, 24);
  const auto refused = [&](const PivOptions& options, const char* word) {
    try {
      PairCorrelator(options, nodes, 128, 128, 1);
      ADD_FAILURE() << word << ": not refused";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  };
  PivOptions options;
  options.method = "magic", refused(options, "method");
  options = {}, options.window_px = 200, refused(options, "window_px");
  options = {}, options.first_window_px = 16, refused(options, "first_window_px");
  const Scene scene = make_scene(uniform(0, 0), 100, 128, {});
  PairCorrelator correlator({}, nodes, 128, 128, 1);
  EXPECT_THROW(correlator.correlate(scene.first.view(), scene.second.view(), {}), InputError);
  NodeLattice broken = nodes;
  broken.pixel.pop_back();
  EXPECT_THROW(PairCorrelator({}, broken, 128, 128, 1), InputError);
}

}  // namespace
}  // namespace pivnp::piv

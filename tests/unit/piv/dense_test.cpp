// Parts of the dense Gauss-Newton method, and every method on plain motions.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pivnp/piv/dense/corrections.hpp"
#include "pivnp/piv/dense/normal_sums.hpp"
#include "pivnp/piv/dense/quality.hpp"
#include "pivnp/piv/dense/shrink.hpp"
#include "pivnp/piv/dense/spline_field.hpp"
#include "pivnp/piv/sampling/presmoothing.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

TEST(SplineField, RepeatsItsValuesAndGoesOnLinearly) {
  const CellLattice lattice{9, 7, -4, 3, 8};
  std::vector<float> u(lattice.size()), v(lattice.size()), wild(lattice.size());
  std::mt19937 random(5);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const float x = static_cast<float>(lattice.x0 + 8 * i), y = static_cast<float>(lattice.y0 + 8 * j);
      u[lattice.index(i, j)] = 0.3f + 0.02f * x - 0.01f * y;
      v[lattice.index(i, j)] = -1.0f + 0.05f * y;
      wild[lattice.index(i, j)] = std::uniform_real_distribution<float>(-2, 2)(random);
    }
  SplineField field;
  field.interpolate(lattice, u, v, 1);
  for (const auto& [x, y] : {std::pair{0.0f, 5.0f}, {31.7f, 20.2f}, {-20.0f, 70.0f}, {90.0f, -12.0f}}) {
    EXPECT_NEAR(field.at(x, y)[0], 0.3f + 0.02f * x - 0.01f * y, 2e-5f);
    EXPECT_NEAR(field.at(x, y)[1], -1.0f + 0.05f * y, 2e-5f);
  }
  field.interpolate(lattice, wild, v, 2);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i)
      EXPECT_NEAR(field.at(static_cast<float>(lattice.x0 + 8 * i), static_cast<float>(lattice.y0 + 8 * j))[0],
                  wild[lattice.index(i, j)], 1e-5f);
}

// Noise as hat-weighted cells show it: white pixels averaged by (1, 4, 1)/6 along both axes.
std::vector<float> noise(const CellLattice& lattice, float sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, 1);
  const int nx = lattice.nx + 2, ny = lattice.ny + 2;
  std::vector<float> white(std::size_t(nx * ny)), out(lattice.size());
  for (float& w : white) w = normal(random);
  const float weight[3] = {1.0f / 6, 4.0f / 6, 1.0f / 6};
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      float sum = 0;
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) sum += weight[a] * weight[b] * white[std::size_t((j + b) * nx + i + a)];
      out[lattice.index(i, j)] = 2 * sigma * sum;  // the kernel's norm is one half
    }
  return out;
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += double(a[k] - b[k]) * double(a[k] - b[k]);
  return std::sqrt(sum / double(a.size()));
}

TEST(Shrinker, AveragesNoiseOverPlanesAndKeepsWhatStandsClear) {
  const CellLattice lattice{70, 50, 0, 0, 8};
  const Shrinker shrinker(lattice);
  std::vector<float> plane(lattice.size()), wave(lattice.size()), noisy(lattice.size());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      plane[lattice.index(i, j)] = 3 + 0.2f * static_cast<float>(i) - 0.1f * static_cast<float>(j);
      wave[lattice.index(i, j)] = std::sin(2 * float(M_PI) * static_cast<float>(j) / 8);
    }
  SmoothedField out, again;
  shrinker.run(plane, {}, 1, out);
  EXPECT_LE(rms(out.value, plane), 1e-4);
  const auto n = noise(lattice, 0.05f, 11);
  for (std::size_t k = 0; k < n.size(); ++k) noisy[k] = plane[k] + n[k];
  shrinker.run(noisy, {}, 1, out);
  shrinker.run(noisy, {}, 3, again);
  EXPECT_EQ(out.value, again.value);
  const double left = rms(out.value, plane);
  EXPECT_LE(left, 0.3 * rms(noisy, plane));
  double stated = 0;
  for (const float v : out.variance) stated += double(v) / double(out.variance.size());
  EXPECT_NEAR(std::sqrt(stated) / left, 1.0, 0.5);
  for (std::size_t k = 0; k < n.size(); ++k) noisy[k] = wave[k] + n[k];
  shrinker.run(noisy, {}, 1, out);
  EXPECT_LE(rms(out.value, wave), 0.7 * rms(noisy, wave));
  double gain = 0, square = 0;
  for (std::size_t k = 0; k < n.size(); ++k)
    gain += double(out.value[k] * wave[k]), square += double(wave[k] * wave[k]);
  EXPECT_GE(gain / square, 0.97);
  // Points that nobody wants keep their values.
  shrinker.run(noisy, std::vector<std::uint8_t>(lattice.size(), 0), 1, out);
  EXPECT_EQ(out.value, noisy);
}

struct Sums {
  explicit Sums(const Scene& scene, const std::vector<std::uint8_t>* active = nullptr, int threads = 1) {
    first.assign(scene.first.view(), {}, 1, 1);
    second.assign(scene.second.view(), {}, 1, 1);
    const CellLattice lattice{30, 28, -6, 5, 8};
    field.interpolate(lattice, std::vector<float>(lattice.size(), 0.4f), std::vector<float>(lattice.size(), -0.3f), 1);
    SumsInput input;
    input.first = &first, input.second = &second, input.field = &field;
    input.active = active;
    input.scores = true;
    accumulate_sums(input, threads, sums);
  }
  SplineImage first, second;
  SplineField field;
  CellSums sums;
};

TEST(NormalSums, AreTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = make_scene(uniform(0.9, -0.7), 240, 240, {.seed = 4});
  const Sums one(scene), five(scene, nullptr, 5);
  for (int p = 0; p < CellSums::planes; ++p) EXPECT_EQ(one.sums.plane[p], five.sums.plane[p]) << p;
}

TEST(NormalSums, SolvedGiveWhatTheFieldLacks) {
  const Scene scene = make_scene(uniform(0.5, -0.4), 240, 240, {.seed = 4});
  const Sums s(scene);
  double xx = 0, xy = 0, yy = 0, xe = 0, ye = 0;
  for (std::size_t k = 0; k < s.sums.lattice.size(); ++k) {
    xx += double(s.sums[CellSums::gxx][k]), xy += double(s.sums[CellSums::gxy][k]),
        yy += double(s.sums[CellSums::gyy][k]);
    xe += double(s.sums[CellSums::gxe][k]), ye += double(s.sums[CellSums::gye][k]);
  }
  const double det = xx * yy - xy * xy;
  EXPECT_NEAR((yy * xe - xy * ye) / det, 0.1, 0.01);
  EXPECT_NEAR((xx * ye - xy * xe) / det, -0.1, 0.01);
}

TEST(NormalSums, CellsFarFromActiveOnesAreLeftOut) {
  const Scene scene = make_scene(uniform(0.9, -0.7), 240, 240, {.seed = 4});
  std::vector<std::uint8_t> active(30 * 28, 0);
  for (int j = 0; j < 28; ++j)
    for (int i = 0; i < 6; ++i) active[std::size_t(j * 30 + i)] = 1;
  const Sums all(scene), some(scene, &active);
  EXPECT_EQ(some.sums[CellSums::gxx][10 * 30 + 4], all.sums[CellSums::gxx][10 * 30 + 4]);
  EXPECT_EQ(some.sums[CellSums::gxx][10 * 30 + 20], 0.0f);
}

TEST(NormalSums, InstructionSetsAgree) {
  const Scene scene = make_scene(sine(1, 64), 256, 256, {.noise = 0.02});
  const NodeLattice nodes = even_nodes(256, 256, 16, 40);
  PivOptions fft;
  fft.method = "fft";
  for (const PivOptions& options : {PivOptions(), fft}) {
    const PixelVectors best = measure(scene, nodes, options);
    const std::string best_set = simd_target();
    for (const std::int64_t disabled :
         {std::int64_t(HWY_AVX3 | HWY_AVX3_DL | HWY_AVX2), ~std::int64_t(HWY_STATIC_TARGET)}) {
      hwy::DisableTargets(disabled);
      SCOPED_TRACE(options.method + ": " + best_set + " and " + simd_target());
      const PixelVectors plain = measure(scene, nodes, options);
      hwy::DisableTargets(0);
      for (std::size_t k = 0; k < nodes.pixel.size(); ++k)
        for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(best.displacement[k][c], plain.displacement[k][c], 1e-5f);
    }
  }
}

TEST(Presmoothing, FinerTextureIsSmoothedMore) {
  float before = 1;
  for (const double diameter : {1.5, 3.0, 5.0}) {
    const Scene scene = make_scene(uniform(0, 0), 200, 200, {.blob_diameter_px = diameter});
    const float a = presmoothing(scene.first.view(), scene.second.view(), 1);
    EXPECT_GE(a, 0.0f);
    EXPECT_LE(a, 0.25f);
    EXPECT_LT(a, before) << diameter;
    before = a;
  }
}

TEST(DenseMethods, IlluminationThatChangesIsCorrected) {
  const NodeLattice nodes = even_nodes(256, 256, 16, 40);
  const Errors e = errors(make_scene(sine(1, 64), 256, 256, {.light_slope = 0.4, .light_change = 0.1}), nodes,
                          measure(make_scene(sine(1, 64), 256, 256, {.light_slope = 0.4, .light_change = 0.1}), nodes));
  EXPECT_LE(e.rms, 0.01);
  EXPECT_GE(e.valid, 0.97);
}

TEST(DenseMethods, LostGrainsCountLittle) {
  const NodeLattice nodes = even_nodes(256, 256, 16, 40);
  const Scene scene = make_scene(uniform(2.3, -1.4), 256, 256, {.loss = 0.3});
  PivOptions fft;
  fft.method = "fft";
  const double windows = errors(scene, nodes, measure(scene, nodes, fft)).rms,
               robust = errors(scene, nodes, measure(scene, nodes)).rms;
  EXPECT_LE(robust, 0.04);
  EXPECT_LE(robust, 0.4 * windows);
}

// Half of the image moves far, half hardly: what the first guess blurs is searched again.
TEST(DenseMethods, SlidingBodiesAreBothFollowed) {
  const Motion slide = [](const Vec2& p) { return p.y() < 200 ? Vec2(19.3, 0.4) : Vec2(-0.6, 0.2); };
  const Scene scene = make_scene(slide, 400, 400, {});
  const NodeLattice nodes = even_nodes(400, 400, 16, 48);
  const auto away = [](const Vec2& p) { return std::abs(p.y() - 200) > 40; };
  const Errors e = errors(scene, nodes, measure(scene, nodes), away);
  EXPECT_GE(e.valid, 0.99);
  EXPECT_LE(e.rms, 0.01);
}

// A body about as large as the first search window moves against its surroundings: its first match is the
// surroundings'.
TEST(DenseMethods, WrongMatchesAreSearchedAgain) {
  const Motion inclusion = [](const Vec2& p) {
    return std::abs(p.x() - 200) < 70 && std::abs(p.y() - 200) < 70 ? Vec2(9.2, -5.6) : Vec2(0.4, 0.2);
  };
  const Scene scene = make_scene(inclusion, 400, 400, {});
  const NodeLattice nodes = even_nodes(400, 400, 8, 48);
  PivOptions forward;
  forward.anchor = Anchor::forward;
  const PixelVectors found = measure(scene, nodes, forward);
  int inside = 0, followed = 0;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (std::abs(nodes.pixel[k][0] - 200) > 20 || std::abs(nodes.pixel[k][1] - 200) > 20) continue;
    ++inside;
    followed += std::hypot(found.displacement[k][0] - 9.2f, found.displacement[k][1] + 5.6f) < 0.1f;
  }
  EXPECT_GE(inside, 20);
  EXPECT_GE(followed, 0.9 * inside);
}

// Where the field changes fast, texture may be misplaced by a tenth of the change over a cell without counting as lost.
TEST(ResidualScale, ToleranceGrowsWithTheChangeOverACell) {
  CellSums sums;
  sums.lattice = {20, 20, 0, 0, 8};
  for (auto& plane : sums.plane) plane.assign(sums.lattice.size(), 1.0f);
  std::vector<float> u(sums.lattice.size()), v(u.size(), 0.3f), noise, tolerance;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) u[sums.lattice.index(i, j)] = 1.6f * static_cast<float>(j);  // 20 % shear
  residual_scale(sums, u, v, 0.08f, noise, tolerance);
  EXPECT_NEAR(tolerance[sums.lattice.index(9, 9)], std::pow(0.1 + 0.16, 2), 1e-4);
  EXPECT_NEAR(noise[sums.lattice.index(9, 9)], 9 / 0.733 + 0.08, 1e-2);
}

TEST(Truncation, IsNothingForWavesOfTenPointsAndMuchForJumps) {
  const CellLattice lattice{40, 40, 0, 0, 8};
  const auto largest = [&](auto value) {
    std::vector<float> u(lattice.size()), variance;
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) u[lattice.index(i, j)] = static_cast<float>(value(i, j));
    truncation_variance(lattice, u, 1, variance);
    return std::sqrt(*std::max_element(variance.begin(), variance.end()));
  };
  EXPECT_LE(largest([](int i, int j) { return 0.2 * i - 0.3 * j; }), 1e-5f);
  EXPECT_LE(largest([](int i, int) { return std::sin(2 * M_PI * i / 10); }), 5e-4f);
  EXPECT_GE(largest([](int, int j) { return j < 20 ? 0.0 : 1.0; }), 0.01f);
}

// Grains of two pixels are mostly aliased by half the resolution: means of 2 x 2 pixels moved the wrong way by .03 px.
TEST(Dense, FastIsHardlyBiasedByFineGrains) {
  const NodeLattice nodes = even_nodes(256, 256, 16, 48);
  PivOptions options;
  options.method = "fast";
  image::TextureOptions fine;
  fine.blob_diameter_px = 2;
  for (const double shift : {0.25, 0.5, 0.75}) {
    const Scene scene = make_scene(uniform(shift, -shift), 256, 256, fine);
    EXPECT_LE(errors(scene, nodes, measure(scene, nodes, options)).bias, 0.006) << shift;
  }
}

struct Asked {
  const char* method;
  Smoothing smoothing;
  int order;
  double uniform, shear;  // rms, px
};

class Methods : public testing::TestWithParam<Asked> {};

TEST_P(Methods, FindPlainMotionsWithEitherAnchor) {
  const Asked asked = GetParam();
  const NodeLattice nodes = even_nodes(256, 256, 16, 48);
  for (const Anchor anchor : {Anchor::central, Anchor::forward}) {
    PivOptions options;
    options.method = asked.method, options.smoothing = asked.smoothing, options.order = asked.order;
    options.anchor = anchor;
    SCOPED_TRACE(std::string(name_of(anchor)));
    const Scene even = make_scene(uniform(3.3, -1.6), 256, 256, {}),
                sheared = make_scene(plain_shear(0.1, 127.5), 256, 256, {});
    const Errors u = errors(even, nodes, measure(even, nodes, options)),
                 s = errors(sheared, nodes, measure(sheared, nodes, options));
    EXPECT_LE(u.rms, asked.uniform);
    EXPECT_GE(u.valid, 0.99);
    EXPECT_LE(s.rms, asked.shear);
    EXPECT_GE(s.valid, 0.97);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Methods,
    testing::Values(Asked{"default", Smoothing::adaptive, 1, 0.003, 0.004},
                    Asked{"gn", Smoothing::window, 0, 0.006, 0.010}, Asked{"gn", Smoothing::window, 1, 0.006, 0.010},
                    Asked{"gn", Smoothing::window, 2, 0.006, 0.010},
                    Asked{"fast", Smoothing::adaptive, 1, 0.006, 0.015},
                    Asked{"fft", Smoothing::adaptive, 1, 0.008, 0.012},
                    Asked{"ncc", Smoothing::adaptive, 1, 0.008, 0.012}),
    [](const auto& tested) {
      const Asked& a = tested.param;
      return std::string(a.method) + "_" + std::string(name_of(a.smoothing)) + std::to_string(a.order);
    });

// A replaced vector may state less than the field that was smoothed anew: what it states falls with it, but not below
// zero.
TEST(Quality, AVarianceThatFallsStaysPositive) {
  EXPECT_FLOAT_EQ(changed_variance(5, 4, -3), 2);
  EXPECT_FLOAT_EQ(changed_variance(2, 4, -3), .5f);
  EXPECT_FLOAT_EQ(changed_variance(2, 4, 3), 5);
  EXPECT_FLOAT_EQ(changed_variance(2, 0, 0), 2);
}

}  // namespace
}  // namespace pivnp::piv

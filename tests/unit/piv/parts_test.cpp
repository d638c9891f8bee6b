// The parts of the correlation, each against what is known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "pivnp/piv/sampling/lattice.hpp"
#include "pivnp/piv/sampling/sample.hpp"
#include "pivnp/piv/sampling/spline_image.hpp"
#include "pivnp/piv/validation/median_test.hpp"
#include "pivnp/piv/validation/replacement.hpp"
#include "pivnp/piv/window/correlate.hpp"
#include "pivnp/piv/window/predictor.hpp"
#include "pivnp/piv/window/subpixel.hpp"
#include "pivnp/piv/window_passes.hpp"

namespace pivnp::piv {
namespace {

Image float_image(int width, int height, auto value) {
  Image image(width, height, PixelDepth::f32, 1.0f);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) image.row<float>(r)[c] = static_cast<float>(value(c, r));
  return image;
}

// One place: the value at (x, y), of which 16 lanes are taken.
double value_at(const SplineImage& spline, float x, float y) {
  std::array<float, 16> ux, uy, out;
  for (std::size_t k = 0; k < ux.size(); ++k)
    ux[k] = x - std::floor(x) - static_cast<float>(k), uy[k] = y - std::floor(y);
  sample_displaced(spline, static_cast<int>(x), static_cast<int>(y), ux.data(), uy.data(), 1, out.data());
  return out[0];
}

TEST(SplineImage, RepeatsThePixelsAndPolynomialsBetweenThem) {
  const auto polynomial = [](double x, double y) {
    const double s = (x - 30) / 30, t = (y - 25) / 25;
    return 1 + s - 2 * t + 3 * s * s * t - s * s * s * t * t + t * t * t * t;
  };
  const Image image = float_image(61, 51, polynomial);
  SplineImage spline;
  spline.assign(image.view(), {}, 1, 1);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> column(20, 40), row(18, 32);
  for (int k = 0; k < 200; ++k) {
    const float x = column(random), y = row(random);
    EXPECT_NEAR(value_at(spline, x, y), polynomial(x, y), 2e-4) << x << ' ' << y;
  }
  for (int r = 0; r < 51; ++r)
    for (int c = 0; c < 61; ++c)
      EXPECT_NEAR(value_at(spline, static_cast<float>(c), static_cast<float>(r)), polynomial(c, r), 1e-4);
}

TEST(SplineImage, SixteenAtATimeEqualOneAtATime) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> grey(0, 255), jitter(0, 1);
  const Image image = float_image(80, 40, [&](int, int) { return grey(random); });
  SplineImage spline;
  spline.assign(image.view(), {}, 1, 2);
  for (const float stretch : {1.0f, 1.07f, 0.9f, 1.6f}) {
    std::vector<float> ux(48), uy(48), together(48);
    const auto moved = [&](std::size_t k) { return (stretch - 1) * static_cast<float>(k); };
    for (std::size_t k = 0; k < ux.size(); ++k) {
      ux[k] = moved(k) + 0.02f * jitter(random);
      uy[k] = 0.08f * static_cast<float>(k);
    }
    sample_displaced(spline, 10, 20, ux.data(), uy.data(), 37, together.data());
    for (std::size_t k = 0; k < 37; ++k)
      EXPECT_NEAR(together[k], value_at(spline, 10 + static_cast<float>(k) + ux[k], 20 + uy[k]), 2e-3)
          << stretch << ' ' << k;
  }
}

TEST(SplineImage, DecimationAveragesUsablePixels) {
  const Image image = float_image(20, 18, [](int c, int r) { return 100 * (r / 2) + (c % 2 == 0 ? 10 : 30); });
  std::vector<std::uint8_t> use(20 * 18, 1);
  for (std::size_t k = 1; k < use.size(); k += 2) use[k] = 0;  // odd columns
  SplineImage all, some;
  all.assign(image.view(), {}, 2, 1);
  some.assign(image.view(), {use.data(), 20, 18, 20}, 2, 1);
  EXPECT_EQ(all.width(), 10);
  EXPECT_EQ(all.height(), 9);
  EXPECT_NEAR(value_at(all, 4, 3), 320, 1e-2);
  EXPECT_NEAR(value_at(some, 4, 3), 310, 1e-2);
}

TEST(Subpixel, GaussianPeaksAreFoundExactly) {
  for (const double centre : {-0.49, -0.2, 0.0, 0.31, 0.5}) {
    const auto g = [&](double x) { return static_cast<float>(std::exp(-0.5 * (x - centre) * (x - centre) / 0.8)); };
    EXPECT_NEAR(three_point_peak(g(-1), g(0), g(1)), centre, 1e-5);
    if (std::abs(centre) > 0.2) continue;
    const float step = 1e-3f;  // the derivative is that of a balanced peak
    const float slope =
        (three_point_peak(g(-1) - step / 2, g(0), g(1) + step / 2) - three_point_peak(g(-1), g(0), g(1))) / step;
    EXPECT_NEAR(three_point_sensitivity(g(-1), g(0), g(1)), slope, 0.1 * slope);
  }
  EXPECT_FLOAT_EQ(three_point_peak(-0.1f, 1.0f, -0.1f), 0.0f);  // no logarithm: parabola
  EXPECT_GT(three_point_peak(-0.1f, 1.0f, 0.2f), 0.0f);
  EXPECT_FLOAT_EQ(three_point_peak(1.0f, 1.0f, 1.0f), 0.0f);
  EXPECT_TRUE(std::isinf(three_point_sensitivity(1.0f, 1.0f, 1.0f)));
}

TEST(Lattice, CoversTheBoxEvenlyAndKeepsNearTheNodes) {
  const EvenLattice lattice = even_lattice({10, 20, 110, 80}, 15);
  EXPECT_EQ(lattice.nx, 7);
  EXPECT_EQ(lattice.ny, 4);
  EXPECT_FLOAT_EQ(lattice.x0 - lattice.dx / 2, 9.5f);
  EXPECT_FLOAT_EQ(lattice.x0 + 6.5f * lattice.dx, 109.5f);
  const NodeLattice one{1, 1, {{60, 50}}, {}};
  const NodeLattice near = nodes_near(lattice, one, 16);
  int on = 0;
  for (std::size_t k = 0; k < near.pixel.size(); ++k)
    if (near.on[k]) {
      ++on;
      EXPECT_LE(std::max(std::abs(near.pixel[k][0] - 60), std::abs(near.pixel[k][1] - 50)), 16);
    }
  EXPECT_GE(on, 4);
}

struct Field {
  EvenLattice lattice{12, 9, 20.0f, 16.0f, 8.5f, 8.0f};
  std::vector<std::array<float, 2>> d;
  std::vector<std::uint8_t> good;
  explicit Field(auto value) {
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) {
        const double x = lattice.x0 + i * lattice.dx, y = lattice.y0 + j * lattice.dy;
        d.push_back({static_cast<float>(value(x, y)), static_cast<float>(-2 * value(y, x))});
        good.push_back(1);
      }
  }
};

TEST(Predictor, RepeatsLinearFieldsEverywhereThoughVectorsAreMissing) {
  const auto linear = [](double x, double y) { return 1.5 + 0.04 * x - 0.07 * y; };
  Field field(linear);
  for (const std::size_t k : {0u, 5u, 17u, 40u, 41u, 52u, 53u, 100u, 107u}) field.good[k] = 0, field.d[k] = {99, -99};
  PredictorField predictor;
  EXPECT_EQ(predictor.at(3, 4), (std::array<float, 2>{0, 0}));
  predictor.fit(field.lattice, field.d, field.good, 1.2f, 2);
  for (float y = 2; y < 100; y += 3.7f)
    for (float x = 1; x < 130; x += 4.1f) {
      const auto d = predictor.at(x, y);
      EXPECT_NEAR(d[0], linear(x, y), 1e-4);
      EXPECT_NEAR(d[1], -2 * linear(y, x), 2e-4);
    }
}

TEST(Predictor, RepeatsQuadraticFieldsInsideAndRowsEqualPoints) {
  const auto quadratic = [](double x, double y) { return 1 + 0.001 * x * x - 0.002 * x * y + 0.0015 * y * y; };
  const Field field(quadratic);
  PredictorField predictor;
  predictor.fit(field.lattice, field.d, field.good, 1.2f, 1);
  const auto plan = predictor.plan_row(38, 0.5f, 100);
  std::vector<float> scratch, du(100), dv(100);
  predictor.row(plan, 45.3f, scratch, du.data(), dv.data());
  for (std::size_t k = 0; k < 100; ++k) {
    const float x = 38 + 0.5f * static_cast<float>(k);
    EXPECT_NEAR(du[k], quadratic(x, 45.3), 1e-3);
    EXPECT_FLOAT_EQ(du[k], predictor.at(x, 45.3f)[0]);
    EXPECT_FLOAT_EQ(dv[k], predictor.at(x, 45.3f)[1]);
  }
}

TEST(Predictor, OneVectorIsAConstantField) {
  const EvenLattice lattice{1, 1, 50, 40, 100, 80};
  PredictorField predictor;
  predictor.fit(lattice, {{3, -2}}, {1}, 1, 1);
  EXPECT_EQ(predictor.at(0, 0), (std::array<float, 2>{3, -2}));
  EXPECT_EQ(predictor.at(500, 40), (std::array<float, 2>{3, -2}));
}

VectorGrid sheared(int nx, int ny, double slope, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  VectorGrid grid{nx, ny, {}, std::vector<std::uint8_t>(std::size_t(nx * ny), 1)};
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      grid.displacement.push_back({static_cast<float>(slope * j + noise * normal(random)),
                                   static_cast<float>(0.1 * slope * i + noise * normal(random))});
  return grid;
}

TEST(MedianTest, KeepsGoodVectorsInSteepGradients) {
  // 20 % shear at 16 px spacing: 3.2 px from node to node
  VectorGrid grid = sheared(40, 30, 3.2, 0.03, 1);
  median_test(grid, 2.0, 0.1, 2);
  EXPECT_EQ(std::count(grid.good.begin(), grid.good.end(), 1), 1200);
}

TEST(MedianTest, FindsSingleOutliersAndClusters) {
  VectorGrid grid = sheared(40, 30, 1.6, 0.03, 2);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> wrong(2, 8);
  std::vector<std::uint8_t> is_wrong(grid.good.size(), 0);
  const auto spoil = [&](int i, int j) {
    const auto k = std::size_t(j * 40 + i);
    grid.displacement[k][0] += (random() % 2 ? 1.0f : -1.0f) * wrong(random);
    is_wrong[k] = 1;
  };
  for (int j = 1; j < 29; j += 5)
    for (int i = 1; i < 20; i += 5) spoil(i, j);
  for (int j = 5; j < 26; j += 9)
    for (int i = 25; i < 37; i += 8)
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) spoil(i + a, j + b);
  median_test(grid, 2.0, 0.1, 1);
  int found = 0, all = 0, false_alarms = 0;
  for (std::size_t k = 0; k < grid.good.size(); ++k) {
    all += is_wrong[k], found += is_wrong[k] && !grid.good[k], false_alarms += !is_wrong[k] && !grid.good[k];
  }
  EXPECT_GE(found, 0.95 * all) << found << " of " << all;
  EXPECT_LE(false_alarms, 12);
}

double median_of(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

// The test of one point whose 24 neighbours are all good, as its header defines it; 1 is the limit.
double median_excess(const VectorGrid& grid, int i, int j, double threshold, double floor) {
  double off[2], relative[2];
  for (std::size_t c = 0; c < 2; ++c) {
    const auto at = [&](int a, int b) { return double(grid.displacement[std::size_t((j + b) * grid.nx + i + a)][c]); };
    std::vector<double> along[2], bend[2];
    for (int b = -2; b <= 2; ++b)
      for (int a = -2; a <= 2; ++a)
        for (int n = 0; n < 2; ++n) {
          const int da = n == 0, db = n == 1;
          const auto there = [&](int k) { return a + k * da <= 2 && b + k * db <= 2; };
          const auto middle = [&](int k) { return a + k * da == 0 && b + k * db == 0; };
          const auto value = [&](int k) { return at(a + k * da, b + k * db); };
          if (there(1) && !middle(0) && !middle(1)) along[n].push_back(value(1) - value(0));
          if (there(2) && !middle(0) && !middle(1) && !middle(2))
            bend[n].push_back(std::abs(value(0) - 2 * value(1) + value(2)));
        }
    std::vector<double> level, scatter;
    const double slope_i = median_of(along[0]), slope_j = median_of(along[1]);
    for (int b = -2; b <= 2; ++b)
      for (int a = -2; a <= 2; ++a)
        if (a != 0 || b != 0) level.push_back(at(a, b) - slope_i * a - slope_j * b);
    const double median = median_of(level);
    for (const double x : level) scatter.push_back(std::abs(x - median));
    for (auto& v : bend) std::sort(v.begin(), v.end());
    off[c] = std::abs(at(0, 0) - median);
    relative[c] =
        off[c] / (median_of(scatter) + std::max(bend[0][bend[0].size() / 4], bend[1][bend[1].size() / 4]) + floor);
  }
  return std::min(std::hypot(relative[0], relative[1]) / threshold, std::hypot(off[0], off[1]) / (threshold * floor));
}

TEST(MedianTest, EqualsItsDefinition) {
  int failed = 0, passed = 0;
  for (const unsigned seed : {3u, 4u, 5u}) {
    VectorGrid grid = sheared(41, 23, 0.8, 0.15, seed);
    const VectorGrid given = grid;
    constexpr double threshold = 1.5, floor = 0.05;
    median_test(grid, threshold, floor, 1);
    // Two rounds: what failed the first is tested against the survivors. Points all of whose neighbours survived are as
    // after the first.
    for (int j = 2; j < 21; ++j)
      for (int i = 2; i < 39; ++i) {
        bool whole = true;
        for (int b = -2; b <= 2; ++b)
          for (int a = -2; a <= 2; ++a)
            whole = whole && ((a == 0 && b == 0) || grid.good[std::size_t((j + b) * 41 + i + a)]);
        const double excess = median_excess(given, i, j, threshold, floor);
        if (!whole || std::abs(excess - 1) < 1e-3) continue;
        EXPECT_EQ(grid.good[std::size_t(j * 41 + i)] != 0, excess < 1) << i << " " << j << " " << excess;
        (excess < 1 ? passed : failed) += 1;
      }
  }
  EXPECT_GT(passed, 100);
  EXPECT_GT(failed, 10);
}

TEST(Replacement, RepeatsALinearFieldAndMarksIt) {
  const int nx = 9, ny = 7;
  std::vector<std::array<float, 2>> d, truth;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      truth.push_back({0.5f * static_cast<float>(i) - 0.2f * static_cast<float>(j), static_cast<float>(i)});
  d = truth;
  std::vector<VectorStatus> status(d.size(), VectorStatus::valid);
  std::vector<std::array<float, 3>> cov(d.size(), {1e-4f, 4e-4f, 0});
  const auto reject = [&](int i, int j) {
    status[std::size_t(j * nx + i)] = VectorStatus::rejected;
    d[std::size_t(j * nx + i)] = {50, 50};
  };
  reject(4, 3), reject(0, 6), reject(7, 2), reject(8, 2);
  status[0] = VectorStatus::failed;
  replace_rejected(nx, ny, 2, d, status, cov);
  for (const auto& [i, j] : {std::pair{4, 3}, {7, 2}}) {
    const auto k = std::size_t(j * nx + i);
    EXPECT_EQ(status[k], VectorStatus::replaced);
    EXPECT_NEAR(d[k][0], truth[k][0], 1e-4);
    EXPECT_NEAR(d[k][1], truth[k][1], 1e-4);
    EXPECT_NEAR(cov[k][1], 4e-4, 1e-6);
  }
  EXPECT_EQ(status[std::size_t(6 * nx)], VectorStatus::replaced);  // a corner: three neighbours, their median
  EXPECT_EQ(status[0], VectorStatus::failed);                      // nothing was measured: not replaced
}

TEST(Replacement, GoesTwoRingsFarAndNoFarther) {
  const int nx = 9, ny = 9;
  std::vector<std::array<float, 2>> d(81, {1, 2});
  std::vector<VectorStatus> status(81, VectorStatus::rejected);
  std::vector<std::array<float, 3>> cov(81, {1e-4f, 1e-4f, 0});
  for (std::size_t k = 0; k < 27; ++k) status[k] = VectorStatus::valid;  // three rows
  replace_rejected(nx, ny, 2, d, status, cov);
  EXPECT_EQ(status[3 * 9 + 4], VectorStatus::replaced);
  EXPECT_EQ(status[4 * 9 + 4], VectorStatus::replaced);
  EXPECT_EQ(status[5 * 9 + 4], VectorStatus::rejected);
}

TEST(Windows, HalveFromTheFirstToTheLast) {
  PivOptions options;
  EXPECT_EQ(window_sides(options, 1024, 1024), (std::vector<int>{128, 64, 32}));
  options.first_window_px = 256;
  EXPECT_EQ(window_sides(options, 1024, 1024), (std::vector<int>{256, 128, 64, 32}));
  options.first_window_px = 32;
  EXPECT_EQ(window_sides(options, 1024, 1024), (std::vector<int>{32}));
  options.first_window_px = 0;
  EXPECT_EQ(window_sides(options, 250, 150), (std::vector<int>{75, 37, 32}));
}

// The direct sums and the FFT are the same correlation.
TEST(Correlate, NearAndFarAgree) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal(0, 1);
  WarpedPair pair;
  pair.resize({0, 0, 64, 64}, false);
  std::vector<float> texture(70 * 70);
  for (float& t : texture) t = normal(random);
  const auto smooth = [&](int c, int r) {
    float sum = 0;
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a) sum += texture[std::size_t((r + b) * 70 + c + a)];
    return sum;
  };
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) {
      pair.f[pair.index(c, r)] = smooth(c + 1, r);
      pair.g[pair.index(c, r)] = smooth(c, r + 1);  // content of g lies at (+1, -1)
      pair.use[pair.index(c, r)] = 1;
    }
  Window window(40);
  window.cut(pair, 31.3f, 32.8f);
  EXPECT_NEAR(window.usable, 1, 1e-5);
  const Peak near = NearCorrelator(40).find(window);
  FftCorrelator fft(40);
  const Peak far = fft.find(window);
  EXPECT_NEAR(near.dx, 1, 0.1);
  EXPECT_NEAR(near.dy, -1, 0.1);
  EXPECT_NEAR(near.dx, far.dx, 0.02);  // the FFT wraps a little of the tapered edge
  EXPECT_NEAR(near.dy, far.dy, 0.02);
  EXPECT_NEAR(near.score, far.score, 0.01);
  EXPECT_GT(near.score, 0.9);
}

}  // namespace
}  // namespace pivnp::piv

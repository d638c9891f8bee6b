// The two doubles of plain x86-64: each operation, and whole runs against the library's own of two lanes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "mpm/transfer/lanes.hpp"
#include "mpm/simd/sse2.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using pivnp::test::choose_best_instruction_set, pivnp::test::choose_instruction_set, pivnp::test::instruction_sets;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

#if defined(__SSE2__)

using sse2::Double2, sse2::Mask2;
using Two = std::array<double, 2>;
constexpr sse2::Tag<2> both;
constexpr sse2::Tag<1> one;

Double2 of(Two v) { return LoadU(both, v.data()); }
Two lanes(Double2 v) {
  Two out;
  StoreU(v, both, out.data());
  return out;
}
std::array<bool, 2> lanes(Mask2 m) {
  const Two bits = lanes(Double2{m.raw});
  for (const double b : bits) {
    const auto all = std::bit_cast<std::uint64_t>(b);
    EXPECT_TRUE(all == 0 || all == ~std::uint64_t{0}) << all;
  }
  return {std::bit_cast<std::uint64_t>(bits[0]) != 0, std::bit_cast<std::uint64_t>(bits[1]) != 0};
}
void expect_bits(Double2 v, double low, double high, const std::string& what = {}) {
  const Two got = lanes(v), expected{low, high};
  for (int l = 0; l < 2; ++l) {
    if (std::isnan(expected[l])) EXPECT_TRUE(std::isnan(got[l])) << what << ' ' << l;
    else EXPECT_TRUE(got[l] == expected[l] && std::signbit(got[l]) == std::signbit(expected[l])) << what << ' ' << l << ' ' << got[l];
  }
}

// Every number with every other one, in both lanes.
template <class Each>
void for_pairs(Each&& each) {
  const double numbers[] = {0.0, -0.0, 1.0, -1.0, 0.1, -3.5, 1e-310, -1e308, inf, -inf, nan};
  for (const double a : numbers)
    for (const double b : numbers) each(Two{a, 0.7}, Two{b, -0.3}), each(Two{0.7, a}, Two{-0.3, b});
}

TEST(Sse2, ArithmeticIsThatOfTheLanes) {
  for_pairs([](Two x, Two y) {
    const Double2 a = of(x), b = of(y), c = of({0.25, -7});
    const auto expect = [&](const char* what, Double2 got, auto&& plain) {
      expect_bits(got, plain(x[0], y[0], 0.25), plain(x[1], y[1], -7.0), what);
    };
    expect("+", a + b, [](double p, double q, double) { return p + q; });
    expect("-", a - b, [](double p, double q, double) { return p - q; });
    expect("*", a * b, [](double p, double q, double) { return p * q; });
    expect("/", a / b, [](double p, double q, double) { return p / q; });
    expect("MulAdd", MulAdd(a, b, c), [](double p, double q, double r) { return p * q + r; });
    expect("MulSub", MulSub(a, b, c), [](double p, double q, double r) { return p * q - r; });
    expect("NegMulAdd", NegMulAdd(a, b, c), [](double p, double q, double r) { return r - p * q; });
    // The second one where one is not a number, and of two zeros.
    expect("Min", Min(a, b), [](double p, double q, double) { return p < q ? p : q; });
    expect("Max", Max(a, b), [](double p, double q, double) { return p > q ? p : q; });
    expect("Sqrt", Sqrt(a), [](double p, double, double) { return std::sqrt(p); });
    expect("Neg", sse2::Neg(a), [](double p, double, double) { return -p; });
    expect("Abs", Abs(a), [](double p, double, double) { return std::abs(p); });
  });
  EXPECT_TRUE(std::signbit(lanes(sse2::Neg(Zero(both)))[1]));
  EXPECT_EQ(GetLane(SumOfLanes(both, of({1.5, 2}))), 3.5);
  EXPECT_EQ(GetLane(MaxOfLanes(both, of({1.5, 2}))), 2);
  EXPECT_EQ(GetLane(MaxOfLanes(both, of({3, 2}))), 3);
  expect_bits(Set(both, 3), 3, 3);
  expect_bits(Inf(both), inf, inf);
}

TEST(Sse2, ComparisonsAreFalseForWhatIsNoNumber) {
  for_pairs([](Two x, Two y) {
    const Double2 a = of(x), b = of(y);
    const auto expect = [&](const char* what, Mask2 got, auto&& plain) {
      const std::array<bool, 2> is = lanes(got);
      for (int l = 0; l < 2; ++l) EXPECT_EQ(is[l], plain(x[l], y[l])) << what << ' ' << x[l] << ' ' << y[l];
    };
    expect("Eq", Eq(a, b), [](double p, double q) { return p == q; });
    expect("Ne", Ne(a, b), [](double p, double q) { return p != q; });
    expect("Lt", Lt(a, b), [](double p, double q) { return p < q; });
    expect("Le", Le(a, b), [](double p, double q) { return p <= q; });
    expect("Gt", Gt(a, b), [](double p, double q) { return p > q; });
    expect("Ge", Ge(a, b), [](double p, double q) { return p >= q; });
  });
}

TEST(Sse2, MasksChooseLaneByLane) {
  for (unsigned m = 0; m < 4; ++m) {
    const std::uint8_t bits[] = {std::uint8_t(m | 0xf4)};  // the other bits say nothing
    const Mask2 mask = LoadMaskBits(both, bits);
    const bool low = m & 1, high = m & 2;
    EXPECT_EQ(lanes(mask), (std::array{low, high}));
    EXPECT_EQ(lanes(Not(mask)), (std::array{!low, !high}));
    EXPECT_EQ(AllTrue(both, mask), m == 3);
    EXPECT_EQ(AllFalse(both, mask), m == 0);
    const Double2 a = of({1, 2}), b = of({nan, -4});
    expect_bits(IfThenElse(mask, a, b), low ? 1 : nan, high ? 2 : -4);
    expect_bits(IfThenElse(mask, b, a), low ? nan : 1, high ? -4 : 2);
    expect_bits(IfThenElseZero(mask, b), low ? nan : 0, high ? -4 : 0);
    expect_bits(IfThenZeroElse(mask, b), low ? 0 : nan, high ? 0 : -4);
    for (unsigned n = 0; n < 4; ++n) {
      const std::uint8_t other_bits[] = {std::uint8_t(n)};
      const Mask2 other = LoadMaskBits(both, other_bits);
      const bool other_low = n & 1, other_high = n & 2;
      EXPECT_EQ(lanes(And(mask, other)), (std::array{low && other_low, high && other_high}));
      EXPECT_EQ(lanes(Or(mask, other)), (std::array{low || other_low, high || other_high}));
      EXPECT_EQ(lanes(AndNot(mask, other)), (std::array{!low && other_low, !high && other_high}));
    }
    std::uint8_t stored[8] = {};
    EXPECT_EQ(StoreMaskBits(both, mask, stored), 1u);
    EXPECT_EQ(stored[0], m);
  }
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{1} << 40}) {
    EXPECT_EQ(lanes(FirstN(both, n)), (std::array{n > 0, n > 1}));
    EXPECT_EQ(lanes(FirstN(one, n)), (std::array{n > 0, false}));
  }
}

TEST(Sse2, LanesGoWhereTheyShould) {
  const Double2 a = of({1, 2}), b = of({3, 4});
  expect_bits(InterleaveLower(both, a, b), 1, 3);
  expect_bits(InterleaveUpper(both, a, b), 2, 4);
  expect_bits(OddEven(a, b), 3, 2);
  expect_bits(Reverse2(both, a), 2, 1);
  EXPECT_EQ(GetLane(Compress(a, FirstN(both, 1))), 1);
  EXPECT_EQ(GetLane(Compress(a, Not(FirstN(both, 1)))), 2);
  expect_bits(Compress(a, FirstN(both, 2)), 1, 2);
  EXPECT_EQ(MaxLanes(sse2::CappedTag<double, 8>()), 2u);
  EXPECT_EQ(Lanes(sse2::CappedTag<double, 1>()), 1u);

  const std::vector<double> from{1, 2, 3, 4, 5, 6, 7, 8};
  Double2 v[4];
  LoadInterleaved4(both, from.data(), v[0], v[1], v[2], v[3]);
  for (int c = 0; c < 4; ++c) expect_bits(v[c], c + 1, c + 5);
  std::vector<double> to(8);
  StoreInterleaved4(v[0], v[1], v[2], v[3], both, to.data());
  EXPECT_EQ(to, from);
  LoadInterleaved2(both, from.data(), v[0], v[1]);
  expect_bits(v[0], 1, 3);
  expect_bits(v[1], 2, 4);
  to.assign(4, 0);
  StoreInterleaved2(v[0], v[1], both, to.data());
  EXPECT_EQ(to, (std::vector<double>{1, 2, 3, 4}));
  // One lane: memory that ends behind it.
  const std::vector<double> four{1, 2, 3, 4};
  LoadInterleaved4(one, four.data(), v[0], v[1], v[2], v[3]);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(GetLane(v[c]), c + 1);
  to.assign(4, 0);
  StoreInterleaved4(v[0], v[1], v[2], v[3], one, to.data());
  EXPECT_EQ(to, four);
  const std::vector<double> pair{5, 6};
  LoadInterleaved2(one, pair.data(), v[0], v[1]);
  to.assign(2, 0);
  StoreInterleaved2(v[0], v[1], one, to.data());
  EXPECT_EQ(to, pair);
  double last = 0;
  StoreU(LoadU(one, &four[3]), one, &last);
  EXPECT_EQ(last, 4);
}

TEST(Sse2, ExpIsThatOfTheStandardLibrary) {
  std::mt19937_64 random(20260301);
  std::uniform_real_distribution<double> wide(-708, 706), small(-1, 1);
  const double least = std::numeric_limits<double>::denorm_min();
  for (int k = 0; k < 100000; ++k) {
    const Two x = k % 2 ? Two{wide(random), small(random)} : Two{small(random) * 1e-3, -std::abs(wide(random))};
    const Two y = lanes(Exp(both, of(x)));
    for (int l = 0; l < 2; ++l) ASSERT_NEAR(y[l], std::exp(x[l]), 4e-16 * std::exp(x[l])) << x[l];
  }
  for (double x = -708; x > -999; x -= 0.37)
    EXPECT_NEAR(lanes(Exp(both, of({0, x})))[1], std::exp(x), least + 4e-16 * std::exp(x)) << x;
  expect_bits(Exp(both, of({0, -0.0})), 1, 1);
  expect_bits(Exp(both, of({-1001, -inf})), 0, 0);
  expect_bits(Exp(both, of({nan, 1})), 0, lanes(Exp(both, of({1, 1})))[0]);
  expect_bits(sse2::power_of_two(_mm_setr_epi32(-1022, 1023, 5, 5)), 0x1p-1022, 0x1p1023);
}

#endif  // __SSE2__

// The names of the sets that kernels were compiled for.
std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const std::int64_t set : instruction_sets()) {
    choose_instruction_set(set);
    out.emplace_back(simd_target());
  }
  choose_best_instruction_set();
  return out;
}

TEST(InstructionSets, TheBaselineIsAmongThem) {
  const std::vector<std::string> all = names();
  EXPECT_EQ(all.front(), simd_target());  // chosen by itself
  EXPECT_EQ(std::count(all.begin(), all.end(), "SCALAR"), 0);
#if defined(__x86_64__) && !defined(__SSE3__)
  EXPECT_EQ(all.back(), "SSE2");
#endif
}

// Sets whose vectors hold two doubles (pairs-inl.hpp). None of them contracts products and sums, so whole runs agree to the last bit of their state.
TEST(InstructionSets, ThoseInPairsGiveTheSameBits) {
  struct Setting {
    const char *shape, *transfer, *stress_update, *locking;
    bool smooth;
  };
  const Setting settings[] = {{"bspline", "apic", "usl", "fbar", false},
                              {"bspline", "apic", "usl", "none", true},
                              {"bilinear", "flip", "musl", "fbar", true},
                              {"bilinear", "flip", "musl", "selective", false},
                              {"gimp", "xpic", "usf", "fbar", false}};
  for (const Setting& s : settings) {
    std::map<std::string, std::vector<std::byte>> ends;
    for (const std::int64_t set : instruction_sets()) {
      choose_instruction_set(set);
      const std::string name = simd_target();
      if (name != "SSE2" && name != "SSSE3" && name != "SSE4") continue;
      MaterialOptions m = test::sand(38, 1e6);
      if (s.smooth) m.model = "mohr_coulomb_smooth";
      m.friction_residual_deg = 28;
      m.softening_shape = 10;
      m.dilatancy_deg = 8;
      m.dilatancy_fade = 0.1;
      MpmOptions o = test::options({2, -9.81});
      o.shape = value_named<ShapeKind>(s.shape);
      o.transfer = value_named<TransferKind>(s.transfer);
      o.stress_update = value_named<StressUpdate>(s.stress_update);
      o.locking = value_named<Locking>(s.locking);
      Scene scene = test::column(0.08, m);
      scene.boundaries.pop_back();  // it falls over
      scene.particles.x0[5] += Vec2(1e-3, -2e-3);
      Solver solver(o, std::move(scene), 1);
      SilentProgress silent;
      solver.advance_to(200 * solver.stable_step(), silent);
      const FieldValues plastic_dev = solver.frame().field("plastic_dev");
      EXPECT_GT(*std::max_element(plastic_dev.values.begin(), plastic_dev.values.end()), 0) << s.shape << s.transfer;
      ends[name] = solver.save();
    }
    choose_best_instruction_set();
    ASSERT_FALSE(ends.empty());
    for (const auto& [name, state] : ends)
      EXPECT_TRUE(state == ends.begin()->second) << name << ' ' << s.shape << ' ' << s.transfer;
  }
}

}  // namespace
}  // namespace pivnp::mpm

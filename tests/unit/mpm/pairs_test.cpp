// Two vectors of two doubles as one of four (pairs.hpp): each operation against what it does lane by lane.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "mpm/simd/pairs.hpp"

namespace pivnp::mpm {
namespace {

namespace hn = pairs;
using hn::Double4, hn::Mask4;
using Lanes4 = std::array<double, 4>;
using Bits4 = std::array<bool, 4>;
constexpr hn::Tag4 d;
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

Double4 of(const Lanes4& v) { return hn::LoadU(d, v.data()); }
Lanes4 lanes(Double4 v) {
  Lanes4 out;
  hn::StoreU(v, d, out.data());
  return out;
}
Mask4 mask(unsigned bits) {
  const std::uint8_t byte[8] = {std::uint8_t(bits | 0xf0)};  // the other bits say nothing
  return hn::LoadMaskBits(d, byte);
}
Bits4 lanes(Mask4 m) {
  Bits4 out;
  const Lanes4 ones = lanes(hn::IfThenElseZero(m, hn::Set(d, 1)));
  std::transform(ones.begin(), ones.end(), out.begin(), [](double v) { return v == 1; });
  return out;
}
// Equal to plain(lane) in all of them.
template <class Got, class Plain>
void expect(const char* what, Got got, Plain&& plain) {
  for (std::size_t l = 0; l < 4; ++l) {
    const auto is = lanes(got)[l];
    const auto should = plain(l);
    EXPECT_TRUE(is == should || (std::isnan(double(is)) && std::isnan(double(should)))) << what << ' ' << l << ' ' << is << ' ' << should;
  }
}

const Lanes4 a{1, -2, 0.75, nan}, b{-0.5, -2, inf, 3}, c{0.25, 7, -3, 11};

TEST(Pairs, ArithmeticIsThatOfTheLanes) {
  const Double4 x = of(a), y = of(b), z = of(c);
  expect("+", x + y, [](std::size_t l) { return a[l] + b[l]; });
  expect("-", x - y, [](std::size_t l) { return a[l] - b[l]; });
  expect("*", x * y, [](std::size_t l) { return a[l] * b[l]; });
  expect("/", x / y, [](std::size_t l) { return a[l] / b[l]; });
  expect("MulAdd", MulAdd(x, y, z), [](std::size_t l) { return a[l] * b[l] + c[l]; });
  expect("MulSub", MulSub(x, y, z), [](std::size_t l) { return a[l] * b[l] - c[l]; });
  expect("NegMulAdd", NegMulAdd(x, y, z), [](std::size_t l) { return c[l] - a[l] * b[l]; });
  expect("Min", Min(y, z), [](std::size_t l) { return std::min(b[l], c[l]); });
  expect("Max", Max(y, z), [](std::size_t l) { return std::max(b[l], c[l]); });
  expect("Sqrt", Sqrt(z), [](std::size_t l) { return std::sqrt(c[l]); });
  expect("Neg", hn::Neg(x), [](std::size_t l) { return -a[l]; });
  expect("Abs", Abs(x), [](std::size_t l) { return std::abs(a[l]); });
  expect("Set", hn::Set(d, 5), [](std::size_t) { return 5.0; });
  expect("Zero", hn::Zero(d), [](std::size_t) { return 0.0; });
  expect("Inf", hn::Inf(d), [](std::size_t) { return inf; });
  const Lanes4 powers{0.5, -700, 3, -2};
  for (std::size_t l = 0; l < 4; ++l)
    EXPECT_NEAR(lanes(Exp(d, of(powers)))[l], std::exp(powers[l]), 4e-16 * std::exp(powers[l])) << l;
  EXPECT_EQ(GetLane(of(c)), 0.25);
  EXPECT_EQ(GetLane(SumOfLanes(d, of(c))), 15.25);
  Lanes4 moved = c;
  for (int turn = 0; turn < 4; ++turn) {  // the greatest one anywhere
    EXPECT_EQ(GetLane(MaxOfLanes(d, of(moved))), 11) << turn;
    std::rotate(moved.begin(), moved.begin() + 1, moved.end());
  }
}

TEST(Pairs, ComparisonsAreThoseOfTheLanes) {
  const Double4 x = of(a), y = of(b);
  expect("Eq", Eq(x, y), [](std::size_t l) { return a[l] == b[l]; });
  expect("Ne", Ne(x, y), [](std::size_t l) { return a[l] != b[l]; });
  expect("Lt", Lt(x, y), [](std::size_t l) { return a[l] < b[l]; });
  expect("Le", Le(x, y), [](std::size_t l) { return a[l] <= b[l]; });
  expect("Gt", Gt(x, y), [](std::size_t l) { return a[l] > b[l]; });
  expect("Ge", Ge(x, y), [](std::size_t l) { return a[l] >= b[l]; });
}

TEST(Pairs, MasksChooseLaneByLane) {
  for (unsigned m = 0; m < 16; ++m) {
    const auto in = [m](std::size_t l) { return (m >> l & 1) == 1; };
    expect("LoadMaskBits", mask(m), in);
    expect("Not", Not(mask(m)), [&](std::size_t l) { return !in(l); });
    EXPECT_EQ(AllTrue(d, mask(m)), m == 15);
    EXPECT_EQ(AllFalse(d, mask(m)), m == 0);
    expect("IfThenElse", IfThenElse(mask(m), of(b), of(c)), [&](std::size_t l) { return in(l) ? b[l] : c[l]; });
    expect("IfThenElseZero", IfThenElseZero(mask(m), of(b)), [&](std::size_t l) { return in(l) ? b[l] : 0; });
    expect("IfThenZeroElse", IfThenZeroElse(mask(m), of(b)), [&](std::size_t l) { return in(l) ? 0 : b[l]; });
    for (unsigned other = 0; other < 16; ++other) {
      const auto too = [other](std::size_t l) { return (other >> l & 1) == 1; };
      expect("And", And(mask(m), mask(other)), [&](std::size_t l) { return in(l) && too(l); });
      expect("Or", Or(mask(m), mask(other)), [&](std::size_t l) { return in(l) || too(l); });
      expect("AndNot", AndNot(mask(m), mask(other)), [&](std::size_t l) { return !in(l) && too(l); });
    }
    // Lanes that are left out may be another thread's, or lie where nothing may be written: their neighbours alone are.
    std::vector<double> to(8, 9.0);
    BlendedStore(of(c), mask(m), d, to.data() + 2);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(to[k], k >= 2 && k < 6 && in(k - 2) ? c[k - 2] : 9) << m << ' ' << k;
    const unsigned last = m == 0 ? 0 : 4 - unsigned(std::countl_zero(std::uint8_t(m << 4)));
    std::vector<double> few(last, 9.0);  // (ends behind the last lane that is stored: the sanitizers look)
    BlendedStore(of(c), mask(m), d, few.data());
    const Lanes4 packed = lanes(Compress(of(c), mask(m)));
    std::size_t n = 0;
    for (std::size_t l = 0; l < 4; ++l) {
      if (!in(l)) continue;
      EXPECT_EQ(packed[n++], c[l]) << m << ' ' << l;
    }
  }
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{4}, std::size_t{1} << 40})
    expect("FirstN", FirstN(d, n), [&](std::size_t l) { return l < n; });
}

TEST(Pairs, LanesGoWhereTheyShould) {
  const Double4 x = of({1, 2, 3, 4}), y = of({5, 6, 7, 8});
  EXPECT_EQ(lanes(ConcatLowerLower(d, y, x)), (Lanes4{1, 2, 5, 6}));
  EXPECT_EQ(lanes(ConcatUpperUpper(d, y, x)), (Lanes4{3, 4, 7, 8}));
  EXPECT_EQ(lanes(ConcatLowerUpper(d, y, x)), (Lanes4{3, 4, 5, 6}));
  EXPECT_EQ(lanes(Reverse2(d, x)), (Lanes4{2, 1, 4, 3}));
  EXPECT_EQ(lanes(OddEvenBlocks(y, x)), (Lanes4{1, 2, 7, 8}));
  EXPECT_EQ(lanes(SwapAdjacentBlocks(x)), (Lanes4{3, 4, 1, 2}));
  const hn::Half<hn::Tag4> h;
  EXPECT_EQ(lanes(Combine(d, LowerHalf(h, y), UpperHalf(h, x))), (Lanes4{3, 4, 5, 6}));
  EXPECT_EQ(hn::MaxLanes(hn::CappedTag<double, 8>()), 4u);
  EXPECT_EQ(hn::Lanes(hn::CappedTag<double, 4>()), 4u);
  EXPECT_EQ(hn::Lanes(hn::CappedTag<double, 1>()), 1u);

  std::vector<double> from(16), to(16);
  for (std::size_t n = 0; n < from.size(); ++n) from[n] = double(n);
  Double4 v[4];
  hn::LoadInterleaved4(d, from.data(), v[0], v[1], v[2], v[3]);
  for (std::size_t k = 0; k < 4; ++k) expect("LoadInterleaved4", v[k], [&](std::size_t l) { return double(4 * l + k); });
  hn::StoreInterleaved4(v[0], v[1], v[2], v[3], d, to.data());
  EXPECT_EQ(to, from);
  from.resize(8);
  to.assign(8, 0);
  hn::LoadInterleaved2(d, from.data(), v[0], v[1]);
  for (std::size_t k = 0; k < 2; ++k) expect("LoadInterleaved2", v[k], [&](std::size_t l) { return double(2 * l + k); });
  hn::StoreInterleaved2(v[0], v[1], d, to.data());
  EXPECT_EQ(to, from);
}

}  // namespace
}  // namespace pivnp::mpm

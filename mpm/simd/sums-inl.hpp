// Sums over the lanes of a tile's groups, added to what the nodes carry. Included by the kernels' sources inside Highway's loop
// over instruction sets.
#if defined(PIVNP_MPM_SUMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_SUMS_INL
#undef PIVNP_MPM_SUMS_INL
#else
#define PIVNP_MPM_SUMS_INL
#endif

#include "mpm/simd/tiles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// Two numbers that go together through the lanes: of each pair of neighbours x in the first lane and y in the second, `other`
// those of its neighbour. So adding up the pair's lanes takes no operation of its own.
struct InPairs {
  V own, other;
  HWY_INLINE InPairs(V x, V y) : own(hn::OddEven(y, x)), other(swapped(hn::OddEven(x, y))) {}
  static HWY_INLINE V swapped(V v) { return hn::Reverse2(D(), v); }
};
// The sums over each group's pairs of `first`, then those of `second`.
template <class Tag>
HWY_INLINE hn::Vec<Tag> sums_of_pairs(Tag d, hn::Vec<Tag> first, hn::Vec<Tag> second) {
  if constexpr (groups == 1) return hn::ConcatLowerLower(d, second, first) + hn::ConcatUpperUpper(d, second, first);
  else return hn::OddEvenBlocks(second, first) + hn::SwapAdjacentBlocks(hn::OddEvenBlocks(first, second));
}

// Adds what each group's lanes hold to four numbers in a row at first(group).
template <class Tag, class First>
HWY_INLINE void add_sums(Tag d, hn::Vec<Tag> sums, First&& first) {
  const auto add = [](auto tag, auto v, double* at) PIVNP_TILE { hn::StoreU(hn::LoadU(tag, at) + v, tag, at); };
  if constexpr (n_lanes == 8) {
    const hn::Half<Tag> h;
    add(h, hn::LowerHalf(h, sums), first(0));
    add(h, hn::UpperHalf(h, sums), first(1));
  } else {
    add(d, sums, first(0));
  }
}

// The sums over each group's lanes of four vectors, added to memory. (Templates, so that only the branch of the lanes
// compiles.)
struct Four {
  V a, b, c, e;

  /// To four numbers in a row at first(group), aligned.
  template <class First>
  HWY_INLINE void add_to(First&& first) const {
    add(D(), first);
  }
  /// To two at low(group) and two at high(group).
  template <class Low, class High>
  HWY_INLINE void add_to(Low&& low, High&& high) const {
    add_halves(D(), low, high);
  }
  /// To single ones at each(group, number).
  template <class Each>
  HWY_INLINE void add_singly(Each&& each) const {
    HWY_ALIGN double sums[groups][4] = {};
    add(D(), [&](std::size_t g) PIVNP_TILE { return sums[g]; });
    for (std::size_t g = 0; g < groups; ++g)
      for (std::size_t n = 0; n < 4; ++n) *each(g, n) += sums[g][n];
  }
  /// To four numbers in a row at first(group), the first of a cache line, and to the fifth what begins each group of
  /// `fifth`: eight lanes only.
  template <class First>
  HWY_INLINE void add_with(V fifth, First&& first) const {
    add_lines(D(), fifth, first);
  }

 private:
  // The sums of neighbouring lanes, x and y in turn.
  template <class Tag>
  static HWY_INLINE hn::Vec<Tag> of_two(Tag d, hn::Vec<Tag> x, hn::Vec<Tag> y) {
    return hn::InterleaveLower(d, x, y) + hn::InterleaveUpper(d, x, y);
  }
  // a, b, c, e of the first group, then of the second.
  template <class Tag>
  HWY_INLINE V all(Tag d) const {
    if constexpr (in_pairs) {  // the halves are there already
      const hn::Half<Tag> h;
      const auto half = [&](V v) PIVNP_TILE { return hn::LowerHalf(h, v) + hn::UpperHalf(h, v); };
      return hn::Combine(d, of_two(h, half(c), half(e)), of_two(h, half(a), half(b)));
    } else {
      return sums_of_pairs(d, of_two(d, a, b), of_two(d, c, e));
    }
  }
  template <class Tag>
  static HWY_INLINE void add_at(Tag d, hn::Vec<Tag> v, double* at) {
    hn::StoreU(hn::LoadU(d, at) + v, d, at);
  }
  template <class Tag, class First>
  HWY_INLINE void add(Tag d, First&& first) const {
    add_sums(d, all(d), first);
  }
  template <class Tag, class First>
  HWY_INLINE void add_lines(Tag d, V fifth, First&& first) const {
    const V sums = all(d), line[] = {hn::ConcatLowerLower(d, fifth, sums), hn::ConcatUpperUpper(d, fifth, sums)};
    for (std::size_t g = 0; g < groups; ++g) {
      const V before = hn::Load(d, first(g));
      hn::Store(before + hn::IfThenElseZero(hn::FirstN(d, 5), line[g]), d, first(g));
    }
  }
  template <class Tag, class Low, class High>
  HWY_INLINE void add_halves(Tag d, Low&& low, High&& high) const {
    if constexpr (n_lanes == 8) {
      const hn::Half<Tag> h;
      const V sums = all(d);
      split(h, hn::LowerHalf(h, sums), low(0), high(0));
      split(h, hn::UpperHalf(h, sums), low(1), high(1));
    } else {
      split(d, all(d), low(0), high(0));
    }
  }
  template <class Tag>
  static HWY_INLINE void split(Tag, hn::Vec<Tag> v, double* low, double* high) {
    const hn::Half<Tag> h;
    add_at(h, hn::LowerHalf(h, v), low);
    add_at(h, hn::UpperHalf(h, v), high);
  }
};

// The sums over each group's lanes of two vectors, in turn: a, b, a, b. Eight lanes only.
template <class Tag>
HWY_INLINE V sums_in_turn(Tag d, V a, V b) {
  const V pairs = hn::InterleaveLower(d, a, b) + hn::InterleaveUpper(d, a, b);
  return pairs + hn::SwapAdjacentBlocks(pairs);
}

// Adds the sums over each group's lanes of four(n) to the first four numbers of a stencil's nodes, and those of fifth(n) to
// the fifth; at(group, n) is the first.
template <int N, class Fifth, class OfNode, class At>
HWY_INLINE void add_fives(OfNode&& four, Fifth&& fifth, At&& at) {
  const auto of = [&](int n) PIVNP_TILE { return [&at, n](std::size_t g) PIVNP_TILE { return at(g, n); }; };
  if constexpr (n_lanes == 8) {
#pragma GCC unroll 8
    for (int n = 0; n < N; n += 2) {
      const V both = sums_in_turn(D(), fifth(n), fifth(n + 1 < N ? n + 1 : n));
      four(n).add_with(both, of(n));
      if (n + 1 < N) four(n + 1).add_with(hn::Reverse2(D(), both), of(n + 1));
    }
  } else {
#pragma GCC unroll 9
    for (int n = 0; n < N; ++n) four(n).add_to(of(n));
#pragma GCC unroll 2
    for (int n = 0; n + 3 < N; n += 4)
      Four{fifth(n), fifth(n + 1), fifth(n + 2), fifth(n + 3)}.add_singly(
          [&](std::size_t g, std::size_t k) PIVNP_TILE { return at(g, n + int(k)) + 4; });
    if constexpr (N % 4 == 1) {
      double last[groups];
      group_sums(fifth(N - 1), last);
      for (std::size_t g = 0; g < groups; ++g) at(g, N - 1)[4] += last[g];
    }
  }
}

// Adds the sums over each group's lanes of a[c], b[c] to two numbers of each of a stencil's nodes; at(group, c) is the
// first.
template <int N, class At>
HWY_INLINE void add_pairs(const V* a, const V* b, At&& at) {
  for (int c = 0; c + 1 < N; c += 2)
    Four{a[c], b[c], a[c + 1], b[c + 1]}.add_to([&](std::size_t g) PIVNP_TILE { return at(g, c); },
                                                [&](std::size_t g) PIVNP_TILE { return at(g, c + 1); });
  if constexpr (N % 2 == 1) {
    double sums[2][groups];
    group_sums(a[N - 1], sums[0]);
    group_sums(b[N - 1], sums[1]);
    for (std::size_t g = 0; g < groups; ++g) {
      at(g, N - 1)[0] += sums[0][g];
      at(g, N - 1)[1] += sums[1][g];
    }
  }
}

// Adds the sums over each group's lanes of v[c] to a number of each of a stencil's nodes, at(group, c).
template <int N, class At>
HWY_INLINE void add_each(const V* v, At&& at) {
  for (int c = 0; c < N; ++c) {
    double sums[groups];
    group_sums(v[c], sums);
    for (std::size_t g = 0; g < groups; ++g) *at(g, c) += sums[g];
  }
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#include "pivnp/piv/validation/median_test.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/validation/median_test.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/lanes-inl.hpp"

#ifndef PIVNP_PIV_MEDIAN_TEST_ONCE
#define PIVNP_PIV_MEDIAN_TEST_ONCE
namespace pivnp::piv {

constexpr int reach = 2;
constexpr int neighbours_in_all = 24;

// Sorting network for n values (Batcher's odd-even merge sort), reduced to the comparisons that the values of ranks
// first ... last depend on.
template <int n, int first, int last>
struct Network {
  struct Pair {
    int low = 0, high = 0;
  };
  static constexpr int most = n * n;
  Pair pair[most] = {};
  int count = 0;
  constexpr Network() {
    Pair all[most] = {};
    int size = 0;
    for (int p = 1; p < n; p *= 2)
      for (int k = p; k >= 1; k /= 2)
        for (int j = k % p; j + k < n; j += 2 * k)
          for (int i = 0; i < k && i + j + k < n; ++i)
            if ((i + j) / (2 * p) == (i + j + k) / (2 * p)) all[size++] = {i + j, i + j + k};
    bool needed[n] = {}, kept[most] = {};
    for (int k = first; k <= last; ++k) needed[k] = true;
    for (int c = size - 1; c >= 0; --c) {
      kept[c] = needed[all[c].low] || needed[all[c].high];
      if (kept[c]) needed[all[c].low] = needed[all[c].high] = true;
    }
    for (int c = 0; c < size; ++c)
      if (kept[c]) pair[count++] = all[c];
  }
};

// One row of points: both components of the five rows about it, and what is found of it.
struct MedianRow {
  const float* component[2][2 * reach + 1];  // rows j - 2 ... j + 2
  const std::uint8_t* whole;                 // all 24 neighbours are good: others are left to the caller
  int points;
  float threshold, floor;
  std::uint8_t* passed;  // of whole points
};

}  // namespace pivnp::piv
#endif

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

// Puts the values of ranks first ... last of v in their places.
template <int n, int first, int last>
HWY_INLINE void rank(V* v) {
  static constexpr Network<n, first, last> network;
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    const auto order = [&](int a, int b) HWY_ATTR {
      const V low = hn::Min(v[a], v[b]);
      v[b] = hn::Max(v[a], v[b]);
      v[a] = low;
    };
    (order(network.pair[k].low, network.pair[k].high), ...);
  }
  (std::make_index_sequence<std::size_t(network.count)>());
}

template <int n>
HWY_INLINE V median(V* v) {
  static_assert(n % 2 == 0);
  rank<n, n / 2 - 1, n / 2>(v);
  return hn::Mul(hn::Set(D(), 0.5f), hn::Add(v[n / 2 - 1], v[n / 2]));
}

// The neighbours of consecutive points, one component.
struct Around {
  const float* const* row;
  int i;
  V at(int a, int b) const { return hn::LoadU(D(), row[b + reach] + i + a); }
};

constexpr bool middle(int a, int b) { return a == 0 && b == 0; }

// Median difference of adjacent neighbours along i (da = 1) or j (db = 1).
template <int da, int db>
HWY_INLINE V gradient(const Around& d) {
  V v[18];
  int n = 0;
  for (int b = -reach; b + db <= reach; ++b)
    for (int a = -reach; a + da <= reach; ++a)
      if (!middle(a, b) && !middle(a + da, b + db)) v[n++] = hn::Sub(d.at(a + da, b + db), d.at(a, b));
  return median<18>(v);
}

// Lower quartile of their second differences.
template <int da, int db>
HWY_INLINE V curvature(const Around& d) {
  V v[12];
  int n = 0;
  for (int b = -reach; b + 2 * db <= reach; ++b)
    for (int a = -reach; a + 2 * da <= reach; ++a) {
      if (middle(a, b) || middle(a + da, b + db) || middle(a + 2 * da, b + 2 * db)) continue;
      const V here = d.at(a + da, b + db);
      v[n++] = hn::Abs(hn::Sub(hn::Add(d.at(a, b), d.at(a + 2 * da, b + 2 * db)), hn::Add(here, here)));
    }
  rank<12, 3, 3>(v);
  return v[3];
}

// How far the point is off its levelled neighbours' median, and how far it may be.
HWY_INLINE void deviation(const Around& d, V floor, V& off, V& granted) {
  const V along_i = gradient<1, 0>(d), along_j = gradient<0, 1>(d);
  V v[neighbours_in_all];
  int n = 0;
  for (int b = -reach; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a)
      if (!middle(a, b))
        v[n++] = hn::Sub(d.at(a, b),
                         hn::Add(hn::Mul(along_i, hn::Set(D(), float(a))), hn::Mul(along_j, hn::Set(D(), float(b)))));
  const V centre = median<neighbours_in_all>(v);
  for (V& x : v) x = hn::Abs(hn::Sub(x, centre));
  const V scatter = median<neighbours_in_all>(v);
  off = hn::Abs(hn::Sub(d.at(0, 0), centre));
  granted = hn::Add(hn::Add(scatter, hn::Max(curvature<1, 0>(d), curvature<0, 1>(d))), floor);
}

// Largest distance of the neighbours from the plane through the middle.
HWY_INLINE V roughness(const Around& d) {
  const V half = hn::Set(D(), 0.5f), here = d.at(0, 0);
  const V along_i = hn::Mul(half, hn::Sub(d.at(1, 0), d.at(-1, 0))),
          along_j = hn::Mul(half, hn::Sub(d.at(0, 1), d.at(0, -1)));
  V largest = hn::Zero(D());
  for (int b = -reach; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a) {
      const V plane =
          hn::Add(here, hn::Add(hn::Mul(along_i, hn::Set(D(), float(a))), hn::Mul(along_j, hn::Set(D(), float(b)))));
      largest = hn::Max(largest, hn::Abs(hn::Sub(d.at(a, b), plane)));
    }
  return largest;
}

void test_row(const MedianRow& row) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V floor = hn::Set(d, row.floor), threshold = hn::Set(d, row.threshold);
  const V always = hn::Mul(floor, threshold), square = hn::Mul(threshold, threshold);
  for (int i = reach; i + reach < row.points; i += lanes) {
    const int end = std::min(i + lanes, row.points - reach);
    if (std::none_of(row.whole + i, row.whole + end, [](std::uint8_t w) { return w != 0; })) continue;
    const Around u{row.component[0], i}, v{row.component[1], i};
    // All neighbours within half of what the test grants everywhere about one plane: it cannot fail.
    const V rough = hn::Max(roughness(u), roughness(v));
    HWY_ALIGN float excess[16];
    hn::Store(hn::Sub(rough, hn::Mul(hn::Set(d, 0.5f), always)), d, excess);
    bool smooth = true;
    for (int k = i; k < end; ++k) smooth = smooth && (!row.whole[k] || excess[k - i] <= 0);
    if (!smooth) {
      V off_u, off_v, granted_u, granted_v;
      deviation(u, floor, off_u, granted_u);
      deviation(v, floor, off_v, granted_v);
      const V ru = hn::Div(off_u, granted_u), rv = hn::Div(off_v, granted_v);
      const V relative = hn::Sub(hn::Add(hn::Mul(ru, ru), hn::Mul(rv, rv)), square);
      const V absolute = hn::Sub(hn::Add(hn::Mul(off_u, off_u), hn::Mul(off_v, off_v)), hn::Mul(always, always));
      hn::Store(hn::Min(relative, absolute), d, excess);
    }
    for (int k = i; k < end; ++k)
      if (row.whole[k]) row.passed[k] = excess[k - i] <= 0;
  }
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(test_row);

namespace {

constexpr int most = (2 * reach + 1) * (2 * reach + 1);

// Numbers whose median is wanted; no memory of its own.
struct Sample {
  std::array<float, 2 * most> value;
  int count = 0;
  void add(float v) { value[std::size_t(count++)] = v; }
  float lower_quartile() {
    if (count == 0) return 0;
    const auto quarter = value.begin() + count / 4;
    std::nth_element(value.begin(), quarter, value.begin() + count);
    return *quarter;
  }
  float median() {
    if (count == 0) return 0;
    const auto middle = value.begin() + count / 2;
    std::nth_element(value.begin(), middle, value.begin() + count);
    if (count % 2 == 1) return *middle;
    return 0.5f * (*middle + *std::max_element(value.begin(), middle));
  }
};

struct Neighbours {
  std::array<std::array<float, 2>, most> displacement{};  // 5 x 5 about the point
  std::array<std::uint8_t, most> good{};
  int count = 0;

  Neighbours(const VectorGrid& vectors, int i, int j) {
    for (int b = std::max(-reach, -j); b <= std::min(reach, vectors.ny - 1 - j); ++b)
      for (int a = std::max(-reach, -i); a <= std::min(reach, vectors.nx - 1 - i); ++a) {
        const std::size_t k = std::size_t(j + b) * std::size_t(vectors.nx) + std::size_t(i + a);
        if (!vectors.good[k] || (a == 0 && b == 0)) continue;
        displacement[at(a, b)] = vectors.displacement[k];
        good[at(a, b)] = 1;
        ++count;
      }
  }
  static std::size_t at(int a, int b) { return std::size_t((b + reach) * (2 * reach + 1) + a + reach); }

  // Median difference of adjacent neighbours along i (da = 1) or j (db = 1); 0 where there are too few of them.
  float gradient(std::size_t component, int da, int db) const {
    Sample differences;
    for (int b = -reach; b + db <= reach; ++b)
      for (int a = -reach; a + da <= reach; ++a)
        if (good[at(a, b)] && good[at(a + da, b + db)])
          differences.add(displacement[at(a + da, b + db)][component] - displacement[at(a, b)][component]);
    return differences.count >= 4 ? differences.median() : 0.0f;
  }

  // Lower quartile of the second differences along i or along j: what a cluster of outliers does not reach.
  float curvature(std::size_t component, int da, int db) const {
    Sample differences;
    for (int b = -reach; b + 2 * db <= reach; ++b)
      for (int a = -reach; a + 2 * da <= reach; ++a)
        if (good[at(a, b)] && good[at(a + da, b + db)] && good[at(a + 2 * da, b + 2 * db)])
          differences.add(std::abs(displacement[at(a, b)][component] - 2 * displacement[at(a + da, b + db)][component] +
                                   displacement[at(a + 2 * da, b + 2 * db)][component]));
    return differences.count >= 4 ? differences.lower_quartile() : 0.0f;
  }

  // The neighbours freed of the local gradient.
  Sample levelled(std::size_t component) const {
    const float along_i = gradient(component, 1, 0), along_j = gradient(component, 0, 1);
    Sample level;
    for (int b = -reach; b <= reach; ++b)
      for (int a = -reach; a <= reach; ++a)
        if (good[at(a, b)])
          level.add(displacement[at(a, b)][component] - along_i * static_cast<float>(a) -
                    along_j * static_cast<float>(b));
    return level;
  }

  // How far they scatter about their median, and how far curvature alone lets the middle deviate from it.
  double scatter(Sample& level, float median, std::size_t component) const {
    for (int k = 0; k < level.count; ++k) level.value[std::size_t(k)] = std::abs(level.value[std::size_t(k)] - median);
    return level.median() + std::max(curvature(component, 1, 0), curvature(component, 0, 1));
  }
};

bool passes(const std::array<float, 2>& d, const Neighbours& neighbours, double threshold, double floor_px) {
  Sample level_u = neighbours.levelled(0), level_v = neighbours.levelled(1);
  const float median_u = level_u.median(), median_v = level_v.median();
  const double off_u = std::abs(d[0] - median_u), off_v = std::abs(d[1] - median_v);
  if (std::hypot(off_u, off_v) <= threshold * floor_px) return true;  // whatever the scatter
  return std::hypot(off_u / (neighbours.scatter(level_u, median_u, 0) + floor_px),
                    off_v / (neighbours.scatter(level_v, median_v, 1) + floor_px)) <= threshold;
}

// Of every point, whether all its 24 neighbours are good.
std::vector<std::uint8_t> whole_points(const VectorGrid& vectors) {
  const auto nx = static_cast<std::size_t>(vectors.nx), ny = static_cast<std::size_t>(vectors.ny);
  std::vector<std::uint8_t> along(vectors.good.size(), 0), whole(vectors.good.size(), 0);
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = reach; i + reach < nx; ++i) {
      const std::uint8_t* g = vectors.good.data() + j * nx + i;
      along[j * nx + i] = static_cast<std::uint8_t>(g[-2] + g[-1] + g[0] + g[1] + g[2]);
    }
  for (std::size_t j = reach; j + reach < ny; ++j)
    for (std::size_t i = reach; i + reach < nx; ++i) {
      const std::size_t k = j * nx + i;
      const int all = along[k - 2 * nx] + along[k - nx] + along[k] + along[k + nx] + along[k + 2 * nx];
      whole[k] = all - vectors.good[k] == neighbours_in_all;
    }
  return whole;
}

}  // namespace

void median_test(VectorGrid& vectors, double threshold, double floor_px, int threads) {
  const std::vector<std::uint8_t> candidates = vectors.good;
  const double floor = std::max(floor_px, 1e-6);
  const auto nx = static_cast<std::size_t>(vectors.nx);
  constexpr std::size_t beyond = 16 + reach;  // rows are read a vector's length at a time
  std::vector<float> component[2];
  for (std::size_t c = 0; c < 2; ++c) {
    component[c].assign(candidates.size() + beyond, 0.0f);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (candidates[k]) component[c][k] = vectors.displacement[k][c];
  }
  std::vector<std::uint8_t> passed = candidates;
  for (int round = 0; round < 2; ++round) {
    const std::vector<std::uint8_t> whole = whole_points(vectors);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int j = 0; j < vectors.ny; ++j) {
      const std::size_t start = std::size_t(j) * nx;
      if (j >= reach && j + reach < vectors.ny) {
        MedianRow row{{}, whole.data() + start, vectors.nx, float(threshold), float(floor), passed.data() + start};
        for (std::size_t c = 0; c < 2; ++c)
          for (int b = -reach; b <= reach; ++b)
            row.component[c][b + reach] = component[c].data() + std::ptrdiff_t(start) + b * std::ptrdiff_t(nx);
        HWY_DYNAMIC_DISPATCH(test_row)(row);
      }
      for (int i = 0; i < vectors.nx; ++i) {
        const std::size_t k = start + std::size_t(i);
        if (!candidates[k]) {
          passed[k] = 0;
        } else if (!whole[k]) {
          const Neighbours neighbours(vectors, i, j);
          passed[k] = neighbours.count < 3 || passes(vectors.displacement[k], neighbours, threshold, floor);
        }
      }
    }
    vectors.good = passed;
    if (passed == candidates) return;
  }
}

}  // namespace pivnp::piv
#endif

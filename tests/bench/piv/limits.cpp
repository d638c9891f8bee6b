#include "tests/bench/piv/limits.hpp"

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/piv/limits.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pivnp::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void Triad(float* a, const float* b, const float* c, std::size_t n) {
  const hn::CappedTag<float, 16> d;
  const auto s = hn::Set(d, 0.5f);
  for (std::size_t i = 0; i + hn::Lanes(d) <= n; i += hn::Lanes(d))
    hn::StoreU(hn::MulAdd(s, hn::LoadU(d, c + i), hn::LoadU(d, b + i)), d, a + i);
}

// Sixteen chains hide the latency; returns something that depends on all of them. Operations done: out.
float Chains(std::size_t rounds, double& operations) {
  const hn::CappedTag<float, 16> d;
  const auto x = hn::Set(d, 0.999f), y = hn::Set(d, 0.001f);
  const auto start = [d](float k) { return hn::Set(d, 0.01f * k); };  // all different: equal chains would be merged
  auto v0 = start(1), v1 = start(2), v2 = start(3), v3 = start(4), v4 = start(5), v5 = start(6), v6 = start(7);
  auto v7 = start(8), w0 = start(9), w1 = start(10), w2 = start(11), w3 = start(12), w4 = start(13), w5 = start(14);
  auto w6 = start(15), w7 = start(16);
  for (std::size_t r = 0; r < rounds; ++r) {
    v0 = hn::MulAdd(v0, x, y), v1 = hn::MulAdd(v1, x, y), v2 = hn::MulAdd(v2, x, y), v3 = hn::MulAdd(v3, x, y);
    v4 = hn::MulAdd(v4, x, y), v5 = hn::MulAdd(v5, x, y), v6 = hn::MulAdd(v6, x, y), v7 = hn::MulAdd(v7, x, y);
    w0 = hn::MulAdd(w0, x, y), w1 = hn::MulAdd(w1, x, y), w2 = hn::MulAdd(w2, x, y), w3 = hn::MulAdd(w3, x, y);
    w4 = hn::MulAdd(w4, x, y), w5 = hn::MulAdd(w5, x, y), w6 = hn::MulAdd(w6, x, y), w7 = hn::MulAdd(w7, x, y);
  }
  operations = 2.0 * 16 * static_cast<double>(hn::Lanes(d)) * static_cast<double>(rounds);
  const auto v = hn::Add(hn::Add(hn::Add(v0, v1), hn::Add(v2, v3)), hn::Add(hn::Add(v4, v5), hn::Add(v6, v7)));
  const auto w = hn::Add(hn::Add(hn::Add(w0, w1), hn::Add(w2, w3)), hn::Add(hn::Add(w4, w5), hn::Add(w6, w7)));
  return hn::GetLane(hn::Add(v, w));
}

}  // namespace pivnp::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::bench {

HWY_EXPORT(Triad);
HWY_EXPORT(Chains);

namespace {

// Alone, the thread's own time: other work on the machine does not count.
double now(int threads) {
  timespec t{};
  ::clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

double triad_bandwidth(int threads) {
  constexpr std::size_t count = std::size_t(16) << 20;
  std::vector<float> a(count), b(count, 1.0f), c(count, 2.0f);
  double best = 0;
  for (int n = 0; n < 5; ++n) {
    const double start = now(threads);
#pragma omp parallel num_threads(threads)
    {
      const std::size_t share = count / std::size_t(omp_get_num_threads()),
                        from = share * std::size_t(omp_get_thread_num());
      HWY_DYNAMIC_DISPATCH(Triad)(a.data() + from, b.data() + from, c.data() + from, share);
    }
    best = std::max(best, 3.0 * sizeof(float) * count / (now(threads) - start));
  }
  return best;
}

double multiply_add_peak(int threads) {
  double best = 0;
  volatile float kept = 0;
  for (int n = 0; n < 5; ++n) {
    double operations = 0;
    const double start = now(threads);
#pragma omp parallel num_threads(threads) reduction(+ : operations)
    {
      double mine = 0;
      kept = HWY_DYNAMIC_DISPATCH(Chains)(2000000, mine);
      operations += mine;
    }
    best = std::max(best, operations / (now(threads) - start));
  }
  static_cast<void>(kept);
  return best;
}

}  // namespace pivnp::bench
#endif

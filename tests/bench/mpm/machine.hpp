// What one thread of this machine can do: memory traffic and floating-point operations.
#pragma once

#include <chrono>
#include <cstddef>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

namespace pivnp::bench {

inline std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

inline double cpu_s() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// GB/s read and written by an update in place of arrays that are `bytes` long together.
inline double update_rate(std::size_t bytes) {
  std::vector<double> a(bytes / sizeof(double), 1.0);
  double moved = 0;
  const double start = cpu_s();
  while (cpu_s() - start < 0.2) {
    for (double& v : a) v = 0.999 * v + 1e-3;
    moved += 2 * double(bytes);
  }
  return moved / (cpu_s() - start) / 1e9;
}

#if defined(__x86_64__) && defined(__GNUC__)
typedef double Four __attribute__((vector_size(32)));
__attribute__((target("avx2,fma"), optimize("fp-contract=fast"))) inline double multiply_add(long n) {
  Four a[10];
  for (int k = 0; k < 10; ++k) a[k] = Four{1.0 + k, 1, 1, 1};
  const Four m{0.999, 0.999, 0.999, 0.999}, c{1e-3, 1e-3, 1e-3, 1e-3};
  for (long i = 0; i < n; ++i)
    for (Four& v : a) v = v * m + c;
  double sum = 0;
  for (const Four& v : a) sum += v[0];
  return sum;
}
#endif

/// GFlop/s in double precision with four lanes (multiply and add count one each); 0 where it cannot be measured.
inline double flop_rate() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return 0;
  constexpr long n = 20'000'000;
  const double start = cpu_s();
  volatile double keep = multiply_add(n);
  (void)keep;
  return double(n) * 10 * 4 * 2 / (cpu_s() - start) / 1e9;
#else
  return 0;
#endif
}

}  // namespace pivnp::bench

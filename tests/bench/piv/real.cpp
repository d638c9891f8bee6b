// The same figures as the tests of real images, for every setting.
#include <cstdio>

#include "pivnp/core/error.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/support/piv_real.hpp"

namespace pivnp::bench {

int real(const BenchOptions& options) {
  const char* folder = std::getenv("PIVNP_TEST_DATA");
  if (folder == nullptr || !std::filesystem::is_directory(folder))
    throw InputError("PIVNP_TEST_DATA: found no folder, expected that of the test images");
  std::printf("machine: %s\nthreads %d\n\n", machine().c_str(), options.threads);
  bool met = true;
  for (const Setting& setting : options.settings) {
    std::printf("%s\n%-52s %10s %12s\n", setting.name.c_str(), "real and published images", "figure", "asked");
    int asked = 0, reached = 0;
    for (const piv::RealSet set : piv::real_sets)
      for (const piv::RealFigure& f : set(folder, setting.options, options.threads)) {
        std::printf("%-52s %10.5f %3s %8g  %s\n", f.name.c_str(), f.value, f.at_least ? ">=" : "<=", f.limit,
                    f.met() ? "ok" : "MISS");
        std::fflush(stdout);
        ++asked, reached += f.met();
      }
    std::printf("%s: %d of %d figures reached\n\n", setting.name.c_str(), reached, asked);
    met = met && (reached == asked || setting.options.method != "default");
  }
  return met ? 0 : 3;
}

}  // namespace pivnp::bench

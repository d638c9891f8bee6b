#include "pivnp/piv/methods.hpp"

#include "pivnp/piv/gauss_newton.hpp"
#include "pivnp/piv/multipass.hpp"

namespace pivnp::piv {

namespace {

template <int finest>
std::unique_ptr<Method> gauss_newton(const PivOptions& options, const Extent& extent, int threads) {
  return make_gauss_newton(options, extent, threads, finest);
}

template <Search last_window>
std::unique_ptr<Method> windows(const PivOptions& options, const Extent& extent, int threads) {
  return make_multipass(options, extent, threads, last_window);
}

}  // namespace

Registry<PivMethod>& piv_methods() {
  static Registry<PivMethod> methods = {
      {.name = "default",
       .text = "the recommended method, at present gn",
       .family = MethodFamily::gauss_newton,
       .make = &gauss_newton<1>},
      {.name = "gn",
       .text = "dense Gauss-Newton: nearly always",
       .family = MethodFamily::gauss_newton,
       .make = &gauss_newton<1>},
      {.name = "fast",
       .text = "gn at half the resolution: a first look, long videos",
       .family = MethodFamily::gauss_newton,
       .finest = 2,
       .make = &gauss_newton<2>},
      {.name = "fft",
       .text = "windows searched by FFT: thin layers over a fixed base, comparison with other PIV programs",
       .family = MethodFamily::window_search,
       .make = &windows<Search::far>},
      {.name = "ncc",
       .text = "as fft, the last window only about what the larger ones found",
       .family = MethodFamily::window_refinement,
       .make = &windows<Search::near>},
  };
  return methods;
}

std::vector<std::string> piv_method_names() { return piv_methods().names(); }

}  // namespace pivnp::piv

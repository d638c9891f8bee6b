// The default's costly stages, each by itself at full resolution, against the machine's roofline: operations counted
// from the code (a multiply-add is two, a division one), bytes as each pixel's compulsory traffic with memory (what a
// stage reads and writes once; what caches hold between sweeps is not counted). Per vector: nodes 8 px apart, 64 pixels
// each.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <vector>

#include "pivnp/image/synthetic_pair.hpp"
#include "pivnp/piv/normal_sums.hpp"
#include "pivnp/piv/shrink.hpp"
#include "pivnp/piv/spline_field.hpp"
#include "pivnp/piv/spline_image.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/bench/piv/limits.hpp"

namespace pivnp::bench {

namespace {

using namespace pivnp::piv;

struct Stage {
  const char* name;
  double flops, bytes;  // a vector
  std::function<void()> work;
};

constexpr double pixels = 64;  // a vector

// One axis of the quintic spline's weights: two end taps 9, four others 11 each.
constexpr double axis_weights = 9 + 4 * 11;
// One frame's warp: place and fraction 8, weights, six by six taps.
constexpr double warp_flops = 8 + 2 * axis_weights + 6 * (1 + 5 * 2) + 6 * 2;
// Prefilter of one frame: grey value, an axis: three-point sum 4, two poles forth and back 4 each.
constexpr double prefilter_flops = 1 + 2 * (4 + 2 * 4);
// Field 18, mean and difference 3, gradients 10, robust weight 9, products 9, eight sums above and below 32, their
// rows 3.
constexpr double sums_flops = 18 + 3 + 10 + 9 + 9 + 32 + 3;
// Shrinkage, a lattice point and component: blocks of 8, 16, 32 at half overlap (each point in four blocks of a size):
// transform there and back 8 n, about 75 beside.
constexpr double shrink_flops = 4 * (8 * (8 + 16 + 32) + 3 * 75);

}  // namespace

int stages(const BenchOptions& options) {
  options.print_head();
  const double bandwidth = triad_bandwidth(options.threads), peak = multiply_add_peak(options.threads);
  std::printf("machine's limits on %d threads: triad %.1f GB/s, fused multiply-adds %.0f GFlop/s; %s\n\n",
              options.threads, 1e-9 * bandwidth, 1e-9 * peak, simd_target());

  image::TextureOptions texture = options.texture;
  texture.seed = options.seeds[0], texture.noise = 0.05;
  const image::Motion motion = image::sine(1, 64);
  const image::SyntheticPair pair = image::synthetic_pair(motion, options.side, options.side, texture);
  const ImageView first_view = pair.first.view(), second_view = pair.second.view();
  SplineImage first, second;
  first.assign(first_view, {}, 1, options.threads);
  second.assign(second_view, {}, 1, options.threads);
  const int points = options.side / 8 - 1;
  const CellLattice lattice{points, points, 4, 4, 8};
  std::vector<float> u, v;
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i) {
      const Vec2 d = motion(Vec2(lattice.x0 + 8 * i, lattice.y0 + 8 * j));
      u.push_back(static_cast<float>(d.x())), v.push_back(static_cast<float>(d.y()));
    }
  SplineField field;
  field.interpolate(lattice, u, v);
  const std::vector<float> noise(lattice.size(), 500.0f), tolerance(lattice.size(), 0.01f);
  SumsInput input;
  input.first = &first, input.second = &second, input.field = &field;
  CellSums sums;
  const Shrinker shrinker(lattice);
  SmoothedField smooth;

  const std::vector<Stage> list = {
      {"spline coefficients, one frame", pixels * prefilter_flops,
       pixels * (first_view.depth == PixelDepth::u8 ? 21 : 22),
       [&] { first.assign(first_view, {}, 1, options.threads); }},
      {"warp and sums, a pass", pixels * (2 * warp_flops + sums_flops - 9), pixels * 8,
       [&] { input.noise = input.tolerance = nullptr, accumulate_sums(input, options.threads, sums); }},
      {"the same, robust weights", pixels * (2 * warp_flops + sums_flops), pixels * 8,
       [&] { input.noise = &noise, input.tolerance = &tolerance, accumulate_sums(input, options.threads, sums); }},
      {"shrinkage, both components", 2 * shrink_flops, 2 * 16, [&] {
         shrinker.run(u, {}, options.threads, smooth);
         shrinker.run(v, {}, options.threads, smooth);
       }}};
  std::printf("%-32s %10s %12s %12s %9s %8s %9s %9s\n", "stage", "us/vector", "flops/vector", "bytes/vector", "GFlop/s",
              "GB/s", "bound by", "of bound");
  for (const Stage& stage : list) {
    std::vector<double> seconds;
    for (int n = 0; n < 2 * options.repeats + 1; ++n) {
      const double start = now(options);
      stage.work();
      if (n > 0) seconds.push_back((now(options) - start) / static_cast<double>(lattice.size()));
    }
    std::sort(seconds.begin(), seconds.end());
    const double time = seconds[seconds.size() / 2], compute = stage.flops / peak, memory = stage.bytes / bandwidth;
    std::printf("%-32s %10.3f %12.0f %12.0f %9.1f %8.2f %9s %8.0f %%\n", stage.name, 1e6 * time, stage.flops,
                stage.bytes, 1e-9 * stage.flops / time, 1e-9 * stage.bytes / time,
                compute > memory ? "compute" : "memory", 100 * std::max(compute, memory) / time);
  }
  return 0;
}

}  // namespace pivnp::bench

// The costly stages of every method, each by itself, against the machine's roofline: operations counted from the code
// (a multiply-add is two, a division one; only pixels that count, not what fills up vectors), bytes as each pixel's
// compulsory traffic with memory (what a stage reads and writes once; what caches hold between sweeps or overlapping
// windows is not counted). Per vector: nodes 8 px apart, 64 pixels each.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "pivnp/piv/dense/normal_sums.hpp"
#include "pivnp/piv/dense/shrink.hpp"
#include "pivnp/piv/dense/spline_field.hpp"
#include "pivnp/piv/methods.hpp"
#include "pivnp/piv/sampling/spline_image.hpp"
#include "pivnp/piv/window/correlate.hpp"
#include "pivnp/piv/window/uncertainty.hpp"
#include "pivnp/piv/window/warp.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/bench/piv/limits.hpp"

namespace pivnp::bench {

namespace {

using namespace pivnp::piv;

struct Stage {
  std::string name;
  double flops, bytes;  // a vector; flops NaN: not ours to count
  std::function<void()> work;
};

// What the stages work on; made once, kept while they run.
struct Scene {
  image::SyntheticPair pair;
  image::Motion motion;
  int threads;
  double vectors;  // nodes 8 px apart
  ImageView first_view() const { return pair.first.view(); }
  ImageView second_view() const { return pair.second.view(); }
  double grey_bytes() const { return pair.first.view().depth == PixelDepth::u8 ? 1 : 2; }
};

constexpr double node_pixels = 64;

// One axis of the quintic spline's weights: two end taps 9, four others 11 each.
constexpr double axis_weights = 9 + 4 * 11;
// One frame's warp: place and fraction 8, weights, six by six taps.
constexpr double warp_flops = 8 + 2 * axis_weights + 6 * (1 + 5 * 2) + 6 * 2;
// Prefilter of one frame: grey value, an axis: three-point sum 4, two poles forth and back 4 each.
constexpr double prefilter_flops = 1 + 2 * (4 + 2 * 4);
// Field 18, mean and difference 3, gradients 10, robust weight 9, products 9, eight sums above and below 32, their
// rows 3.
constexpr double sums_flops = 18 + 3 + 10 + 9 + 9 + 32 + 3;
// Shrinkage, a lattice point and component: blocks of 8, 16, 32, 64 at half overlap (each point in four blocks of a
// size): transform there and back 8 n, about 75 beside.
constexpr double shrink_flops = 4 * (8 * (8 + 16 + 32 + 64) + 4 * 75);

// gn on frames averaged over blocks of `decimation` pixels: the default's finest level, fast's.
struct Dense {
  SplineImage first, second;
  CellLattice lattice;
  std::vector<float> u, v, noise, tolerance;
  SplineField field;
  SumsInput input;
  CellSums sums;
  std::unique_ptr<Shrinker> shrinker;
  SmoothedField smooth;
};

std::vector<Stage> dense_stages(const Scene& scene, int decimation) {
  const auto d = std::make_shared<Dense>();
  const int threads = scene.threads;
  d->first.assign(scene.first_view(), {}, decimation, threads);
  d->second.assign(scene.second_view(), {}, decimation, threads);
  const int points = d->first.width() / 8 - 1;
  d->lattice = {points, points, 4, 4, 8};
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i) {
      const Vec2 moved = scene.motion(decimation * Vec2(d->lattice.x0 + 8 * i, d->lattice.y0 + 8 * j)) / decimation;
      d->u.push_back(static_cast<float>(moved.x())), d->v.push_back(static_cast<float>(moved.y()));
    }
  d->field.interpolate(d->lattice, d->u, d->v, 1);
  d->noise.assign(d->lattice.size(), 500.0f), d->tolerance.assign(d->lattice.size(), 0.01f);
  d->input.first = &d->first, d->input.second = &d->second, d->input.field = &d->field;
  d->shrinker = std::make_unique<Shrinker>(d->lattice);
  const double pixels = node_pixels / (decimation * decimation), share = 1.0 / (decimation * decimation);
  const double read = node_pixels * scene.grey_bytes();
  return {
      {"spline coefficients, one frame", pixels * prefilter_flops + (decimation > 1 ? node_pixels : 0),
       read + pixels * 20,
       [d, &scene, decimation] { d->first.assign(scene.first_view(), {}, decimation, scene.threads); }},
      {"warp and sums, a pass", pixels * (2 * warp_flops + sums_flops - 9), pixels * 8,
       [d, threads] { d->input.noise = d->input.tolerance = nullptr, accumulate_sums(d->input, threads, d->sums); }},
      {"the same, robust weights", pixels * (2 * warp_flops + sums_flops), pixels * 8,
       [d, threads] {
         d->input.noise = &d->noise, d->input.tolerance = &d->tolerance;
         accumulate_sums(d->input, threads, d->sums);
       }},
      {"shrinkage, both components", share * 2 * shrink_flops, share * 2 * 16, [d, threads] {
         d->shrinker->run(d->u, {}, threads, d->smooth);
         d->shrinker->run(d->v, {}, threads, d->smooth);
       }}};
}

// Windows of the last size at the nodes.
struct Windows {
  Level level;
  PredictorField predictor;
  WarpedPair warped;
  Window window;
  NearCorrelator near;
  Window search_window;
  FftCorrelator fft;
  UncertaintyEstimator uncertainty;
  Peak peak, found[FftCorrelator::batch];
  Windows(int support, int search)
      : window(support), near(support), search_window(search), fft(search), uncertainty(support) {}
};

std::vector<Stage> window_stages(const Scene& scene, const PivOptions& options, MethodFamily family) {
  const int support = support_of_window(options.window_px), search = options.window_px, threads = scene.threads;
  const auto w = std::make_shared<Windows>(support, search);
  w->level.first.assign(scene.first_view(), {}, 1, threads);
  w->level.second.assign(scene.second_view(), {}, 1, threads);
  const int width = scene.pair.width, height = scene.pair.height, points = width / 8 - 1;
  const EvenLattice lattice{points, points, 7.5f, 7.5f, 8, 8};
  std::vector<std::array<float, 2>> vectors;
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i) {
      const Vec2 moved = scene.motion(Vec2(7.5 + 8 * i, 7.5 + 8 * j));
      vectors.push_back({static_cast<float>(moved.x()), static_cast<float>(moved.y())});
    }
  const std::vector<std::uint8_t> good(vectors.size(), 1);
  w->predictor.fit(lattice, vectors, good, 0.5f, threads);
  const auto warp = [w, width, height, threads] {
    warp_pair(w->level, w->predictor, Anchor::central, {0, 0, width, height}, threads, w->warped);
  };
  warp();
  w->window.cut(w->warped, 0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height));
  w->peak = w->near.find(w->window);
  const double area = double(support) * support, planes = node_pixels * 8;
  const auto at_nodes = [w, points](const std::function<void(float, float)>& work) {
    return [points, work, w] {
      for (int j = 0; j < points; ++j)
        for (int i = 0; i < points; ++i) work(7.5f + 8.0f * static_cast<float>(i), 7.5f + 8.0f * static_cast<float>(j));
    };
  };
  // Means 4, window and energies 9. Lags 9 by 2. Products 6, slopes 8, sums over five by five 16, their products 6.
  std::vector<Stage> list = {
      {"spline coefficients, one frame", node_pixels * prefilter_flops, node_pixels * (scene.grey_bytes() + 20),
       [w, &scene] { w->level.first.assign(scene.first_view(), {}, 1, scene.threads); }},
      {"warp of both frames, a pass", node_pixels * (2 * warp_flops + 14 + 12), node_pixels * (8 + 12), warp},
      {"windows cut, a pass", area * 13, planes, at_nodes([w](float x, float y) { w->window.cut(w->warped, x, y); })},
      {"nine lags summed, a pass", area * 18, 0, at_nodes([w](float, float) { w->peak = w->near.find(w->window); })},
      {"covariance, last pass", area * 36, 0,
       at_nodes([w](float, float) { w->uncertainty.covariance(w->window, w->peak, 1.0f / 12); })}};
  // Two transforms forth, one back, 2.5 n log2 n each; a quarter of the nodes.
  const double n = double(search) * search;
  if (family == MethodFamily::window_search)
    list.push_back({"search by FFT, half the windows a side", (3 * 2.5 * n * std::log2(n) + 3 * n + 13 * n) / 4,
                    planes / 4, [w, points] {
                      constexpr int batch = FftCorrelator::batch;
                      int put = 0;
                      for (int j = 0; j < points; j += 2)
                        for (int i = 0; i < points; i += 2) {
                          w->search_window.cut(w->warped, 7.5f + 8.0f * static_cast<float>(i),
                                               7.5f + 8.0f * static_cast<float>(j), false);
                          w->fft.put(put++, w->search_window);
                          if (put == batch) w->fft.find(put, w->found), put = 0;
                        }
                      if (put > 0) w->fft.find(put, w->found);
                    }});
  return list;
}

// Everything, as it is called: what the stages above leave is the coarse levels, fields between passes, validation.
Stage whole_pair(const Scene& scene, const PivOptions& options) {
  const int points = scene.pair.width / 8 - 1;
  NodeLattice nodes{points, points, {}, {}};
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i)
      nodes.pixel.push_back({7.5f + 8 * static_cast<float>(i), 7.5f + 8 * static_cast<float>(j)});
  const auto correlator =
      std::make_shared<PairCorrelator>(options, nodes, scene.pair.width, scene.pair.height, scene.threads);
  return {"whole pair", NAN, 2 * node_pixels * scene.grey_bytes(),
          [correlator, &scene] { correlator->correlate(scene.first_view(), scene.second_view(), {}); }};
}

void print_stage(const Stage& stage, const BenchOptions& options, double vectors, double bandwidth, double peak) {
  std::vector<double> seconds;
  for (int n = 0; n < 2 * options.repeats + 1; ++n) {
    const double start = now(options);
    stage.work();
    if (n > 0) seconds.push_back((now(options) - start) / vectors);
  }
  std::sort(seconds.begin(), seconds.end());
  const double time = seconds[seconds.size() / 2], memory = stage.bytes / bandwidth;
  if (std::isnan(stage.flops)) {
    std::printf("%-40s %10.3f %12s %12.0f %9s %8.2f\n", stage.name.c_str(), 1e6 * time, "", stage.bytes, "",
                1e-9 * stage.bytes / time);
    return;
  }
  const double compute = stage.flops / peak;
  std::printf("%-40s %10.3f %12.0f %12.0f %9.1f %8.2f %9s %8.0f %%\n", stage.name.c_str(), 1e6 * time, stage.flops,
              stage.bytes, 1e-9 * stage.flops / time, 1e-9 * stage.bytes / time,
              compute > memory ? "compute" : "memory", 100 * std::max(compute, memory) / time);
}

}  // namespace

int stages(const BenchOptions& options) {
  options.print_head();
  const double bandwidth = triad_bandwidth(options.threads), peak = multiply_add_peak(options.threads);
  std::printf("machine's limits on %d threads: triad %.1f GB/s, fused multiply-adds %.0f GFlop/s; %s\n",
              options.threads, 1e-9 * bandwidth, 1e-9 * peak, simd_target());
  image::TextureOptions texture = options.texture;
  texture.seed = options.seeds[0], texture.noise = 0.05;
  const image::Motion motion = image::sine(1, 64);
  const int points = options.side / 8 - 1;
  const Scene scene{image::synthetic_pair(motion, options.side, options.side, texture), motion, options.threads,
                    double(points) * points};
  for (const Setting& setting : options.settings) {
    std::printf("\n%-40s %10s %12s %12s %9s %8s %9s %9s\n", setting.name.c_str(), "us/vector", "flops/vector",
                "bytes/vector", "GFlop/s", "GB/s", "bound by", "of bound");
    const PivMethod& method = piv_methods().at(setting.options.method, "--method");
    std::vector<Stage> list;
    if (method.family == MethodFamily::window_search || method.family == MethodFamily::window_refinement)
      list = window_stages(scene, setting.options, method.family);
    else if (method.family != MethodFamily::other)
      list = dense_stages(scene, method.finest);
    list.push_back(whole_pair(scene, setting.options));
    for (const Stage& stage : list) print_stage(stage, options, scene.vectors, bandwidth, peak);
  }
  return 0;
}

}  // namespace pivnp::bench

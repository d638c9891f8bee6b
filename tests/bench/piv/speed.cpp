// Speed beyond the table: threads, masks, sizes and memory, instruction sets, real 12-megapixel pairs, the machine.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "pivnp/piv/dense/normal_sums.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/bench/piv/limits.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/support/piv_score.hpp"

namespace pivnp::bench {

namespace {

using namespace pivnp::piv;

struct Timed {
  double seconds = 0;
  PixelVectors found;
};

Timed timed(const BenchOptions& options, const PivOptions& piv, const NodeLattice& nodes,
            const image::SyntheticPair& pair, int threads, int repeats, const MaskView& mask = {}) {
  PairCorrelator correlator(piv, nodes, pair.width, pair.height, threads);
  Timed t;
  std::vector<double> seconds;
  for (int n = 0; n < repeats + (repeats > 1); ++n) {
    const double start = threads == 1 ? now(options) : seconds_since({});
    t.found = correlator.correlate(pair.first.view(), pair.second.view(), mask);
    if (n > 0 || repeats == 1) seconds.push_back((threads == 1 ? now(options) : seconds_since({})) - start);
  }
  std::sort(seconds.begin(), seconds.end());
  t.seconds = seconds[seconds.size() / 2];
  return t;
}

image::SyntheticPair pair_of(int side, const image::TextureOptions& base, int seed, double noise,
                             image::Motion motion) {
  image::TextureOptions texture = base;
  texture.seed = seed, texture.noise = noise;
  return image::synthetic_pair(std::move(motion), side, side, texture);
}

void threads_and_masks(const BenchOptions& o, const Setting& setting) {
  const image::SyntheticPair pair = pair_of(o.side, o.texture, o.seeds[0], 0.05, image::sine(1, 64));
  const NodeLattice nodes = even_nodes(o.side, o.side, o.spacing, o.margin);
  const auto rate = [&](double seconds) { return static_cast<double>(nodes.pixel.size()) / seconds; };
  const double one = timed(o, setting.options, nodes, pair, 1, o.repeats).seconds;
  const double two = timed(o, setting.options, nodes, pair, 2, o.repeats).seconds;
  std::printf("  one thread %.0f vectors/s, two %.0f: %.2f times (asked of the default: 1.8)\n", rate(one), rate(two),
              one / two);
  std::vector<std::uint8_t> use(std::size_t(o.side) * std::size_t(o.side), 1);
  for (int r = 0; r < o.side; ++r) std::fill_n(use.begin() + std::ptrdiff_t(r) * o.side, o.side / 2, 0);
  const double half =
      timed(o, setting.options, nodes, pair, 1, o.repeats, {use.data(), o.side, o.side, o.side}).seconds;
  std::printf("  half of the scene masked: %.0f %% of the time (asked: 60)\n", 100 * half / one);
  NodeLattice corners = nodes;
  corners.on.assign(nodes.pixel.size(), 0);
  corners.on.front() = corners.on.back() = 1;
  std::printf("  two opposite corners' nodes alone: %.0f %% of the time (asked of the default: 75)\n",
              100 * timed(o, setting.options, corners, pair, 1, o.repeats).seconds / one);
  const image::SyntheticPair still = pair_of(o.side, o.texture, o.seeds[0], 0, image::uniform(0, 0));
  std::printf("  a still scene: %.0f %% of the time\n",
              100 * timed(o, setting.options, nodes, still, 1, o.repeats).seconds / one);
}

// Most memory resident since the last reset, MiB; 0 where the system does not say.
double peak_memory(bool reset) {
  if (reset) std::ofstream("/proc/self/clear_refs") << "5" << std::flush;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::atof(line.c_str() + 6) / 1024;
  return 0;
}

void sizes(const BenchOptions& o, const Setting& setting) {
  std::printf("  size Mpx  spacing px    vectors   us/vector  peak memory MiB (asked at 25 Mpx: 1536)\n");
  for (const int side : {512, 1024, 2048, 3464, 5000}) {
    const image::SyntheticPair pair = pair_of(side, o.texture, o.seeds[0], 0.05, image::sine(1, 64));
    const NodeLattice nodes = even_nodes(side, side, o.spacing, o.margin);
    peak_memory(true);
    const double seconds = timed(o, setting.options, nodes, pair, o.threads, side < 2000 ? o.repeats : 1).seconds;
    std::printf("  %8.2f  %10d %10zu  %10.2f  %15.0f\n", 1e-6 * side * side, o.spacing, nodes.pixel.size(),
                1e6 * seconds / static_cast<double>(nodes.pixel.size()), peak_memory(false));
    std::fflush(stdout);
  }
}

void instruction_sets(const BenchOptions& o, const Setting& setting) {
  const image::SyntheticPair pair = pair_of(o.side, o.texture, o.seeds[0], 0.05, image::sine(1, 64));
  const NodeLattice nodes = even_nodes(o.side, o.side, o.spacing, o.margin);
  const Timed best = timed(o, setting.options, nodes, pair, 1, o.repeats);
  for (const std::int64_t set : test::instruction_sets()) {
    test::choose_instruction_set(set);
    const Timed t = timed(o, setting.options, nodes, pair, 1, o.repeats);
    double off = 0;
    for (std::size_t k = 0; k < t.found.status.size(); ++k)
      if (t.found.status[k] == VectorStatus::valid && best.found.status[k] == VectorStatus::valid)
        for (std::size_t c = 0; c < 2; ++c)
          off = std::max(off, std::abs(double(t.found.displacement[k][c]) - double(best.found.displacement[k][c])));
    std::printf(
        "  %-8s %.2f of the best set's speed (asked of the baseline: .25), vectors within %.1e px (asked: 1e-5)\n",
        simd_target(), best.seconds / t.seconds, off);
  }
  test::choose_best_instruction_set();
}

// Clay past a cylinder, nodes 16 px apart, the next frame decoded while a pair is measured.
void real_pairs(const Setting& setting) {
  const char* folder = std::getenv("PIVNP_TEST_DATA");
  if (folder == nullptr || !std::filesystem::exists(std::filesystem::path(folder) / "tbar")) {
    std::printf("  12-megapixel pairs: not measured, PIVNP_TEST_DATA names no folder with tbar in it\n");
    return;
  }
  const auto source = image::prefetched(image::open_frames({.path = "tbar/*.jpg"}, folder));
  const int width = source->width(), height = source->height();
  std::vector<std::uint8_t> use(std::size_t(width) * std::size_t(height), 1);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      if (std::hypot(c - 1915, r - 1490) < 420) use[std::size_t(r) * std::size_t(width) + std::size_t(c)] = 0;
  const NodeLattice nodes = even_nodes(width, height, 16, 32);
  PairCorrelator correlator(setting.options, nodes, width, height, 2);
  constexpr int pairs = 4;
  Image before = source->read(0);
  const auto start = std::chrono::steady_clock::now();
  double measuring = 0;
  for (int k = 0; k < pairs; ++k) {
    Image after = source->read(k + 1);
    const auto from = std::chrono::steady_clock::now();
    correlator.correlate(before.view(), after.view(), {use.data(), width, height, width});
    measuring += seconds_since(from);
    before = std::move(after);
  }
  std::printf(
      "  12-megapixel pairs at 16 px, %zu nodes, two threads: %.2f s a pair with decoding, %.2f s without (asked of "
      "the default: 1.5)\n",
      nodes.pixel.size(), seconds_since(start) / pairs, measuring / pairs);
}

}  // namespace

int speed(const BenchOptions& options) {
  options.print_head();
  std::printf(
      "machine's limits: triad %.1f GB/s on one thread, %.1f on two; fused multiply-adds %.0f GFlop/s single "
      "precision on one, %.0f on two\n\n",
      1e-9 * triad_bandwidth(1), 1e-9 * triad_bandwidth(2), 1e-9 * multiply_add_peak(1), 1e-9 * multiply_add_peak(2));
  for (const Setting& setting : options.settings) {
    std::printf("%s\n", setting.name.c_str());
    threads_and_masks(options, setting);
    instruction_sets(options, setting);
    sizes(options, setting);
    real_pairs(setting);
    std::printf("\n");
  }
  return 0;
}

}  // namespace pivnp::bench

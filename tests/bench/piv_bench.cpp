// Table of accuracy and speed of the PIV methods on synthetic pairs of known displacement.
// Usage: piv_bench [side px = 1024] [spacing px = 8] [threads = 1] [seed = 1] [window px = 32] [anchor = central]
//                  [passes = 0]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/unit/piv/scene.hpp"

namespace {

using namespace pivnp;
using namespace pivnp::piv;

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

struct Row {
  const char* name;
  Motion motion;
  double noise = 0, loss = 0;
  std::function<bool(const Vec2&)> scored;
  double amplitude = 0;  // of a sine: the recovered share is printed
};

// Recovered share of a field: regression of what was found on the truth, over valid vectors.
double gain(const Scene& scene, const NodeLattice& nodes, const PixelVectors& found) {
  double cross = 0, square = 0;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (found.status[k] != VectorStatus::valid) continue;
    const double t = scene.truth(Vec2(nodes.pixel[k][0], nodes.pixel[k][1]), found.anchor == Anchor::central).x();
    cross += t * found.displacement[k][0], square += t * t;
  }
  return cross / square;
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  const int side = number(1, 1024), spacing = number(2, 8), threads = number(3, 1), seed = number(4, 1);
  PivOptions options;
  options.window_px = number(5, 32);
  if (argc > 6) options.anchor = argv[6];
  options.passes = number(7, 0);
  const double middle = 0.5 * (side - 1);
  const auto strips = [](const Vec2& p) {  // about the middles of the triangle wave's slopes, at 64 px, 192 px ...
    return std::abs(p.y() - 64 - 128 * std::round((p.y() - 64) / 128)) < 24;
  };
  const std::vector<Row> rows = {
      {"uniform 0.0", uniform(0.0, 0), 0, 0, {}},
      {"uniform 0.1", uniform(0.1, 0), 0, 0, {}},
      {"uniform 0.3", uniform(0.3, 0), 0, 0, {}},
      {"uniform 0.5", uniform(0.5, 0), 0, 0, {}},
      {"uniform 0.8", uniform(0.8, 0), 0, 0, {}},
      {"rotation 1 deg", rotation(1, middle, middle), 0, 0, {}},
      {"rotation 3 deg", rotation(3, middle, middle), 0, 0, {}},
      {"shear 10 %", triangle_shear(0.1), 0, 0, strips},
      {"shear 20 %", triangle_shear(0.2), 0, 0, strips},
      {"band w=16 A=4", band(4, 16, middle, middle), 0, 0, {}},
      {"band w=8 A=2", band(2, 8, middle, middle), 0, 0, {}},
      {"band w=4 A=2", band(2, 4, middle, middle), 0, 0, {}},
      {"sine 128 px", sine(1, 128), 0, 0, {}, 1},
      {"sine 64 px", sine(1, 64), 0, 0, {}, 1},
      {"sine 32 px", sine(1, 32), 0, 0, {}, 1},
      {"noise 5 %", uniform(2.3, -1.4), 0.05, 0, {}},
      {"noise 10 %", uniform(2.3, -1.4), 0.10, 0, {}},
      {"loss 10 %", uniform(2.3, -1.4), 0, 0.1, {}},
      {"loss 20 %", uniform(2.3, -1.4), 0, 0.2, {}},
      {"loss 30 %", uniform(2.3, -1.4), 0, 0.3, {}},
      {"noise 5 loss 20 %", uniform(2.3, -1.4), 0.05, 0.2, {}},
      {"shift 20.3 -5.7", uniform(20.3, -5.7), 0, 0, {}},
  };
  const NodeLattice nodes = even_nodes(side, side, spacing, 48);
  std::printf("machine: %s\nthreads %d, frames %d x %d, %d x %d nodes %d px apart, window %d px, %s anchor, seed %d\n",
              machine().c_str(), threads, side, side, nodes.nx, nodes.ny, spacing, options.window_px,
              options.anchor.c_str(), seed);
  std::printf("%-18s %8s %8s %8s %8s %7s %7s %9s %8s %10s\n", "case", "rms px", "bias px", "max px", "valid %",
              "in 1s %", "in 2s %", "sigma px", "gain", "vectors/s");
  PairCorrelator correlator(options, nodes, side, side, threads);
  for (const Row& row : rows) {
    image::TextureOptions texture{.noise = row.noise, .loss = row.loss, .seed = seed};
    const Scene scene = make_scene(row.motion, side, side, texture);
    const auto start = std::chrono::steady_clock::now();
    const PixelVectors found = correlator.correlate(scene.first.view(), scene.second.view(), {});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const Errors e = errors(scene, nodes, found, row.scored);
    std::printf("%-18s %8.4f %8.4f %8.3f %8.1f %7.0f %7.0f %9.4f ", row.name, e.rms, e.bias, e.largest, 100 * e.valid,
                100 * e.within_one, 100 * e.within_two, e.sigma);
    row.amplitude > 0 ? std::printf("%8.3f ", gain(scene, nodes, found)) : std::printf("%8s ", "");
    std::printf("%10.0f\n", static_cast<double>(nodes.pixel.size()) / seconds);
    std::fflush(stdout);
  }
}

// Particle-steps per second of the tracker, in memory: every shape, F, covariance where said.
//   np_bench [particles] [repeats] [shape]
//   np_bench stream DIR [particles] [frames]    written while tracked (np_stream.hpp)
// Prints one line a variant: best and median of `repeats` runs of a few steps each.
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/np/analytic.hpp"
#include "pivnp/np/tracker.hpp"
#include "tests/bench/np_stream.hpp"

namespace {

using namespace pivnp;

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

struct Rate {
  double best = 0, median = 0;  // particle-steps per second
};

Rate measure(const ParticleSet& particles, const VectorField& there, const VectorField& back,
             np::ShapeFunctions shape, np::GradientPlace gradient, int repeats) {
  constexpr int steps = 4;
  np::NpOptions options;
  options.shape = shape;
  options.gradient = gradient;
  std::vector<double> rates;
  np::Tracker tracker(options, particles, 0);
  double time = 0;
  for (int n = 0; n < repeats + 1; ++n) {
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < steps; ++k) tracker.step(k % 2 == 0 ? there : back, ++time);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (n > 0) rates.push_back(double(particles.size()) * steps / took.count());  // the first fills the buffers
  }
  for (std::size_t p = 0; p < particles.size(); ++p)
    if (tracker.state()[p].status == ParticleStatus::ended) {
      std::fprintf(stderr, "np_bench: particle %zu ended, the figure would not be that of living particles\n", p);
      std::exit(1);
    }
  std::sort(rates.begin(), rates.end());
  return {rates.back(), rates[rates.size() / 2]};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]) == "stream") {
    const double particles = argc > 3 ? std::atof(argv[3]) : 1e6;
    const int frames = argc > 4 ? std::atoi(argv[4]) : 100;
    if (particles >= 4 && frames >= 1) return stream(argv[2], int(std::lround(std::sqrt(particles / 4))), frames);
    std::fprintf(stderr, "usage: np_bench stream DIR [particles >= 4] [frames >= 1]\n");
    return 2;
  }
  const long wanted = argc > 1 ? std::atol(argv[1]) : 1000000;
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 9;
  if (wanted < 4 || repeats < 1) {
    std::fprintf(stderr, "usage: np_bench [particles >= 4] [repeats >= 1] [shape]\n");
    return 2;
  }
  const std::string only = argc > 3 ? argv[3] : "";
  const int side = std::max(1, int(std::lround(std::sqrt(double(wanted) / 4))));
  const int margin = 2;
  const Grid grid{{0, 0}, {1, 1}, side + 2 * margin + 1, side + 2 * margin + 1};
  const double lo = margin, hi = margin + side;
  const ParticleSet particles = seed(grid, {{"all", Polygon({{lo, lo}, {hi, lo}, {hi, hi}, {lo, hi}}, "bench")}}, 4,
                                     SeedPattern::even, 0, "bench");
  std::printf("machine: %s\nthreads: %d of %d processors; particles %zu, nodes %zu, 4 particles an element\n",
              machine().c_str(), omp_get_max_threads(), omp_get_num_procs(), particles.size(), grid.node_count());
  std::printf("%-9s %-9s %-9s %-4s %22s %22s\n", "shape", "anchor", "gradient", "cov", "best, M part.steps/s", "median");
  // Up to half a spacing a step, as PIV measures; the way back keeps the particles in place for ever.
  const np::ReversingVortex motion({lo + side / 2.0, lo + side / 2.0}, side / 3.0, 3.5 / side, 2);
  std::printf("state: %zu bytes a particle; a frame in a record: %zu bytes a particle, %zu with covariance\n",
              2 * sizeof(Vec2) + sizeof(Mat2) + 6 * sizeof(double) + 1, 6 * sizeof(float) + 1, 12 * sizeof(float) + 1);
  for (const auto& [shape_name, shape] : np::shape_functions_names)
    for (const Anchor anchor : {Anchor::forward, Anchor::central})
      for (const auto& [gradient_name, gradient] : np::gradient_place_names)
        for (const bool with_cov : {false, true}) {
          const bool plain = shape == np::ShapeFunctions::bilinear;
          if ((!plain && gradient == np::GradientPlace::element) || (!only.empty() && only != shape_name)) continue;
          np::NodalIncrements there = np::sample_increments(motion, grid, anchor, 0, 1);
          np::NodalIncrements back = np::sample_increments(motion, grid, anchor, 1, 2);
          if (with_cov) there.cov.assign(grid.node_count(), {1e-6f, 1e-6f, 0});
          back.cov = there.cov;
          const Rate rate = measure(particles, np::vector_field(there, {0, 1}), np::vector_field(back, {1, 2}), shape,
                                    gradient, plain ? repeats : std::min(repeats, 3));
          std::printf("%-9s %-9s %-9s %-4s %22.1f %22.1f\n", shape_name.data(), anchor == Anchor::forward ? "forward" : "central",
                      gradient_name.data(), with_cov ? "yes" : "no", rate.best / 1e6, rate.median / 1e6);
        }
}

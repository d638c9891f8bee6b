// Million particle-steps per second of the column of the peers' comparison: L x L in a box 2L x 1.2L, 2 x 2 particles a
// cell, E 1e6, nu 0.3, rho 2000, g 9.81, dt = 0.2 h/c_p, fixed base, sliding walls; set-up left out.
//   mpm_throughput [words of the kernels wanted ...] [particles ...] [runs=5] [threads=2] [target=avx3|avx2|sse2]
//                                              (default: all, 10000 100000, the best instruction set)
//   mpm_throughput scale [particles ...]       set-up time, memory, proportion
//   mpm_throughput wet [words ...] [particles ...] [runs=5] [threads=2]   kernels with water in turn with the same ones
//   dry: ns of
//                                              the processors' time a particle-step, and its ratio, on one thread and
//                                              on two
// Each figure is the median of `runs` runs, those with one and two threads taken in turn; one thread by its own
// processor time, two by the clock (so on an idle machine only). "times plain" is the rate on one thread over that of a
// plain kernel (plain_kernel.hpp) of the same size, run in turn with it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <malloc.h>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "tests/bench/mpm/machine.hpp"
#include "tests/bench/mpm/plain_kernel.hpp"
#include "tests/bench/mpm/target.hpp"

using namespace pivnp;

namespace {

struct Kernel {
  const char *name, *shape, *transfer, *stress, *locking, *model;
  enum Motion { rest, sheared, thrown } motion;
  const char* extra = "";  // a wall with friction, a softening material, water in the pores; contact: a face between two halves
};

// sheared: the block flows sideways so that sand yields; thrown: it flies through the box at a tenth of the wave speed.
const Kernel kernels[] = {
    {"bilinear musl elastic", "bilinear", "flip", "musl", "none", "linear_elastic", Kernel::rest},
    {"bilinear musl elastic moving", "bilinear", "flip", "musl", "none", "linear_elastic", Kernel::thrown},
    {"bilinear musl sand yielding", "bilinear", "flip", "musl", "none", "mohr_coulomb", Kernel::sheared},
    {"bilinear musl sand moving", "bilinear", "flip", "musl", "none", "mohr_coulomb", Kernel::thrown},
    {"bspline apic elastic", "bspline", "apic", "usl", "none", "linear_elastic", Kernel::rest},
    {"bspline apic elastic moving", "bspline", "apic", "usl", "none", "linear_elastic", Kernel::thrown},
    {"bspline apic sand yielding", "bspline", "apic", "usl", "none", "mohr_coulomb", Kernel::sheared},
    {"bspline apic sand moving", "bspline", "apic", "usl", "none", "mohr_coulomb", Kernel::thrown},
    {"default elastic", "bspline", "apic", "usl", "fbar", "linear_elastic", Kernel::rest},
    {"default elastic moving", "bspline", "apic", "usl", "fbar", "linear_elastic", Kernel::thrown},
    {"default sand yielding", "bspline", "apic", "usl", "fbar", "mohr_coulomb", Kernel::sheared},
    {"geopart elastic", "bilinear", "flip", "musl", "selective", "linear_elastic", Kernel::rest},
    {"geopart sand yielding", "bilinear", "flip", "musl", "selective", "mohr_coulomb", Kernel::sheared},
    {"bilinear musl fbar elastic", "bilinear", "flip", "musl", "fbar", "linear_elastic", Kernel::rest},
    {"gimp musl elastic", "gimp", "flip", "musl", "none", "linear_elastic", Kernel::rest},
    {"bspline xpic elastic", "bspline", "xpic", "usl", "none", "linear_elastic", Kernel::rest},
    {"bilinear musl softening yielding", "bilinear", "flip", "musl", "none", "mohr_coulomb", Kernel::sheared, "softening"},
    {"bilinear musl softening moving", "bilinear", "flip", "musl", "none", "mohr_coulomb", Kernel::thrown, "softening"},
    {"bspline apic softening yielding", "bspline", "apic", "usl", "none", "mohr_coulomb", Kernel::sheared, "softening"},
    {"bspline apic softening moving", "bspline", "apic", "usl", "none", "mohr_coulomb", Kernel::thrown, "softening"},
    {"bspline apic substepping", "bspline", "apic", "usl", "none", "mohr_coulomb_smooth", Kernel::sheared, "softening"},
    {"bspline apic fbar sleeping", "bspline", "apic", "usl", "fbar", "linear_elastic", Kernel::rest, "sleeping"},
    {"default elastic friction", "bspline", "apic", "usl", "fbar", "linear_elastic", Kernel::rest, "friction"},
    {"bilinear musl elastic wet", "bilinear", "flip", "musl", "none", "linear_elastic", Kernel::rest, "wet"},
    {"bilinear musl sand yielding wet", "bilinear", "flip", "musl", "none", "mohr_coulomb", Kernel::sheared, "wet"},
    {"bspline apic elastic wet", "bspline", "apic", "usl", "none", "linear_elastic", Kernel::rest, "wet"},
    {"bspline apic sand yielding wet", "bspline", "apic", "usl", "none", "mohr_coulomb", Kernel::sheared, "wet"},
    {"default elastic contact", "bspline", "apic", "usl", "fbar", "linear_elastic", Kernel::rest, "contact"},
};

mpm::Scene column(int cells, const Kernel& kernel) {
  const double h = 1.0 / cells;
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {h, h}, 2 * cells + 1, int(1.2 * cells) + 1};
  const bool halves = std::string(kernel.extra) == "contact";
  const double top = halves ? h * (cells / 2) : 1;
  std::vector<Region> regions = {{"soil", Polygon({{0, 0}, {1, 0}, {1, top}, {0, top}}, "soil")}};
  if (halves) regions.push_back({"upper", Polygon({{0, top}, {1, top}, {1, 1}, {0, 1}}, "upper")});
  scene.particles = seed(scene.grid, regions, 4, SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions m;
  m.model = kernel.model;
  m.young_pa = 1e6;
  m.density_kg_m3 = 2000;
  m.friction_deg = 20;
  if (std::string(kernel.extra) == "softening") {
    m.friction_residual_deg = 15;
    m.softening_shape = 10;
  }
  if (std::string(kernel.extra) == "wet") {
    m.density_kg_m3 = 0;
    m.porosity = 0.4;
    m.grain_density_kg_m3 = 2667;
    m.permeability_m_s = 1e-5;
    scene.water.emplace();
  }
  scene.materials.assign(regions.size(), m);
  if (halves) {
    mpm::ContactOptions contact;
    contact.regions = {"upper"};
    contact.friction = 0.5;
    scene.contacts = {{"face", contact}};
  }
  mpm::BoundaryOptions base, left, right;
  base.line_m = {{0, 0}, {2, 0}};
  if (std::string(kernel.extra) == "friction") {
    base.type = mpm::BoundaryType::frictional;
    base.friction = 0.5;
  }
  left.line_m = {{0, 0}, {0, 1.2}};
  right.line_m = {{2, 0}, {2, 1.2}};
  left.type = right.type = mpm::BoundaryType::roller;
  scene.boundaries = {{"base", base}, {"left", left}, {"right", right}};
  if (kernel.motion == Kernel::thrown) scene.v0.assign(scene.particles.size(), Vec2(2.5, 0.0));
  if (kernel.motion == Kernel::sheared) {
    for (const Vec2& x : scene.particles.x0) {
      scene.v0.push_back(Vec2(0.5 * x.y(), 0));
      const double p = 2000 * 9.81 * (1 - x.y());
      scene.stress0.push_back({-0.5 * p, -p, -0.5 * p, 0});
    }
  }
  return scene;
}

std::vector<double> plastic(const mpm::Solver& solver) {
  const MotionFrame f = solver.frame();
  const std::vector<float>& values = f.field("plastic_dev").values;
  return {values.begin(), values.end()};
}

std::vector<std::pair<int, int>> cells_of(const mpm::Solver& solver, double h, double shift) {
  const MotionFrame f = solver.frame();
  const ParticleSet& set = solver.particles();
  std::vector<std::pair<int, int>> cells;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const Vec2& x0 = set.x0[k];
    cells.emplace_back(int(std::floor((x0.x() + double(f.u[k][0])) / h + shift)),
                       int(std::floor((x0.y() + double(f.u[k][1])) / h + shift)));
  }
  return cells;
}

struct Run {
  double rate;          // M particle-steps/s
  double processor_ns;  // of all threads, a particle-step
  double yielding = 0, movers = 0, fill = 0;
};

// `first`: steps before the measured ones, of which there are `least` or more.
Run measure(const Kernel& kernel, int cells, int threads, double first = 30, double least = 40) {
  mpm::MpmOptions options;
  options.courant = 0.2;
  options.shape = value_named<mpm::ShapeKind>(kernel.shape);
  options.transfer = value_named<mpm::TransferKind>(kernel.transfer);
  options.stress_update = value_named<mpm::StressUpdate>(kernel.stress);
  options.locking = value_named<mpm::Locking>(kernel.locking);
  if (kernel.extra == std::string("wet")) options.initial_equilibrium = false;
  if (kernel.motion == Kernel::thrown) options.gravity_m_s2 = {0, 0};
  if (kernel.extra == std::string("sleeping")) options.sleep_below_m_s = 1e-9;  // on, and nothing falls asleep
  mpm::Solver solver(options, column(cells, kernel), threads);
  SilentProgress silent;
  const double dt = solver.stable_step(), n = double(solver.particles().size());
  solver.advance_to(first * dt, silent);
  const auto steps = solver.steps();
  const double h = 1.0 / cells, shift = kernel.shape == std::string("bilinear") ? 0 : 0.5;
  const auto plastic_before = plastic(solver);
  const auto cells_before = cells_of(solver, h, shift);
  const auto start = std::chrono::steady_clock::now();
  const auto cpu = std::clock();
  solver.advance_to((first + std::max(least, std::min(1000.0, 4e6 / n))) * dt, silent);
  double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double processor_s = double(std::clock() - cpu) / CLOCKS_PER_SEC;
  if (threads == 1) s = processor_s;
  const double made = double(solver.steps() - steps);
  Run run{made * n / s / 1e6, 1e9 * processor_s / (made * n)};
  const auto plastic_after = plastic(solver);
  const auto cells_after = cells_of(solver, h, shift);
  std::map<std::pair<int, int>, int> count;
  for (std::size_t k = 0; k < cells_after.size(); ++k) {
    run.yielding += plastic_after[k] > plastic_before[k];
    run.movers += std::abs(cells_after[k].first - cells_before[k].first) +
                  std::abs(cells_after[k].second - cells_before[k].second);
    ++count[cells_after[k]];
  }
  double lanes = 0;
  for (const auto& [cell, in_it] : count) lanes += 4 * ((in_it + 3) / 4);
  run.yielding /= n;
  run.movers /= n * made;
  run.fill = n / lanes;
  return run;
}

double resident_bytes() {
  malloc_trim(0);  // what was freed in between is not the solver's
  std::ifstream statm("/proc/self/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * 4096;
}

// Set-up time, memory, and time in proportion to the particles. The scene's own (ParticleSet) counts as set-up's input.
void scale(const std::vector<int>& sizes) {
  std::printf("%10s %9s %16s %12s %12s %9s   default scheme, sand, one thread\n", "particles", "set-up s", "bytes a particle",
              "of the scene", "ns a step", "M/s");
  for (const int size : sizes) {
    const int cells = std::max(2, int(std::lround(std::sqrt(size / 4.0))));
    const double before = resident_bytes();
    mpm::Scene scene = column(cells, {"", "bspline", "apic", "usl", "fbar", "mohr_coulomb", Kernel::sheared});
    const double n = double(scene.particles.size()), of_scene = resident_bytes() - before;
    auto cpu = std::clock();
    mpm::MpmOptions options;
    options.courant = 0.2;
    mpm::Solver solver(options, std::move(scene), 1);
    const double setup = double(std::clock() - cpu) / CLOCKS_PER_SEC;
    SilentProgress silent;
    const double dt = solver.stable_step();
    solver.advance_to(2 * dt, silent);
    cpu = std::clock();
    const auto steps = solver.steps();
    solver.advance_to((2 + std::max(10.0, std::min(500.0, 4e6 / n))) * dt, silent);
    const double s = double(std::clock() - cpu) / CLOCKS_PER_SEC / double(solver.steps() - steps);
    std::printf("%10.0f %9.2f %16.0f %12.0f %12.1f %9.1f\n", n, setup, (resident_bytes() - before - of_scene) / n, of_scene / n,
                1e9 * s / n, n / s / 1e6);
    std::fflush(stdout);
  }
}

// Bytes of particle arrays read and written, and flops, a particle-step: counted from the kernels (a fused multiply-add
// is two flops, a quotient or root one; of B-splines with APIC in the compiled loops over full tiles of eight lanes). Nodes add
// some 60 bytes at four particles a cell.
struct Work {
  double bytes, flops;
};
Work work_of(const Kernel& k) {
  const auto is = [](const char* a, const char* b) { return std::string(a) == b; };
  const bool spline = !is(k.shape, "bilinear"), affine = is(k.transfer, "apic"), sand = !is(k.model, "linear_elastic");
  const bool updated = is(k.stress, "usl") && affine;           // moved and strained in one sweep
  Work w{0, 6};
  const auto add = [&](double bytes, double flops) { w.bytes += bytes, w.flops += flops; };
  add(64, affine && spline ? 213 : spline ? 170 : 75);          // map: x, V0, v, three stresses; APIC's C below
  add(72 + 144, affine && spline ? 285 : spline ? 280 : 185);   // move: V0; v, x in and out; strain: F, J, stress in and out
  if (!updated) add(16 + 32, 0);                                // who has left its cell: x; xi, eta kept and read
  if (affine) add(96, spline ? 0 : 34 + 62);                    // C in; in and out
  if (is(k.stress, "musl")) add(0, spline ? 70 : 30);           // momentum mapped again
  if (is(k.transfer, "xpic")) add(4 * 24, 4 * 110);             // four more maps there and back
  if (!is(k.locking, "none")) add(spline ? 96 : 24, spline ? 230 : 40);
  add(sand ? 57 : 16, sand ? 150 : 120);                        // law, beyond the stress: J, opening strain, plastic strain, work
  return w;
}

double state_size(int cells) { return 4.0 * cells * cells; }

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

bool is_wanted(const Kernel& kernel, const std::vector<std::string>& words) {
  return words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
           return std::string(kernel.name).starts_with(word);
         });
}

// Kernels with water, run in turn with the same ones dry. (Not in their first hundred steps: those look ten times as
// often at the balance of energies, which asks every point.)
void wet(const std::vector<int>& sizes, const std::vector<std::string>& words, int runs, int most) {
  std::printf("%-33s %9s %7s   %8s %8s %6s   %s\n", "kernel", "particles", "threads", "dry ns", "wet ns", "ratio",
              "best two; yielding dry, wet");
  for (const Kernel& kernel : kernels) {
    if (std::string(kernel.extra) != "wet" || !is_wanted(kernel, words)) continue;
    Kernel dry = kernel;
    dry.extra = "";
    for (const int size : sizes) {
      const int cells = std::max(2, int(std::lround(std::sqrt(size / 4.0))));
      for (int threads = 1; threads <= most; ++threads) {
        std::vector<double> times[2];
        double yielding[2] = {};
        for (int r = 0; r < runs; ++r)
          for (int is_wet = 0; is_wet < 2; ++is_wet) {
            const Run run = measure(is_wet ? kernel : dry, cells, threads, 110, 180);
            times[is_wet].push_back(run.processor_ns);
            yielding[is_wet] = run.yielding;
          }
        const auto least = [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); };
        std::printf("%-33s %9d %7d   %8.1f %8.1f %6.2f   %.1f %.1f: %.2f; %.0f %.0f %%\n", kernel.name,
                    4 * cells * cells, threads, median(times[0]), median(times[1]), median(times[1]) / median(times[0]),
                    least(times[0]), least(times[1]), least(times[1]) / least(times[0]), 100 * yielding[0],
                    100 * yielding[1]);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> sizes;
  std::vector<std::string> words;
  int runs = 5, most = 2;
  for (int a = 1; a < argc; ++a) {
    const std::string word = argv[a];
    if (word.starts_with("runs=")) runs = std::atoi(argv[a] + 5);
    else if (word.starts_with("target=")) bench::choose_target(word.substr(7));
    else if (word.starts_with("threads=")) most = std::atoi(argv[a] + 8);
    else if (std::atoi(argv[a]) > 0) sizes.push_back(std::atoi(argv[a]));
    else words.push_back(word);
  }
  if (sizes.empty()) sizes = {10000, 100000};
  if (words.size() == 1 && words[0] == "scale") {
    scale(sizes);
    return 0;
  }
  if (!words.empty() && words[0] == "wet") {
    wet(sizes, {words.begin() + 1, words.end()}, runs, most);
    return 0;
  }
  std::printf("machine: %s, %u hardware threads; kernels on %s; double precision, guards and energy on\n",
              bench::processor().c_str(), std::thread::hardware_concurrency(), mpm::simd_target());
  const double cached = bench::update_rate(4 << 20), memory = bench::update_rate(256 << 20), flops = bench::flop_rate();
  std::printf("one thread now: updates in place %.0f GB/s in 4 MiB, %.0f GB/s in 256 MiB; %.0f GFlop/s with four lanes\n", cached,
              memory, flops);
  std::printf("%-33s %9s %9s %6s %9s  %14s %11s  %16s %18s\n", "kernel", "particles", "yielding", "fill", "movers",
              "M/s, 1, 2 thr.", "times plain", "bytes (of limit)", "flops (of limit)");
  for (const Kernel& kernel : kernels) {
    if (!is_wanted(kernel, words)) continue;
    for (const int size : sizes) {
      const int cells = std::max(2, int(std::lround(std::sqrt(size / 4.0))));
      std::vector<double> one, two, plain;
      Run state{};
      for (int r = 0; r < runs; ++r) {
        state = measure(kernel, cells, 1);
        one.push_back(state.rate);
        plain.push_back(bench::plain_rate(cells, std::max(20.0, std::min(500.0, 1e6 / state_size(cells)))));
        if (most > 1) two.push_back(measure(kernel, cells, most).rate);
      }
      const Work work = work_of(kernel);
      const double limit = 250.0 * state_size(cells) < 16 << 20 ? cached : memory, rate = median(one);
      const double of_bytes = rate * work.bytes / 1e3 / limit, of_flops = flops > 0 ? rate * work.flops / 1e3 / flops : 0;
      std::printf("%-33s %9d %8.0f%% %6.2f %8.2f%%  %6.1f %6.1f %11.2f   %6.0f (%3.0f %%)  %7.0f (%3.0f %%)  %s\n", kernel.name,
                  4 * cells * cells, 100 * state.yielding, state.fill, 100 * state.movers, rate,
                  most > 1 ? median(two) : 0.0, rate / median(plain), work.bytes, 100 * of_bytes, work.flops, 100 * of_flops,
                  of_bytes > 0.7 ? "memory" : of_flops > 0.7 ? "arithmetic" : "issue and latency");
      std::fflush(stdout);
    }
  }
}

// Million stress updates per second of the laws alone, one thread by its own processor time: points at 10 kPa that are
// sheared on at failure, each in a direction of its own, by the same strain at every step.
//   mpm_laws [runs=5] [target=avx3|avx2|sse2]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "mpm/material/model.hpp"
#include "tests/bench/mpm/machine.hpp"
#include "tests/bench/mpm/target.hpp"

using namespace pivnp;

namespace {

struct Law {
  const char *name, *model;
  bool softens;
};
const Law laws[] = {{"Mohr-Coulomb, closed form", "mohr_coulomb", false},
                    {"the same, softening", "mohr_coulomb", true},
                    {"smooth, substepping", "mohr_coulomb_smooth", false},
                    {"the same, softening", "mohr_coulomb_smooth", true}};

struct Run {
  double rate, plastic;
};

Run measure(const Law& law, double strain) {
  mpm::MaterialOptions o;
  o.model = law.model;
  o.young_pa = 1e7;
  o.density_kg_m3 = 1600;
  o.friction_deg = 35;
  if (law.softens) {
    o.friction_residual_deg = 30;
    o.softening_shape = 20;
  }
  const auto material = mpm::make_material(o, "material.a");
  constexpr std::size_t n = 1000;
  std::vector<double> a[13];
  for (auto& field : a) field.assign(n, 0.0);
  std::vector<std::uint8_t> separated(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = 2.399963 * double(k);  // the golden one
    a[0][k] = strain * std::cos(angle);
    a[1][k] = -a[0][k];
    a[3][k] = strain * std::sin(angle);
    a[4][k] = 0.2 * strain;
    a[5][k] = 1;
    for (int q = 6; q < 9; ++q) a[q][k] = -10000;
  }
  mpm::StressBatch b;
  b.size = n;
  b.de_xx = a[0].data(), b.de_yy = a[1].data(), b.de_zz = a[2].data(), b.de_xy = a[3].data(), b.spin = a[4].data();
  b.J = a[5].data();
  b.xx = a[6].data(), b.yy = a[7].data(), b.zz = a[8].data(), b.xy = a[9].data();
  b.history = {a[10].data(), a[11].data(), a[12].data()}, b.flags = {separated.data()};
  for (double reached = 0; reached < 3e-3; reached += strain) material->update(b);  // to failure
  const std::vector<double> before = a[10];
  double updates = 0;
  const double start = bench::cpu_s();
  while (bench::cpu_s() - start < 0.2) {
    material->update(b);
    updates += double(n);
  }
  Run run{updates / (bench::cpu_s() - start) / 1e6, 0};
  for (std::size_t k = 0; k < n; ++k) run.plastic += (a[10][k] > before[k]) / double(n);
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  int runs = 5;
  for (int a = 1; a < argc; ++a) {
    const std::string word = argv[a];
    if (word.starts_with("runs=")) runs = std::atoi(argv[a] + 5);
    else if (word.starts_with("target=")) bench::choose_target(word.substr(7));
  }
  std::printf("machine: %s, kernels on %s; M updates/s, one thread, median of %d; in brackets the share that yields\n%-28s",
              bench::processor().c_str(), mpm::simd_target(), runs, "strain a step");
  const double strains[] = {1e-6, 1e-5, 1e-4, 1e-3};
  for (const double strain : strains) std::printf(" %15g", strain);
  for (const Law& law : laws) {
    std::printf("\n%-28s", law.name);
    for (const double strain : strains) {
      std::vector<Run> all;
      for (int r = 0; r < runs; ++r) all.push_back(measure(law, strain));
      std::sort(all.begin(), all.end(), [](const Run& x, const Run& y) { return x.rate < y.rate; });
      const Run& middle = all[all.size() / 2];
      std::printf(" %7.2f (%3.0f %%)", middle.rate, 100 * middle.plastic);
      std::fflush(stdout);
    }
  }
  std::printf("\n");
}

// Does a method know when it is wrong: statuses against errors over displacement x gradient x density x loss x noise,
// and outliers put into true fields, which the validation has to find.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/piv/validation/replacement.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/support/piv_outliers.hpp"
#include "tests/support/piv_rows.hpp"
#include "tests/support/piv_score.hpp"

namespace pivnp::bench {

namespace {

using namespace pivnp::piv;

constexpr double wrong_px = 0.5, good_px = 0.1;  // of the error's length

struct Counts {
  double wrong = 0, wrong_flagged = 0, good = 0, good_flagged = 0, failed = 0, all = 0;

  void add(const Counts& other) {
    wrong += other.wrong, wrong_flagged += other.wrong_flagged;
    good += other.good, good_flagged += other.good_flagged;
    failed += other.failed, all += other.all;
  }
};

/// Vectors without a value (failed) claim nothing: they are neither wrong nor good.
Counts count(const image::SyntheticPair& pair, const NodeLattice& nodes, const PixelVectors& found,
             const std::function<bool(const Vec2&)>& scored = {}) {
  Counts c;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    const Vec2 place(nodes.pixel[k][0], nodes.pixel[k][1]);
    if (scored && !scored(place)) continue;
    ++c.all;
    if (found.status[k] == VectorStatus::failed || found.status[k] == VectorStatus::masked) {
      ++c.failed;
      continue;
    }
    const double error =
        (Vec2(found.displacement[k][0], found.displacement[k][1]) - pair.truth(place, found.anchor)).norm();
    const bool flagged = found.status[k] != VectorStatus::valid;
    // a value that is not a number is as wrong as can be
    if (!(error <= wrong_px)) ++c.wrong, c.wrong_flagged += flagged;
    if (error < good_px) ++c.good, c.good_flagged += flagged;
  }
  return c;
}

const char* mark(bool met) { return met ? "ok" : "MISS"; }

void print(const char* name, const Counts& c) {
  std::printf("%-26s %9.0f %9.0f ", name, c.all, c.wrong);
  c.wrong > 0 ? std::printf("%9.2f", 100 * c.wrong_flagged / c.wrong) : std::printf("%9s", "");
  std::printf(" %9.0f ", c.good);
  c.good > 0 ? std::printf("%9.2f", 100 * c.good_flagged / c.good) : std::printf("%9s", "");
  std::printf(" %9.2f\n", 100 * c.failed / c.all);
}

struct Axis {
  const char* name;
  std::vector<double> levels;
  const char* format;
};

/// Uniform motion along a direction off the axes, and a triangle-wave shear upon it.
Motion motion(double displacement, double slope) {
  const Motion shear = image::triangle_shear(slope);
  const Vec2 all(displacement * std::cos(0.6), displacement * std::sin(0.6));
  return [=](const Vec2& p) -> Vec2 { return all + shear(p); };
}

bool field_map(const BenchOptions& options, const Setting& setting) {
  const std::vector<Axis> axes = {{"displacement px", {0.3, 4.7, 14.2}, "%.1f"},
                                  {"gradient", {0, 0.05, 0.2}, "%.2f"},
                                  {"density per px", {0.005, 0.02, 0.05}, "%.3f"},
                                  {"loss", {0, 0.2, 0.5, 0.7}, "%.1f"},
                                  {"noise", {0, 0.05, 0.15}, "%.2f"}};
  const int side = std::min(options.side, 512);  // many scenes: a smaller frame each
  const NodeLattice nodes = even_nodes(side, side, options.spacing, options.margin);
  PivOptions piv = setting.options;
  piv.replace = false;  // a replaced vector would hide what was measured
  PairCorrelator correlator(piv, nodes, side, side, options.threads);
  std::vector<std::vector<Counts>> by_level;
  for (const Axis& axis : axes) by_level.emplace_back(axis.levels.size());
  Counts all;
  const double density_ratio = options.texture.kind == image::TextureKind::soil ? 4 : 1;  // soil is denser throughout
  std::array<std::size_t, 5> at{};
  int scene = 0;
  for (bool more = true; more; ++scene) {
    const auto level = [&](std::size_t a) { return axes[a].levels[at[a]]; };
    for (const int seed : options.seeds) {
      image::TextureOptions texture = options.texture;
      texture.density_per_px = density_ratio * level(2), texture.loss = level(3), texture.noise = level(4);
      texture.seed = 1000 * seed + scene;
      const image::SyntheticPair pair = image::synthetic_pair(motion(level(0), level(1)), side, side, texture);
      const Counts c = count(pair, nodes, correlator.correlate(pair.first.view(), pair.second.view(), {}));
      all.add(c);
      for (std::size_t a = 0; a < axes.size(); ++a) by_level[a][at[a]].add(c);
    }
    std::size_t a = 0;
    while (a < axes.size() && ++at[a] == axes[a].levels.size()) at[a++] = 0;
    more = a < axes.size();
  }
  std::printf("%s: map of statuses, frames %d px\n%-26s %9s %9s %9s %9s %9s %9s\n", setting.name.c_str(), side, "",
              "vectors", "> .5 px", "flagged %", "< .1 px", "flagged %", "failed %");
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (std::size_t l = 0; l < axes[a].levels.size(); ++l) {
      char level[32], name[64];
      std::snprintf(level, sizeof level, axes[a].format, axes[a].levels[l]);
      std::snprintf(name, sizeof name, "%s %s", axes[a].name, level);
      print(name, by_level[a][l]);
    }
  print("all", all);
  const bool wrong = all.wrong_flagged >= 0.97 * all.wrong, good = all.good_flagged <= 0.05 * all.good;
  std::printf(
      "  flagged of those wrong by more than .5 px: %.2f %% (at least 97)  %s\n"
      "  flagged of those better than .1 px: %.2f %% (at most 5)  %s\n",
      100 * all.wrong_flagged / all.wrong, mark(wrong), 100 * all.good_flagged / all.good, mark(good));
  return wrong && good;
}

/// Shear and waves must not cost good vectors.
bool kept_in_gradients(const BenchOptions& options, const Setting& setting) {
  PivOptions piv = setting.options;
  piv.replace = false;
  const NodeLattice nodes = even_nodes(options.side, options.side, options.spacing, options.margin);
  PairCorrelator correlator(piv, nodes, options.side, options.side, options.threads);
  bool met = true;
  for (const Row& row : piv_rows(options.side)) {
    if (row.name != "shear 20 %" && row.name != "sine 128") continue;
    Counts c;
    for (const int seed : options.seeds) {
      image::TextureOptions texture = row.texture(options.texture);
      texture.seed = seed;
      const image::SyntheticPair pair = image::synthetic_pair(row.motion, options.side, options.side, texture);
      c.add(count(pair, nodes, correlator.correlate(pair.first.view(), pair.second.view(), {}), row.scored));
    }
    const bool enough = c.good > 0 && c.good_flagged <= 0.01 * c.good;
    std::printf("  %s: %.2f %% of good vectors stay valid (at least 99)  %s\n", row.name.c_str(),
                100 - 100 * c.good_flagged / c.good, mark(enough));
    met = met && enough;
  }
  return met;
}

bool injected(const BenchOptions& options, const Setting& setting) {
  std::printf("%s\n", setting.name.c_str());
  std::printf("  outliers put into fields: found and false alarms of the validation, %%\n  %-26s", "");
  for (const double share : outlier_shares) std::printf("   %2.0f %% of vectors ", 100 * share);
  std::printf("\n");
  bool met = true;
  for (const OutlierKind kind : {OutlierKind::single, OutlierKind::cluster, OutlierKind::moved_cluster})
    for (const OutlierField& field : outlier_fields()) {
      std::printf("  %-32s", (std::string(name(kind)) + ", " + field.name).c_str());
      for (const double share : outlier_shares) {
        OutlierCounts c;
        for (const int seed : options.seeds)
          c.add(inject(field, kind, share, setting.options, static_cast<unsigned>(seed), options.threads));
        met = met && c.met();
        std::printf("   %6.2f %5.2f %s", 100 * c.found(), 100 * c.false_alarms(), c.met() ? "ok  " : "MISS");
      }
      std::printf("\n");
    }
  std::printf("  asked: 95 %% found, 2 %% false alarms\n\n");
  return met;
}

}  // namespace

int map(const BenchOptions& options) {
  options.print_head();
  bool met = true;
  for (const Setting& setting : options.settings) {
    const bool flags = field_map(options, setting), kept = kept_in_gradients(options, setting);
    met = met && ((flags && kept) || setting.options.method != "default");
  }
  return met ? 0 : 3;
}

int outliers(const BenchOptions& options) {
  options.print_head();
  bool met = true;
  for (const Setting& setting : options.settings)
    met = (injected(options, setting) || setting.options.method != "default") && met;
  return met ? 0 : 3;
}

}  // namespace pivnp::bench

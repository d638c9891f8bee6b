// Does a verdict close: the same physics must not be told apart, another must.
//   verdict_table [FOLDER] [--looks N] [--from K] [--scene NAME] [--twins] [--corrected] [--reuse] [--verbose]
//                       [--ways | --paths]
// N frames sequences a scene (8), from the K-th look on (0). Prints the table of docs/verdicts.md. --twins: no other
// soil, and of every metric what share of its factor 92 % of the twins' differences do not exceed, and the greatest
// (factors that are not derived are set by it, on looks that the table does not use).
// --corrected: paths are held against drift (np.drift), in the table.
// --reuse: compares anew what an earlier run has left in FOLDER.
// --ways: whether levelling, and a coarser grid for u_num, change what is said of displacement (the same soil and the
// first other one), instead of the table.
// --paths: shares of particles within one and two stated standard deviations of the simulation, after a tenth, half and
// all of the frames, without drift correction and with it, instead of the table.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/verdict/twins.hpp"

namespace {

using namespace pivnp;
using namespace pivnp::twins;

struct Count {
  int said = 0, of = 0, by_strain = 0;
  double worst = 0;
  std::vector<double> of_factor;  // |difference| / (factor u) of each
};

// Of its factor: what 92 % of the twins do not exceed (nearest rank), and the greatest.
void factor_row(const char* name, Count c) {
  std::sort(c.of_factor.begin(), c.of_factor.end());
  const auto n = c.of_factor.size();
  std::printf("| %s | %zu | %.2f | %.2f |\n", name, n, c.of_factor[std::size_t(std::ceil(.92 * double(n))) - 1], c.of_factor.back());
}

void row(const char* name, const Count& c) {
  std::printf("| %s | %d of %d | %.0f %% | %.1f |\n", name, c.said, c.of, 100.0 * c.said / std::max(1, c.of), c.worst);
}

struct Ways {
  int plain = 0, levelled = 0, coarser = 0, of = 0;
};

// What is said of displacement in each way: 1 where it is found.
void ask(Bench& bench, const Scene& scene, const Look& how, const Soil& soil, Ways& ways) {
  const auto told = [](Said what) { return what == Said::found ? 1 : 0; };
  const std::filesystem::path measured = bench.measured(scene, how);
  const int plain = told(said_of_displacement(bench.against(scene, measured, soil))),
            coarser = told(said_of_displacement(bench.against(scene, measured, soil, 1))),
            levelled = told(said_of_levelled_displacement(bench.levelled(scene, how, soil)));
  ways.plain += plain, ways.coarser += coarser, ways.levelled += levelled, ++ways.of;
  std::printf("%-8s %-44s friction %.0f: plain %d levelled %d coarser %d\n", scene.name.c_str(), how.text().c_str(),
              soil.friction_deg, plain, levelled, coarser);
  std::fflush(stdout);
}

void ask_in_ways(Bench& bench, const std::string& only, int looks, int from) {
  std::vector<std::pair<std::string, Ways>> rows;
  for (std::size_t s = 0; s < scenes().size(); ++s) {
    const Scene& scene = scenes()[s];
    if (!only.empty() && scene.name != only) continue;
    Ways same, other;
    for (int n = 0; n < looks; ++n) {
      const Look how = look(from + n + int(s));
      ask(bench, scene, how, scene.soil, same), ask(bench, scene, how, scene.changes[0].soil, other);
    }
    rows.emplace_back(scene.name + ", the same soil", same),
        rows.emplace_back(scene.name + ", " + scene.changes[0].name, other);
  }
  std::printf("\nDisplacement told apart\n\n| | plain | levelled | one coarser grid |\n|---|---|---|---|\n");
  for (const auto& [name, w] : rows)
    std::printf("| %s | %d of %d | %d of %d | %d of %d |\n", name.c_str(), w.plain, w.of, w.levelled, w.of, w.coarser,
                w.of);
}

// Shares of particles within one and two stated standard deviations, means over the looks.
void cover(Bench& bench, const std::string& only, int looks, int from) {
  constexpr double PathCoverage::*shares[][2] = {{&PathCoverage::displacement, &PathCoverage::displacement_two},
                                                 {&PathCoverage::gradient, &PathCoverage::gradient_two},
                                                 {&PathCoverage::dev, &PathCoverage::dev_two},
                                                 {&PathCoverage::vol, &PathCoverage::vol_two}};
  std::printf(
      "| | drift | frame | displacement | stretches in F | deviatoric | volumetric |\n|---|---|---|---|---|---|---|\n");
  for (std::size_t s = 0; s < scenes().size(); ++s) {
    const Scene& scene = scenes()[s];
    if (!only.empty() && scene.name != only) continue;
    const std::array<int, 3> frames{(scene.frames + 8) / 10, (scene.frames - 1) / 2, scene.frames - 1};
    for (const bool corrected : {false, true}) {
      std::array<PathCoverage, 3> mean;
      for (int n = 0; n < looks; ++n) {
        Look how = look(from + n + int(s));
        how.corrected = corrected;
        const std::filesystem::path measured = bench.measured(scene, how);
        for (std::size_t f = 0; f < frames.size(); ++f) {
          const PathCoverage c = bench.coverage(scene, measured, frames[f]);
          for (const auto& of : shares)
            for (const auto within : of) mean[f].*within += c.*within / looks;
        }
      }
      for (std::size_t f = 0; f < frames.size(); ++f) {
        std::printf("| %s | %s | %d", scene.name.c_str(), corrected ? "corrected" : "none", frames[f]);
        for (const auto& of : shares) std::printf(" | %.2f %.2f", mean[f].*of[0], mean[f].*of[1]);
        std::printf(" |\n");
      }
      std::fflush(stdout);
    }
  }
}

double ratio(const Metric& m) { return m.uncertainty > 0 ? std::abs(m.value) / m.uncertainty : 0; }

}  // namespace

int main(int argc, char** argv) {
  std::string folder = "out/verdict_table", only;
  int looks = 8, from = 0;
  bool verbose = false, twins = false, corrected = false, reuse = false, ways = false, paths = false;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--looks" && k + 1 < argc) looks = std::atoi(argv[++k]);
    else if (word == "--from" && k + 1 < argc) from = std::atoi(argv[++k]);
    else if (word == "--twins") twins = true;
    else if (word == "--corrected")
      corrected = true;
    else if (word == "--reuse") reuse = true;
    else if (word == "--ways")
      ways = true;
    else if (word == "--paths")
      paths = true;
    else if (word == "--scene" && k + 1 < argc) only = argv[++k];
    else if (word == "--verbose") verbose = true;
    else if (word.starts_with("-")) {
      std::fprintf(stderr,
                   "usage: verdict_table [FOLDER] [--looks N] [--from K] [--scene NAME] [--twins] [--corrected] "
                   "[--reuse] [--verbose] [--ways | --paths]\n");
      return word == "--help" || word == "-h" ? 0 : 2;
    } else folder = word;
  }
  SilentProgress progress;
  Bench bench(folder, progress, reuse);
  if (paths) {
    cover(bench, only, looks, from);
    return 0;
  }
  if (ways) {
    ask_in_ways(bench, only, looks, from);
    return 0;
  }
  std::map<std::string, Count> alarms;
  std::map<std::string, Count> found;
  int twin = 0;
  for (std::size_t s = 0; s < scenes().size(); ++s) {
    const Scene& scene = scenes()[s];
    if (!only.empty() && scene.name != only) continue;
    for (int n = 0; n < looks; ++n, ++twin) try {
        Look how = look(from + n + int(s));
        how.corrected = corrected;
        const std::filesystem::path measured = bench.measured(scene, how);
        const Comparison same = bench.against(scene, measured, scene.soil);
        for (const std::string& remark : same.remarks)
          if (verbose) std::printf("  %s\n", remark.c_str());
        for (const Metric& m : same.metrics) {
          const Said what = said(m);
          if (what == Said::nothing) continue;
          Count& c = alarms[m.name];
          c.said += what == Said::found;
          ++c.of;
          c.worst = std::max(c.worst, ratio(m));
          c.of_factor.push_back(ratio(m) / m.factor);
          if (verbose && what == Said::found)
            std::printf("  alarm %s %s: %s %.3g u %.2g\n", scene.name.c_str(), how.text().c_str(), m.name.c_str(), m.value, m.uncertainty);
        }
        const Metric *rms = find(same.metrics, "displacement_rms_final"), *peak = find(same.metrics, "displacement_peak_first"),
                     *coverage = find(same.metrics, "coverage_first_final");
        std::printf("%-8s %-44s peak %6.2f mm  same %5.3f mm u %5.3f  coverage %.2f", scene.name.c_str(), how.text().c_str(),
                    1e3 * peak->value, 1e3 * rms->value, 1e3 * rms->uncertainty, coverage->value);
        for (const Change& change : scene.changes) {
          if (twins) break;
          const Comparison other = bench.against(scene, measured, change.soil);
          const Said what = said_of_displacement(other);
          const Metric* d = find(other.metrics, "displacement_rms_final");
          std::printf("  %s %5.2f u%s", change.name.c_str(), ratio(*d), what == Said::found ? "" : " MISSED");
          Count& c = found[scene.name + ", " + change.name];
          c.said += what == Said::found;
          c.by_strain += what != Said::found && said_of_strain(other) == Said::found;
          ++c.of;
          c.worst = std::max(c.worst, ratio(*d));
        }
        std::printf("\n");
        std::fflush(stdout);
      } catch (const std::exception& error) {
        std::printf("%s, %d: %s\n", scene.name.c_str(), n, error.what());
      }
  }
  std::printf("\nThe same parameters, %d twins: false alarms of each metric\n\n| metric | told apart | | greatest, u |\n|---|---|---|---|\n", twin);
  if (twins) {
    std::printf("\nShare of the factor\n\n| metric | twins | 92 %% | greatest |\n|---|---|---|---|\n");
    for (const auto& [name, c] : alarms) factor_row(name.c_str(), c);
  }
  int bad = 0;
  for (const auto& [name, c] : alarms) {
    if (c.said > 0) row(name.c_str(), c);
    bad += c.said > 0.08 * c.of;
  }
  std::printf("\n%d of %zu metrics above 8 %%\n\n| other parameters | found | | greatest, u |\n|---|---|---|---|\n", bad, alarms.size());
  int all = 0, seen = 0, more = 0;
  for (const auto& [name, c] : found) {
    row(name.c_str(), c);
    all += c.of, seen += c.said, more += c.by_strain;
  }
  std::printf("\n%d of %d found (%.0f %%), %d more by strain alone\n", seen, all, 100.0 * seen / std::max(1, all), more);
  return 0;
}

// The table of sequences: tests/support/piv_sequence_rows.hpp and path_rows.hpp, asked and reached. --drift: rows of
// paths are held by direct correlation (np.drift).
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include "apps/case/case.hpp"
#include "apps/study/methods/paths/drift.hpp"
#include "apps/study/methods/paths/unseen_error.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/support/path_rows.hpp"
#include "tests/support/piv_sequence_rows.hpp"

namespace {

using namespace pivnp;

const char* usage =
    "usage: sequence_table [--rows PART] [--seed N (101)] [--threads N (1)] [--method NAME[:KEY=VALUE..] (default)] "
    "[--drift SCHEME (none)] [--brief]\n";

np::DriftScheme scheme_of(const std::string& name) {
  for (const auto& known : np::drift_scheme_names)
    if (name == known.name) return known.value;
  throw std::invalid_argument("--drift " + name + ": no such scheme");
}

// The pixels are the world, row downward (sequence::measure).
piv::sequence::HoldOf held(np::DriftScheme scheme) {
  if (scheme == np::DriftScheme::none) return {};
  return [scheme](const piv::Sequence& s, const piv::PivOptions& options, int threads) -> piv::sequence::Hold {
    app::Case c;
    c.piv = options;
    c.np = np::NpOptions{};
    c.np->drift = scheme;
    const auto setting = std::make_shared<app::Setting>();
    setting->width = s.width, setting->height = s.height;
    setting->camera = image::Camera(Mat3::Identity(), 0, "px");
    const auto corrector = std::make_shared<app::DriftCorrector>(c, *setting, threads);
    return {[=](const np::Tracker& tracker, const np::BendLoss& lost) {
              corrector->start(tracker, lost, piv::draw(s, 0).view());
            },
            [=](np::Tracker& tracker, np::BendLoss& lost, const VectorField& pair, bool last) {
              const int k = pair.pair[1];
              corrector->after_step(tracker, lost, k, last, app::paths_alike(pair, options.window_px),
                                    [&, held = setting] { return piv::draw(s, k); });
            }};
  };
}

int run(int argc, char** argv) {
  std::string part, method = "default", drift = "none";
  int seed = 101, threads = 1;
  bool brief = false;
  for (int a = 1; a < argc; ++a) {
    const std::string key = argv[a];
    if (key == "--brief") {
      brief = true;
      continue;
    }
    if (a + 1 == argc ||
        (key != "--rows" && key != "--seed" && key != "--threads" && key != "--method" && key != "--drift")) {
      std::fputs(usage, stderr);
      return 2;
    }
    const char* value = argv[++a];
    if (key == "--rows") part = value;
    if (key == "--method") method = value;
    if (key == "--drift") drift = value;
    if (key == "--seed") seed = std::atoi(value);
    if (key == "--threads") threads = std::atoi(value);
  }
  const bench::Setting setting = bench::parse_setting(method, {});
  int asked = 0, met = 0;
  std::printf("%-38s %-30s %10s %10s\n", "sequence", "figure", "asked", "reached");
  std::vector<piv::SequenceRow> rows = piv::sequence_rows();
  for (piv::SequenceRow& row : piv::path_rows(held(scheme_of(drift)))) rows.push_back(std::move(row));
  for (const piv::SequenceRow& row : rows) {
    if ((brief && !row.brief) || row.name.find(part) == std::string::npos) continue;
    const auto start = std::chrono::steady_clock::now();
    const piv::SequenceFigures figures = row.measure(setting.options, seed, threads);
    const double seconds = bench::seconds_since(start);
    bool first = true;
    for (const piv::SequenceFigure& f : figures) {
      std::printf("%-38s %-30s %2s %7.4f %10.4f  %s", first ? row.name.c_str() : "", f.name.c_str(),
                  f.at_least ? ">=" : "<=", f.limit, f.value, f.met() ? "ok" : "MISS");
      if (first) std::printf("  (%.1f s)", seconds);
      std::printf("\n");
      first = false, ++asked, met += f.met();
    }
    std::fflush(stdout);
  }
  std::printf("%s: %d of %d figures met\n", setting.name.c_str(), met, asked);
  return met == asked || setting.options.method != "default" ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sequence_table: %s\n", e.what());
  }
  return 2;
}

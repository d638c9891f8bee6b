// The table of sequences: tests/support/piv_sequence_rows.hpp and path_rows.hpp, asked and reached.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/bench/piv/bench.hpp"
#include "tests/support/path_rows.hpp"
#include "tests/support/piv_sequence_rows.hpp"

namespace {

using namespace pivnp;

const char* usage =
    "usage: sequence_table [--rows PART] [--seed N (101)] [--threads N (1)] [--method NAME[:KEY=VALUE..] (default)] "
    "[--brief]\n";

int run(int argc, char** argv) {
  std::string part, method = "default";
  int seed = 101, threads = 1;
  bool brief = false;
  for (int a = 1; a < argc; ++a) {
    const std::string key = argv[a];
    if (key == "--brief") {
      brief = true;
      continue;
    }
    if (a + 1 == argc || (key != "--rows" && key != "--seed" && key != "--threads" && key != "--method")) {
      std::fputs(usage, stderr);
      return 2;
    }
    const char* value = argv[++a];
    if (key == "--rows") part = value;
    if (key == "--method") method = value;
    if (key == "--seed") seed = std::atoi(value);
    if (key == "--threads") threads = std::atoi(value);
  }
  const bench::Setting setting = bench::parse_setting(method, {});
  int asked = 0, met = 0;
  std::printf("%-38s %-30s %10s %10s\n", "sequence", "figure", "asked", "reached");
  std::vector<piv::SequenceRow> rows = piv::sequence_rows();
  for (piv::SequenceRow& row : piv::path_rows()) rows.push_back(std::move(row));
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

// The table: every row of tests/support/piv_rows.hpp, measured by every setting, against its limits.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "pivnp/core/error.hpp"
#include "tests/bench/piv/bench.hpp"
#include "tests/support/piv_results.hpp"
#include "tests/support/piv_rows.hpp"
#include "tests/support/piv_score.hpp"

namespace pivnp::bench {

namespace {

using namespace pivnp::piv;

struct File {
  std::FILE* stream = nullptr;
  explicit File(const std::string& path) {
    if (!path.empty() && (stream = std::fopen(path.c_str(), "w")) == nullptr)
      throw InputError(path + ": cannot be written");
  }
  ~File() {
    if (stream) std::fclose(stream);
  }
};

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::string mark(double over) {
  if (over == 0) return "";
  if (over <= 1) return "ok";
  char text[32];
  std::snprintf(text, sizeof text, std::isinf(over) ? "MISS" : "MISS x%.2f", over);
  return text;
}

void print_row(const RowResult& j, double slack) {
  const auto limit = [](double value, const char* format) {
    char text[32] = "";
    if (value > 0) std::snprintf(text, sizeof text, format, value);
    return std::string(text);
  };
  const auto figure = [&](double value, const char* format) {
    return std::isnan(value) ? std::string() : limit(std::max(value, 1e-9), format);
  };
  std::printf("%-23s %7.4f %7s %7.4f %7.4f %7s %6.1f %6s %6.1f %6s %5s %6s %5s %4.0f %4.0f %7.4f %9.0f  %s\n",
              j.name.c_str(), j.rms, limit(slack * j.limits.rms, "%.4f").c_str(), j.rms_sum / j.count, j.bias,
              limit(slack * j.limits.bias, "%.4f").c_str(), 100 * j.valid, limit(100 * j.limits.valid, "%.0f").c_str(),
              100 * (1 - j.valid), figure(j.gain, "%.3f").c_str(),
              limit(j.limits.gain > 0 ? 1 - slack * (1 - j.limits.gain) : 0, "%.2f").c_str(),
              figure(j.width, "%.1f").c_str(), figure(j.true_width, "%.1f").c_str(), 100 * j.one / j.count,
              100 * j.two / j.count, j.sigma / j.count, median(j.rates), mark(excess(j, slack)).c_str());
}

/// Returns the number of kinds of images that miss.
int print_coverage(const std::vector<RowResult>& rows) {
  int missed = 0;
  for (const Coverage& c : coverage(rows)) {
    missed += !c.met();
    std::printf("  sigma in %-8s images: %.1f %% within one (60-76), %.1f %% within two (90-98)  %s\n", c.kind,
                100 * c.one, 100 * c.two, c.met() ? "ok" : "MISS");
  }
  return missed;
}

/// Returns true if every limit is met.
bool print_summary(const Setting& setting, const std::vector<RowResult>& rows, double slack) {
  int asked = 0, met = 0, near = 0;
  std::string missed;
  std::vector<double> rates = {};
  for (const RowResult& j : rows) {
    rates.push_back(median(j.rates));
    const double over = excess(j, slack);
    if (over == 0) continue;
    ++asked, met += over <= 1, near += over > 1 && over <= 1.25;
    if (over > 1) missed += (missed.empty() ? "" : ", ") + j.name;
  }
  std::printf("%s: %d of %d rows met, %d more missed by at most a quarter%s%s\n", setting.name.c_str(), met, asked,
              near, missed.empty() ? "" : "; missed: ", missed.c_str());
  const int coverage = print_coverage(rows);
  std::printf(
      "  vectors/s: median over rows %.0f, slowest row %.0f (asked of the default on one core: 120000, 70000)\n\n",
      median(rates), *std::min_element(rates.begin(), rates.end()));
  return asked == met && coverage == 0;
}

Figures measure(PairCorrelator& correlator, const image::SyntheticPair& pair, const NodeLattice& nodes, const Row& row,
                const BenchOptions& options) {
  const int repeats = options.repeats;
  std::vector<double> seconds;
  PixelVectors found;
  for (int n = 0; n < repeats + (repeats > 1); ++n) {  // the first also fills buffers: not counted if there are others
    const double start = now(options);
    found = correlator.correlate(pair.first.view(), pair.second.view(), {});
    if (n > 0 || repeats == 1) seconds.push_back(now(options) - start);
  }
  Figures f{.e = errors(pair, nodes, found, row.scored)};
  f.rate = static_cast<double>(nodes.pixel.size()) / median(seconds);
  if (row.band_half_width > 0) f.width = band_width(pair, nodes, found, row.band_amplitude, row.band_half_width);
  return f;
}

bool wanted(const Row& row, const std::vector<std::string>& parts) {
  const auto matches = [&](std::string part) {
    const bool start = part.starts_with('^'), end = part.ends_with('$');
    part = part.substr(start, part.size() - start - end);
    return start && end ? row.name == part
           : start      ? row.name.starts_with(part)
           : end        ? row.name.ends_with(part)
                        : row.name.find(part) != std::string::npos;
  };
  return parts.empty() || std::any_of(parts.begin(), parts.end(), matches);
}

}  // namespace

int table(const BenchOptions& options) {
  options.print_head();
  const NodeLattice nodes = even_nodes(options.side, options.side, options.spacing, options.margin);
  std::printf("%d x %d nodes scored and timed; median of %d repeats\n\n", nodes.nx, nodes.ny, options.repeats);
  File csv(options.csv);
  if (csv.stream)
    std::fprintf(csv.stream,
                 "setting,method,window_px,anchor,threads,side,spacing,texture,blob_px,seed,row,kind,asked_px,rms_px,"
                 "bias_px,valid,flagged,gain,width_px,true_width_px,within_one,within_two,sigma_px,vectors_per_s\n");
  std::vector<Row> rows = piv_rows(options.side, options.more);
  std::erase_if(rows, [&](const Row& row) { return !wanted(row, options.rows); });
  if (rows.empty()) throw InputError("--rows: found no row of these names, expected at least one");

  std::vector<std::vector<RowResult>> found(options.settings.size());
  std::vector<std::unique_ptr<PairCorrelator>> correlators;
  for (const Setting& s : options.settings)
    correlators.push_back(
        std::make_unique<PairCorrelator>(s.options, nodes, options.side, options.side, options.threads));
  for (const Row& row : rows)
    for (const int seed : options.seeds) {
      image::TextureOptions texture = row.texture(options.texture);
      texture.seed = seed;
      const image::SyntheticPair pair = image::synthetic_pair(row.motion, options.side, options.side, texture);
      for (std::size_t s = 0; s < options.settings.size(); ++s) {
        RowResult& j = result_of(found[s], row);
        const Figures f = measure(*correlators[s], pair, nodes, row, options);
        j.add(f);
        if (!csv.stream) continue;
        const PivOptions& o = options.settings[s].options;
        const std::string anchor(name_of(o.anchor)), kind(name_of(texture.kind));
        std::fprintf(csv.stream,
                     "%s,%s,%d,%s,%d,%d,%d,%s,%g,%d,%s,%d,%g,%.6f,%.6f,%.5f,%.5f,%.5f,%.3f,%.3f,%.4f,%.4f,%.6f,%.0f\n",
                     options.settings[s].name.c_str(), o.method.c_str(), o.window_px, anchor.c_str(),
                     options.threads, options.side, options.spacing, kind.c_str(), texture.blob_diameter_px,
                     seed, row.name.c_str(), static_cast<int>(row.kind), row.clean_row.empty() ? row.limits.rms : NAN,
                     f.e.rms, f.e.bias, f.e.valid, 1 - f.e.valid, f.e.gain, f.width, j.true_width, f.e.within_one,
                     f.e.within_two, f.e.sigma, f.rate);
        std::fflush(csv.stream);
      }
    }

  bool met = true;
  for (std::size_t s = 0; s < found.size(); ++s) {
    const PivOptions& o = options.settings[s].options;
    std::printf("%s (%s anchor, window %d px%s)\n", options.settings[s].name.c_str(),
                std::string(name_of(o.anchor)).c_str(), o.window_px,
                options.slack() > 1 ? "; limits doubled for this texture" : "");
    std::printf("%-23s %7s %7s %7s %7s %7s %6s %6s %6s %6s %5s %6s %5s %4s %4s %7s %9s\n", "case", "rms", "limit",
                "mean", "bias", "limit", "valid%", "limit", "flag%", "gain", "limit", "width", "true", "1s%", "2s%",
                "sigma", "vectors/s");
    for (RowResult& j : found[s]) {
      resolve(j, found[s], options.slack());
      print_row(j, options.slack());
    }
    const bool all = print_summary(options.settings[s], found[s], options.slack());
    met = met && (all || o.method != "default");
  }
  return met ? 0 : 3;
}

}  // namespace pivnp::bench

// Metrics of strain over the particles.
#include <cmath>

#include "compare/metrics/families.hpp"
#include "compare/metrics/rows.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

// What single members of the family have beside its facts.
const OwnFacts& strain_members() {
  static const OwnFacts list{{"strain_dev_rms", {"strain_rms", Leads::levelled_too}},
                             {"strain_dev_p95", {"strain_p95", Leads::yes}},
                             {"strain_dev_rms_final", {"", Leads::yes}}};
  return list;
}

// Root mean square of the first's deviatoric strain at the end.
double size_of_strain(const Findings& f) {
  double sum = 0;
  std::size_t count = 0;
  for (const double dev : f.differences.last_particles().dev_first)
    if (std::isfinite(dev)) {
      sum += dev * dev;
      ++count;
    }
  return count == 0 ? not_known : std::sqrt(sum / double(count));
}

struct ScalarStatistic {
  const char *name, *words, *definition;
  double (*value)(const ScalarStatistics&);
  double (*own)(const ScalarStatistics&);  // uncertainty by the particles' own
  const char* how;                         // that is found
  double (*factor)(std::size_t);
};
constexpr ScalarStatistic scalar_statistics[] = {
    {"bias", "mean", "mean of ", [](const ScalarStatistics& s) { return s.bias(); },
     [](const ScalarStatistics& s) { return s.rms_uncertainty(); }, "root mean square over the particles", two},
    {"rms", "RMS", "root mean square of ", [](const ScalarStatistics& s) { return s.rms(); },
     [](const ScalarStatistics& s) { return s.rms_uncertainty(); }, "root mean square over the particles", two},
    {"p95", "95th percentile", "95th percentile (nearest rank) of the size of ",
     [](const ScalarStatistics& s) { return s.p95(); }, [](const ScalarStatistics& s) { return s.p95_uncertainty(); },
     "95th percentile over the particles", percentile_factor},
    {"max", "maximum", "greatest size of ", [](const ScalarStatistics& s) { return s.max(); },
     [](const ScalarStatistics& s) { return s.max_uncertainty(); }, "where it occurs", greatest_factor}};

struct StrainSubject {
  const char *name, *words, *definition;
  ScalarStatistics Tally::*statistics;
  double Tally::*floor;
  double Tally::*rest;
  int axis;  // of the strains whose mean knows how far errors are shared; -1: none

  // By how far errors are shared; nothing where that is not known.
  std::optional<double> mean_u(const ScalarStatistic& s, const Span& span, const Findings& f) const {
    if (axis < 0 || std::string_view(s.name) != "bias" || f.strain.empty()) return std::nullopt;
    const std::optional<Vec2> u = f.differences.mean_strain_uncertainty(span.last);
    return u ? std::optional((*u)[axis]) : std::nullopt;
  }
  double uncertainty(const ScalarStatistic& s, const Span& span, const Findings& f) const {
    const Tally& t = span.tally(f);
    return strain_uncertainty(mean_u(s, span, f).value_or(s.own(t.*statistics)), t.*rest, t.*floor);
  }
  // The gradients of tracked particles have the long tails of their paths.
  double factor(const ScalarStatistic& s, const Findings& f, std::size_t count) const {
    const bool tracked = axis >= 0 && !f.strain.empty() && s.factor == greatest_factor;
    return tracked ? greatest_of_paths_factor(count) : s.factor(count);
  }
};
constexpr StrainSubject strains[] = {
    {"strain_dev", "deviatoric strain", "deviatoric log strain of the second minus that of the first",
     &Tally::strain_dev, &Tally::floor_dev, &Tally::rest_dev, 0},
    {"strain_vol", "volumetric strain", "volumetric log strain ln J of the second minus that of the first",
     &Tally::strain_vol, &Tally::floor_vol, &Tally::rest_vol, 1},
    {"strain_dev_path", "deviatoric strain along the path",
     "deviatoric strain along the path (sum of sqrt(2/3 de:de) over the common times) of the second minus that of the "
     "first",
     &Tally::strain_path, &Tally::floor_path, &Tally::rest_path, -1}};

std::string strain_text(const Findings& f, const StrainSubject& strain, const ScalarStatistic& s, const Span& span) {
  const std::string floor = "noise floor, the root mean square of this strain where nothing moves, of " + f.floor +
                            (span.last ? "" : ", greatest over the times");
  const Tally& t = span.tally(f);
  if (std::isnan(strain.uncertainty(s, span, f)))
    return std::string("; uncertainty not known: ") +
           (std::isnan(t.*strain.rest)
                ? "noise floor not measured (np.still_zone_m, np.still_frames or compare.fixed_zone_m would tell it)"
                : "the covariance of F is not known everywhere");
  if (f.strain.empty() || strain.axis < 0) return "; uncertainty: " + floor;
  std::string text = "; uncertainty: " + f.strain + ", ";
  text += strain.mean_u(s, span, f) ? "of a mean of random errors that are shared over " + shared_over(f)
                                    : std::string(s.how);
  if (t.*strain.rest > 0)
    text += ", and " + floor;
  else if (std::isfinite(t.*strain.floor))
    text += "; at least the " + floor;
  return text;
}

void add_strain(Registry<MetricRow>& rows, const Span& span) {
  for (const StrainSubject& strain : strains) {
    const auto facts = [&](const ScalarStatistic& s) {
      return MetricFacts{.name = std::string(strain.name) + "_" + s.name + span.suffix,
                         .unit = "1",
                         .definition = s.definition + std::string(strain.definition),
                         .words = std::string(strain.words) + ", difference, " + s.words + span.words,
                         .levelled = true};
    };
    for (const ScalarStatistic& s : scalar_statistics)
      rows.add({with_own(facts(s), strain_members()), [=](const Findings& f) -> std::optional<MetricValue> {
                  const ScalarStatistics& d = span.tally(f).*strain.statistics;
                  if (d.count() == 0) return std::nullopt;
                  MetricValue found =
                      difference(s.value(d), strain.uncertainty(s, span, f),
                                 span.when(f) + strain_text(f, strain, s, span), strain.factor(s, f, d.count()));
                  if (strain.axis == 0) found.scale = size_of_strain(f);
                  return found;
                }});
    for (const ScalarStatistic& s : scalar_statistics) {
      MetricFacts over_u = facts(s);
      over_u.name += "_over_u";
      over_u.words += ", in units of its uncertainty";
      rows.add({with_own(std::move(over_u), strain_members()), [=](const Findings& f) -> std::optional<MetricValue> {
                  const ScalarStatistics& d = span.tally(f).*strain.statistics;
                  const double u = d.count() == 0 ? 0 : strain.uncertainty(s, span, f);
                  if (!(u > 0)) return std::nullopt;
                  return MetricValue{s.value(d) / u, not_known, span.when(f) + ", over its standard uncertainty"};
                }});
    }
  }
}

// The verdict over the field of strain at the end, as that of the displacement.
void add_strain_field(Registry<MetricRow>& rows) {
  struct Strain {
    const char *name, *words;
    double Tally::*floor;
  };
  static constexpr Strain fields[] = {{"strain_dev", "deviatoric", &Tally::floor_dev},
                                      {"strain_vol", "volumetric", &Tally::floor_vol}};
  static const std::string weights =
      " of its difference, weights 1/max(u_p, median u)^2 with u_p the particle's own uncertainty";
  for (int k = 0; k < 2; ++k) {
    const Strain& strain = fields[k];
    const std::string words = std::string(strain.words) + " strain over the field, ",
                      of = std::string(strain.words) + " log strain: ";
    rows.add({{.name = std::string(strain.name) + "_field_rms",
               .unit = "1",
               .definition = of + "weighted root mean square" + weights,
               .words = words + "weighted RMS",
               .levelled = true},
              [k, strain](const Findings& f) -> std::optional<MetricValue> {
                const auto w = f.differences.weighted_strain(k);
                if (!w) return std::nullopt;
                MetricValue found = difference(w->rms, strain_uncertainty(w->rms_uncertainty, 0, f.last().*strain.floor),
                                               ", " + f.at_end + "; uncertainty: " + f.strain + " by the same weights");
                if (k == 0) found.scale = size_of_strain(f);
                return found;
              }});
    rows.add({{.name = std::string(strain.name) + "_field_mean",
               .unit = "1",
               .definition = of + "weighted mean" + weights,
               .words = words + "weighted mean",
               .levelled = true},
              [k](const Findings& f) -> std::optional<MetricValue> {
                const auto w = f.differences.weighted_strain(k);
                if (!w || !std::isfinite(w->uncertainty[0])) return std::nullopt;
                MetricValue found = difference(w->mean[0], w->uncertainty[0],
                                               ", " + f.at_end + "; uncertainty: random errors shared over " +
                                                   shared_over(f) + ", others everywhere");
                if (k == 0) found.scale = size_of_strain(f);
                return found;
              }});
  }
}

}  // namespace

void add_strain_rows(Registry<MetricRow>& rows) {
  add_strain(rows, all_times);
  add_strain(rows, last_time);
  add_strain_field(rows);
}

}  // namespace pivnp::compare

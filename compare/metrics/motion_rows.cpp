// Metrics of displacement and velocity over the particles, and of what they are uncertain by.
#include "compare/metrics/families.hpp"
#include "compare/metrics/rows.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

// What single members of the families below have beside their family's facts.
const OwnFacts& motion_members() {
  static const OwnFacts list{{"displacement_bias_x", {"displacement_bias_m", Leads::no}},
                             {"displacement_bias_y", {"displacement_bias_m", Leads::no}},
                             {"displacement_rms", {"displacement_rms_m", Leads::levelled_too}},
                             {"displacement_p95", {"displacement_p95_m", Leads::yes}},
                             {"displacement_max", {"displacement_max_m", Leads::yes}},
                             {"displacement_rms_over_u", {"displacement_over_u", Leads::no}},
                             {"displacement_bias_x_final", {"", Leads::yes}},
                             {"displacement_bias_y_final", {"", Leads::yes}},
                             {"displacement_rms_final", {"", Leads::yes}},
                             {"displacement_rms_final_relative", {"", Leads::yes}},
                             {"velocity_rms", {"velocity_rms_m_s", Leads::yes}},
                             {"u_val", {"", Leads::yes}}};
  return list;
}

template <class Value>
void add(Registry<MetricRow>& rows, MetricFacts facts, Value value) {
  rows.add({with_own(std::move(facts), motion_members()), std::move(value)});
}

// One statistic of a vector's difference; '#' stands for the vector: u or v.
struct VectorStatistic {
  const char *name, *words, *definition;
  double (*value)(const VectorStatistics&);
  double (*uncertainty)(const VectorStatistics&);
  const char* how;                            // the uncertainty is found
  double (*factor)(std::size_t);              // so many uncertainties are told apart
  double (*own_u)(const ScalarStatistics&);   // of sizes in units of the particles' own uncertainties; nullptr: none
  const char* told_apart = "";                // goes on in `how` with the factor
  int axis = -1;                              // of a mean: its component
};

constexpr VectorStatistic vector_statistics[] = {
    {"bias_x", "mean in x", "mean of #_x of the second minus that of the first",
     [](const VectorStatistics& d) { return d.bias().x(); },
     [](const VectorStatistics& d) { return d.bias_uncertainty().x(); },
     "root mean variance of #_x, all errors assumed to be equal", two, nullptr, "", 0},
    {"bias_y", "mean in y", "mean of #_y of the second minus that of the first",
     [](const VectorStatistics& d) { return d.bias().y(); },
     [](const VectorStatistics& d) { return d.bias_uncertainty().y(); },
     "root mean variance of #_y, all errors assumed to be equal", two, nullptr, "", 1},
    {"rms", "RMS", "root mean square of |#_second - #_first|", [](const VectorStatistics& d) { return d.rms(); },
     [](const VectorStatistics& d) { return d.rms_uncertainty(); }, "root mean trace of its variance", two,
     [](const ScalarStatistics& s) { return s.rms(); }},
    {"p95", "95th percentile", "95th percentile of |#_second - #_first| (nearest rank)",
     [](const VectorStatistics& d) { return d.p95(); }, [](const VectorStatistics& d) { return d.p95_uncertainty(); },
     "95th percentile of the root trace of its variance", percentile_factor,
     [](const ScalarStatistics& s) { return s.p95(); }, "; it counts only beyond "},
    {"max", "maximum", "greatest |#_second - #_first|", [](const VectorStatistics& d) { return d.max(); },
     [](const VectorStatistics& d) { return d.max_uncertainty(); }, "root trace of its variance where it occurs",
     greatest_of_paths_factor, [](const ScalarStatistics& s) { return s.max(); },
     "; the greatest of so many errors counts only beyond "}};

// A vector whose differences are counted.
struct VectorSubject {
  std::string name, symbol, unit;
  Span span;
  std::string note;  // how it is found
  std::function<const VectorStatistics&(const Findings&)> statistics;
  // Of the mean, by how far errors are shared; nothing where that is not known.
  std::function<std::optional<Vec2>(const Findings&)> mean_uncertainty = {};

  std::optional<Vec2> mean_u(const VectorStatistic& s, const Findings& f) const {
    if (s.axis < 0 || !mean_uncertainty) return std::nullopt;
    return mean_uncertainty(f);
  }
  double uncertainty(const VectorStatistic& s, const Findings& f) const {
    const std::optional<Vec2> u = mean_u(s, f);
    return u ? (*u)[s.axis] : s.uncertainty(statistics(f));
  }
  std::string of(std::string text) const {
    for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#')) text.replace(at, 1, symbol);
    return text;
  }
  std::string when(const Findings& f) const { return span.when(f) + note; }
  std::string how(const VectorStatistic& s, const Findings& f, const std::string& over = "") const {
    if (f.covariance.empty()) return "; uncertainty not known: neither motion carries a covariance";
    std::string text =
        "; uncertainty: " + (mean_u(s, f) ? "of a mean of random errors that are shared over " + shared_over(f) +
                                                ", and of errors that are the same everywhere"
                                          : of(s.how));
    if (*s.told_apart != 0) text += s.told_apart + number(s.factor(statistics(f).count()), 3) + " of them";
    return text + over + ", " + f.covariance;
  }
  MetricFacts facts(const VectorStatistic& s) const {
    return {.name = name + "_" + s.name + span.suffix, .unit = unit, .definition = of(s.definition),
            .words = name + " difference, " + s.words + span.words, .levelled = true};
  }
};

void add_values(Registry<MetricRow>& rows, const VectorSubject& subject) {
  for (const VectorStatistic& s : vector_statistics)
    add(rows, subject.facts(s), [=](const Findings& f) -> std::optional<MetricValue> {
      const VectorStatistics& d = subject.statistics(f);
      if (d.count() == 0) return std::nullopt;
      return difference(s.value(d), subject.uncertainty(s, f), subject.when(f) + subject.how(s, f), s.factor(d.count()));
    });
}

void add_values_over_u(Registry<MetricRow>& rows, const VectorSubject& subject) {
  for (const VectorStatistic& s : vector_statistics) {
    MetricFacts facts = subject.facts(s);
    facts.name += "_over_u";
    facts.unit = "1";
    facts.words += ", in units of its uncertainty";
    add(rows, std::move(facts), [=](const Findings& f) -> std::optional<MetricValue> {
      const VectorStatistics& d = subject.statistics(f);
      const ScalarStatistics& scaled = d.over_uncertainty();
      const double own = s.own_u && scaled.count() > 0 ? s.own_u(scaled) : not_known;
      if (std::isfinite(own))
        return MetricValue{own, not_known,
                           subject.when(f) +
                               ", each divided first by the particle's own standard uncertainty at that time"};
      const double u = d.count() == 0 ? 0 : subject.uncertainty(s, f);
      if (!(u > 0)) return std::nullopt;
      return MetricValue{s.value(d) / u, not_known, subject.when(f) + ", over its standard uncertainty"};
    });
  }
}

void add_relative_values(Registry<MetricRow>& rows, const VectorSubject& subject) {
  for (const VectorStatistic& s : vector_statistics) {
    MetricFacts facts = subject.facts(s);
    facts.name += "_relative";
    facts.unit = "1";
    facts.words += ", relative to the greatest displacement";
    add(rows, std::move(facts), [=](const Findings& f) -> std::optional<MetricValue> {
      const VectorStatistics& d = subject.statistics(f);
      const double peak = f.total().peak_first;
      if (!(peak > 0)) return std::nullopt;
      return difference(s.value(d) / peak, subject.uncertainty(s, f) / peak,
                        subject.when(f) + ", over the greatest displacement of the first (displacement_peak_first)" +
                            subject.how(s, f, ", over the same"),
                        s.factor(d.count()));
    });
  }
}

void add_displacement(Registry<MetricRow>& rows, const Span& span) {
  const VectorSubject u{"displacement", "u", "L", span, "",
                        [span](const Findings& f) -> const VectorStatistics& { return span.tally(f).displacement; },
                        [span](const Findings& f) { return f.differences.mean_uncertainty(span.last); }};
  add_values(rows, u);
  add_values_over_u(rows, u);
  add_relative_values(rows, u);
}

// The verdict over the field at the end: what is badly known counts little.
void add_field(Registry<MetricRow>& rows) {
  static const std::string weights = " of u_second - u_first, weights 1/max(u_p, median u)^2 with u_p the particle's u_val";
  rows.add({{.name = "displacement_field_rms", .unit = "L", .definition = "weighted root mean square" + weights,
             .words = "displacement over the field, weighted RMS", .levelled = true},
            [](const Findings& f) -> std::optional<MetricValue> {
              const auto w = f.differences.weighted();
              if (!w) return std::nullopt;
              return difference(w->rms, w->rms_uncertainty, ", " + f.at_end + "; uncertainty: u_val by the same weights");
            }});
  for (int axis = 0; axis < 2; ++axis)
    rows.add({{.name = axis == 0 ? "displacement_field_x" : "displacement_field_y", .unit = "L",
               .definition = std::string("weighted mean of the ") + (axis == 0 ? "x" : "y") + " component" + weights,
               .words = std::string("displacement over the field, weighted mean in ") + (axis == 0 ? "x" : "y"), .levelled = true},
              [axis](const Findings& f) -> std::optional<MetricValue> {
                const auto w = f.differences.weighted();
                if (!w || !std::isfinite(w->uncertainty[axis])) return std::nullopt;
                return difference(w->mean[axis], w->uncertainty[axis],
                                  ", " + f.at_end + "; uncertainty: random errors shared over " + shared_over(f) +
                                      ", others everywhere");
              }});
}

void add_velocity(Registry<MetricRow>& rows) {
  const std::string note = ", velocities by central differences of u over the common times on both data sets";
  const VectorSubject v{"velocity", "v", "L/T", all_times, note,
                        [](const Findings& f) -> const VectorStatistics& { return f.rates().velocity(); }};
  add_values(rows, v);
  add_values_over_u(rows, v);
  add(rows,
      {.name = "velocity_peak_first", .unit = "L/T", .definition = "greatest |v| of the first",
       .words = "velocity, greatest, measured", .levelled = true},
      [=](const Findings& f) -> std::optional<MetricValue> {
        if (f.rates().velocity().count() == 0) return std::nullopt;
        return MetricValue{f.rates().peak_first(), not_known, v.when(f)};
      });
}

void add_peaks(Registry<MetricRow>& rows) {
  const auto note = [](const Findings& f) {
    return all_times.when(f) + "; uncertainty: root trace of the covariance of u there, where known";
  };
  add(rows,
      {.name = "displacement_peak_first", .unit = "L", .definition = "greatest |u| of the first",
       .words = "displacement, greatest, measured", .levelled = true},
      [=](const Findings& f) { return MetricValue{f.total().peak_first, f.total().peak_first_sigma, note(f)}; });
  add(rows,
      {.name = "displacement_peak_second", .unit = "L", .definition = "greatest |u| of the second",
       .words = "displacement, greatest, simulated", .levelled = true},
      [=](const Findings& f) { return MetricValue{f.total().peak_second, f.total().peak_second_sigma, note(f)}; });
}

void add_uncertainty(Registry<MetricRow>& rows, const Span& span) {
  add(rows,
      {.name = std::string("u_val") + span.suffix, .unit = "L",
       .definition = "standard uncertainty of E = u_second - u_first (ASME V&V 20): u_val^2 = u_measurement^2 + "
                     "u_numerical^2 + u_input^2, of those parts that are known; root mean square over particles of the "
                     "root trace",
       .words = std::string("uncertainty of a difference, u_val") + span.words, .levelled = true},
      [span](const Findings& f) {
        return MetricValue{span.tally(f).displacement.rms_uncertainty(), not_known, span.when(f)};
      });
  const auto part = [&](const char* name, const char* words, const char* definition, double Tally::*sum) {
    add(rows,
        {.name = std::string(name) + span.suffix, .unit = "L",
         .definition = std::string(definition) + ", root mean square over particles of the root trace",
         .words = std::string(words) + span.words},
        [span, sum](const Findings& f) {
          const Tally& tally = span.tally(f);
          return MetricValue{tally.rms_part(tally.*sum), not_known, span.when(f)};
        });
  };
  part("u_measurement", "part of u_val from the measurement",
       "part of u_val from the measurements: random error of the displacements, camera, gauge and the frame of reference",
       &Tally::sum_measurement);
  part("u_numerical", "part of u_val from the numerics",
       "part of u_val from the simulation's grid and time step: GCI / 1.15 by coarser grids (out of the asymptotic range, "
       "and with one grid, their range), or as given; 0 where neither was given",
       &Tally::sum_numerical);
  part("u_input", "part of u_val from the inputs",
       "part of u_val from the model's inputs, as given; 0 where it was not", &Tally::sum_input);
}

}  // namespace

void add_motion_rows(Registry<MetricRow>& rows) {
  add_displacement(rows, all_times);
  add_displacement(rows, last_time);
  add_field(rows);
  add_peaks(rows);
  add_uncertainty(rows, all_times);
  add_uncertainty(rows, last_time);
  add_velocity(rows);
}

}  // namespace pivnp::compare

#include "apps/report/words/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/selection.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

// A number with its unit, in one that suits it: "14.0 mm".
std::string amount(double value, const std::string& unit, int digits = 3) {
  const DisplayUnit shown = display_unit(unit, std::abs(value));
  return significant(value * shown.factor, digits) + unit_suffix(shown.name);
}

struct Source {
  const char *quantity, *difference, *first, *second;  // metrics; nullptr: there is none
};
constexpr Source sources[] = {
    {"Displacement at the end, RMS difference", "displacement_rms_final", nullptr, nullptr},
    {"Deviatoric strain at the end, RMS difference", "strain_dev_rms_final", nullptr, nullptr},
    {"Run-out", "run_out_x_difference", "run_out_x_first", "run_out_x_second"},
    {"Slope angle", "slope_angle_difference", "slope_angle_first", "slope_angle_second"},
    {"Crest retreat", "crest_retreat_difference", "crest_retreat_first", "crest_retreat_second"},
    {"Outline, distance (95th percentile)", "outline_hausdorff_95", nullptr, nullptr},
    {"Onset of motion, first point", "point_1_onset_difference", "point_1_onset_first", "point_1_onset_second"},
    {"Velocity, RMS difference", "velocity_rms", nullptr, nullptr}};

// The mean over the particles compared at the last time, which the first row stands beside.
double last_mean(const Comparison& c, std::string_view column) {
  const ComparisonTable* table = c.table(over_space_table);
  const ComparisonTable::Column* found = table == nullptr ? nullptr : find(*table, column);
  return found == nullptr || found->values.empty() ? nan_value : found->values.back();
}

std::string how_far(const Content& content, const DataSetNames& names, const Metric& rms) {
  const Metric* peak = find(content.comparison->metrics, "displacement_peak_first");
  std::string text = (names.alike ? "The two motions" : "Simulation and measurement") + std::string(" differ by ") +
                     amount(rms.value, rms.unit) + " in displacement (RMS)";
  if (peak != nullptr && peak->value > 0)
    text += ", " + percent(rms.value / peak->value) + " of the greatest " + names.first + " displacement";
  return text + ".";
}

std::string when_and_where(const Content& content, const Worst& worst) {
  if (!std::isfinite(worst.rms)) return "";
  std::string text = " The difference is largest at " + plain(worst.time) + unit_suffix(content.time_unit) + ", " +
                     amount(worst.rms, content.length_unit);
  if (worst.place.allFinite())
    text += ", and there around (" + plain(worst.place.x()) + ", " + plain(worst.place.y()) + ")" +
            unit_suffix(content.length_unit);
  return text + ".";
}

// Parts of u_val that nobody gave.
struct Missing {
  bool mesh = false, inputs = false;
  bool any() const { return mesh || inputs; }
};

Missing missing_parts(const std::vector<Metric>& metrics, const DataSetNames& names) {
  const auto missing = [&](const char* part) {
    const Metric* m = find(metrics, part);
    return m == nullptr || !(m->value > 0);
  };
  if (names.alike) return {};
  return {missing("u_numerical"), missing("u_input")};
}

std::string times(const Metric& m) { return significant(std::abs(m.value) / m.uncertainty, 2); }

// By what a difference is not resolved, and what would resolve it.
std::string lost_words(const Metric& m) {
  switch (m.lost_in) {
    case LostIn::mesh: return "by the mesh: finer cells would tell";
    case LostIn::inputs: return "by the uncertainty of the model\u2019s inputs: tests of the material would tell";
    case LostIn::measurement: return "by the measurement: larger images of the grains, or less noise, would tell";
    case LostIn::nothing: break;
  }
  return "by what it is uncertain by";
}

std::string could_tell(const Metric& m, const DataSetNames& names, const Missing& missing) {
  const std::string u = amount(m.uncertainty, m.unit, 2);
  const auto within = [&] { return amount(m.within(), m.unit, 2); };
  switch (m.verdict) {
    case Verdict::differs:
      return " They differ by more than all that is known to be uncertain: " + times(m) + " times u_val = " + u + ".";
    case Verdict::larger: {
      const bool mesh = missing.mesh && !std::isfinite(m.numerical), inputs = missing.inputs && !std::isfinite(m.input);
      std::string unknown = mesh ? "the mesh" : "";
      if (inputs) unknown += std::string(mesh ? " and of " : "") + "the model\u2019s inputs";
      return " That is " + times(m) + " times " + (mesh || names.alike ? "the measurement\u2019s error, " : "the errors of measurement and mesh, ") + u +
             (unknown.empty() ? std::string(".") : "; the part of " + unknown + " in it is not known.");
    }
    case Verdict::agrees:
      return " They agree within " + within() + " (95 %): u_val is " + u + ", and a difference of " +
             amount(m.seen(), m.unit, 2) + " would have been found in 95 of 100 cases.";
    case Verdict::not_resolved:
      return " Whether that is a difference is not resolved " + lost_words(m) + ". u_val is " + u +
             (std::isfinite(m.numerical) ? ", " + amount(m.numerical, m.unit, 2) + " of it by the mesh" : std::string()) +
             "; a difference of " + amount(m.seen(), m.unit, 2) + " would have been found in 95 of 100 cases.";
    case Verdict::withheld:
      return " Too little of the material was compared for a verdict (compare.verdict_coverage).";
    case Verdict::none: break;
  }
  return " There is no verdict: " +
         (names.alike ? std::string("their uncertainty") : "the uncertainty of " + names.the_first) + " is not known.";
}

// What many particles tell together, where each alone tells nothing.
std::string on_average(const std::vector<Metric>& metrics, const Metric& rms) {
  if (rms.verdict != Verdict::agrees && rms.verdict != Verdict::not_resolved) return "";
  std::string text;
  for (const char* axis : {"x", "y"}) {
    const Metric* mean = find(metrics, std::string("displacement_field_") + axis);
    if (mean == nullptr || !mean->told_apart()) continue;
    text += (text.empty() ? " That holds particle by particle; on average over the material, at the end, the difference is " : " and ") +
            amount(mean->value, mean->unit, 2) + " in " + axis + ", " + times(*mean) + " times what errors would give";
  }
  return text.empty() ? text : text + ".";
}

std::string strains(const Metric& rms) {
  if (!std::isfinite(rms.value)) return "";
  std::string text = " The deviatoric strains differ by " + significant(rms.value, 3) + " (RMS)";
  const std::string u = significant(rms.uncertainty, 2);
  switch (rms.verdict) {
    case Verdict::differs:
    case Verdict::larger: return text + ", " + times(rms) + " times their uncertainty (" + u + ").";
    case Verdict::agrees: return text + ": they agree within " + significant(rms.within(), 2) + ".";
    case Verdict::not_resolved: return text + ", not resolved " + lost_words(rms) + " (uncertainty " + u + ").";
    case Verdict::withheld: return text + ".";
    case Verdict::none: break;
  }
  return text + "; without a verdict, since the noise floor of the strain is not known (np.still_zone_m, np.still_frames "
                "or compare.fixed_zone_m in the case would give it).";
}

// What would give the parts of u_val that nobody gave.
std::string not_included(const Missing& missing) {
  std::string text;
  if (missing.mesh)
    text += "the error of the mesh (compare.mesh_study = 2 in the case and pivnp run, or pivnp compare --coarser, adds it)";
  if (missing.inputs)
    text += std::string(text.empty() ? "" : " and ") +
            "the uncertainty of the model\u2019s inputs (compare.input_uncertainty_m)";
  return text.empty() ? "" : " Not in these uncertainties: " + text + ".";
}

// What became of each limit; of a comparison that holds its verdicts alone, by its metrics.
std::vector<std::pair<std::string, bool>> limits_of(const Comparison& c) {
  std::vector<std::pair<std::string, bool>> list;
  for (const LimitResult& limit : c.limits)
    list.emplace_back("compare.limits." + limit.key + " is exceeded: found " + significant(limit.reached, 3) +
                          ", the limit is " + significant(limit.limit, 3), limit.met);
  if (list.empty())
    for (const Metric& m : c.metrics)
      if (m.limit != LimitFate::none)
        list.emplace_back("of " + m.name + " is exceeded: found " + amount(m.value, m.unit), m.limit == LimitFate::met);
  return list;
}

// Limits that are met, but by less than their uncertainty would show with 95 %.
std::string not_shown(const Comparison& c) {
  std::string text;
  for (const LimitResult& limit : c.limits)
    if (limit.met && std::isfinite(limit.within) && !limit.shown())
      text += (text.empty() ? " Not shown with 95 % is " : ", ") + limit.key + " (only " + significant(limit.within, 3) + " is)";
  return text.empty() ? text : text + ".";
}

std::string limits(const Comparison& c) {
  const auto list = limits_of(c);
  if (list.empty()) return " No limit was stated for the difference ([compare.limits]).";
  const auto missed = std::count_if(list.begin(), list.end(), [](const auto& l) { return !l.second; });
  const std::string by_chance = not_shown(c);
  if (missed == 0 && list.size() < 3)
    return (list.size() == 1 ? " The limit that was stated is met." : " Both limits that were stated are met.") + by_chance;
  if (missed == 0) return " All " + std::to_string(list.size()) + " limits that were stated are met." + by_chance;
  if (list.size() == 1) return " The limit that was stated is exceeded.";
  return " " + std::to_string(missed) + " of " + count(list.size(), "limit") + " that were stated " +
         (missed == 1 ? "is" : "are") + " exceeded.";
}

// The place with most others within a fifth of their extent: in the thick of them, where they lie in several groups.
Vec2 thickest(std::vector<Vec2> places) {
  if (places.empty()) return Vec2::Constant(nan_value);
  constexpr std::size_t enough = 1500;
  const std::size_t stride = places.size() / enough + 1;
  Vec2 lower = places[0], upper = places[0];
  for (const Vec2& x : places) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  const double near = 0.2 * (upper - lower).norm();
  Vec2 best = places[0];
  std::size_t most = 0;
  for (std::size_t k = 0; k < places.size(); k += stride) {
    std::size_t others = 0;
    for (std::size_t j = 0; j < places.size(); j += stride) others += (places[j] - places[k]).norm() <= near;
    if (others > most) most = others, best = places[k];
  }
  return best;
}

}  // namespace

std::string SummaryRow::words() const {
  std::string text(name_of(verdict));
  if (verdict == Verdict::none) text = "no uncertainty";
  if (lost_in != LostIn::nothing) text += " (" + std::string(name_of(lost_in)) + ")";
  return limit == LimitFate::none ? text : text + "; limit " + std::string(name_of(limit));
}

std::vector<SummaryRow> summary_rows(const Content& content) {
  std::vector<SummaryRow> rows;
  if (!content.comparison) return rows;
  const std::vector<Metric>& metrics = content.comparison->metrics;
  const auto value = [&](const char* name) {
    const Metric* m = name == nullptr ? nullptr : find(metrics, name);
    return m == nullptr ? nan_value : m->value;
  };
  // Where one data set reaches beyond the other, their outlines tell what was looked at.
  const bool same_extent = !(value("coverage_first") < 0.9) && !(value("coverage_second") < 0.9);
  for (const Source& source : sources) {
    if (!same_extent && source.difference == std::string_view("outline_hausdorff_95")) continue;
    const Metric* difference = find(metrics, source.difference);
    if (difference == nullptr || !std::isfinite(difference->value)) continue;
    rows.push_back({source.quantity, difference->unit, value(source.first), value(source.second), difference->value,
                    difference->uncertainty, difference->factor, difference->verdict, difference->lost_in,
                    difference->limit});
    if (source.difference == std::string_view("displacement_rms_final")) {
      rows.back().first = last_mean(*content.comparison, "displacement_mean_first");
      rows.back().second = last_mean(*content.comparison, "displacement_mean_second");
    }
  }
  return rows;
}

Worst worst_of(const Content& content, const DifferenceCurve& differences) {
  Worst worst{nan_value, nan_value, Vec2::Constant(nan_value)};
  for (std::size_t k = 0; k < differences.rms.size(); ++k)
    if (std::isfinite(differences.rms[k]) && !(differences.rms[k] <= worst.rms)) worst.time = differences.time[k], worst.rms = differences.rms[k];
  const ComparisonField* field = content.comparison ? content.comparison->field("difference_magnitude") : nullptr;
  if (field == nullptr || !content.measured || !std::isfinite(worst.time)) return worst;
  const auto row = std::find(field->time.begin(), field->time.end(), worst.time);
  const auto at = frame_at(*content.measured, worst.time);
  if (row == field->time.end() || !at) return worst;
  const MotionFrame frame = content.measured->frame(*at);
  const ParticleSet& particles = content.measured->particles();
  std::unordered_map<std::int64_t, std::size_t> index;
  for (std::size_t p = 0; p < particles.size(); ++p) index[particles.id[p]] = p;
  const std::size_t n = field->id.size(), from = std::size_t(row - field->time.begin()) * n;
  const std::vector<double> values(field->values.begin() + std::ptrdiff_t(from), field->values.begin() + std::ptrdiff_t(from + n));
  const double high = quantile(values, 0.95);
  std::vector<Vec2> places;
  for (std::size_t k = 0; k < n; ++k) {
    const auto p = index.find(field->id[k]);
    if (!(values[k] >= high) || p == index.end()) continue;
    places.push_back(particles.x0[p->second] + Vec2(double(frame.u[p->second][0]), double(frame.u[p->second][1])));
  }
  worst.place = thickest(places);
  return worst;
}

std::string histories_summary(const Content& content) {
  const Metric* rms = find(content.comparison->metrics, "history_rms");
  std::string text = "Two histories were compared";
  if (const std::vector<double> span = common_span(*content.comparison); !span.empty())
    text += " between " + plain(span[0]) + " and " + plain(span[1]) + unit_suffix(content.time_unit) + ", where both are known";
  text += ". They differ by " + amount(rms->value, rms->unit) + " (RMS).";
  return text + could_tell(*rms, {true, "first", "second", "the first", "the second"}, {}) + limits(*content.comparison);
}

std::string summary(const Content& content, const DataSetNames& names, const DifferenceCurve& differences) {
  const std::vector<Metric>& metrics = content.comparison->metrics;
  const Missing missing = missing_parts(metrics, names);
  std::string text;
  const Metric* rms = find(metrics, "displacement_rms");
  if (rms != nullptr && std::isfinite(rms->value))
    text = how_far(content, names, *rms) + could_tell(*rms, names, missing) + on_average(metrics, *rms) +
           when_and_where(content, worst_of(content, differences));
  else
    text = "How far the displacements differ is not known.";
  if (const Metric* strain = find(metrics, "strain_dev_rms")) text += strains(*strain);
  return text + not_included(missing) + limits(*content.comparison);
}

std::vector<double> common_span(const Comparison& histories) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const DataSetRole role : data_set_roles) {
    const ComparisonTable* table = histories.table(history_table(role));
    if (table == nullptr || table->columns.empty() || table->columns[0].values.empty()) return {};
    const auto [least, most] = std::minmax_element(table->columns[0].values.begin(), table->columns[0].values.end());
    low = std::max(low, *least), high = std::min(high, *most);
  }
  if (!(low <= high)) return {};
  return {low, high};
}

std::vector<std::string> missed_limits(const Content& content) {
  std::vector<std::string> list;
  if (!content.comparison) return list;
  for (const auto& [limit, met] : limits_of(*content.comparison))
    if (!met) list.push_back("The limit " + limit + ".");
  return list;
}

}  // namespace pivnp::report

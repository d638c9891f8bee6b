#include "apps/study/studies/histories.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "apps/study/pipeline/record/outcome.hpp"
#include "compare/measures/history.hpp"
#include "compare/metrics/limits.hpp"
#include "compare/metrics/rows.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

struct NamedHistory {
  compare::TimeHistory history;
  std::string name, unit, time_unit;
};

// "FILE" or "FILE:rest"; a colon inside a path that exists belongs to the path.
std::pair<std::string, std::string> file_and_rest(const std::string& text) {
  if (fs::exists(text)) return {text, ""};
  const std::size_t colon = text.find(':', text.find_last_of('/') == std::string::npos ? 0 : text.find_last_of('/'));
  return colon == std::string::npos ? std::pair{text, std::string()}
                                    : std::pair{text.substr(0, colon), text.substr(colon + 1)};
}

// x within which 99.5 % of the followed particles' area (`round`: volume about the axis) lies, counted from the left (or from
// the right).
double front(const ParticleSet& set, const MotionFrame& f, bool left, bool round) {
  std::vector<std::pair<double, double>> x;
  double area = 0;
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!alive(f.status[p])) continue;
    const double a = (p < set.area.size() && set.area[p] > 0 ? double(set.area[p]) : 1) * (round ? set.x0[p].x() : 1);
    x.emplace_back((left ? -1 : 1) * (set.x0[p].x() + double(f.u[p][0])), a);
    area += a;
  }
  std::sort(x.begin(), x.end());
  double sum = 0;
  for (const auto& [place, a] : x)
    if ((sum += a) >= 0.995 * area) return left ? -place : place;
  return std::numeric_limits<double>::quiet_NaN();
}

// Curves that are taken from a motion: how far its material reaches, to the right or to the left.
constexpr std::array fronts{NamedValue{"front", false}, NamedValue{"front_left", true}};

// nullptr: the source is none of them.
const NamedValue<bool>* front_of(const std::string& source) {
  const std::string kind = source.substr(0, source.find('='));
  const auto at = std::find_if(fronts.begin(), fronts.end(), [&](const auto& f) { return f.name == kind; });
  return at == fronts.end() || kind.size() == source.size() ? nullptr : &*at;
}

NamedHistory open_history(const std::string& text, double step_s) {
  const auto [file, rest] = file_and_rest(text.substr(text.find('=') + 1));
  if (const io::FileFormat* format = io::format_of(text)) {
    const io::Curve curve = format->read_curve(file, rest, step_s);
    return {{curve.time, curve.value}, curve.value_name, curve.value_unit, curve.time_unit};
  }
  const NamedValue<bool>& kind = *front_of(text);
  const io::RecordReader record(fs::is_directory(file) ? fs::path(file) / "record.h5" : fs::path(file));
  const std::vector<std::string> names = record.motion_names();
  if (rest.empty() && names.size() != 1)
    throw InputError(file + ": holds " + std::to_string(names.size()) + " motions; name one as FILE:motion");
  const auto motion = record.motion(rest.empty() ? names.front() : rest);
  const bool round = record.head().per_radian && motion->name() == "mpm";
  NamedHistory found;
  found.history.time = motion->times();
  found.name = std::string(kind.name) + " of " + motion->name();
  found.unit = motion->length_unit(), found.time_unit = motion->time_unit();
  for (std::size_t k = 0; k < motion->times().size(); ++k)
    found.history.value.push_back(front(motion->particles(), motion->frame(k), kind.value, round));
  return found;
}

// A column's unit stands in its head's brackets ("1" without). What differs must be converted by the options for it.
void check_units(const char* what, const NamedHistory& first, const NamedHistory& second, std::string NamedHistory::*unit, double scale,
                 const char* key) {
  const std::string &a = first.*unit, &b = second.*unit;
  if (a == b || a == "1" || b == "1" || scale != 1) return;
  throw InputError("compare: the " + std::string(what) + " of '" + first.name + "' are in '" + a + "', those of '" +
                   second.name + "' in '" + b + "'; expected the same, or " + key + " to convert the second's");
}

}  // namespace

bool is_history(const std::string& text) {
  const io::FileFormat* format = io::format_of(text);
  return (format && format->curve()) || front_of(text) != nullptr;
}

RunOutcome compare_histories(const CompareSources& sources, const compare::CompareOptions& options,
                             const compare::LimitOptions& limits, const RunSettings& settings) {
  for (const std::string* text : {&sources.first, &sources.second})
    if (!is_history(*text))
      throw InputError(*text + ": compared with a history, expected one too (" + io::formats_text(&io::FileFormat::curve) +
                       "=FILE[:COLUMN], front=RECORD)");
  const NamedHistory first = open_history(sources.first, sources.step_s);
  NamedHistory second = open_history(sources.second, sources.step_s);
  check_units("values", first, second, &NamedHistory::unit, options.second_scale, "compare.second_scale");
  check_units("times", first, second, &NamedHistory::time_unit, options.second_time_scale, "compare.second_time_scale");
  for (double& t : second.history.time) t = options.second_time_scale * t + options.time_offset_s;
  for (double& v : second.history.value) v = options.second_scale * v + options.second_shift_m[0];

  const double of_model = std::hypot(options.numerical_uncertainty_m, options.input_uncertainty_m);
  const double of_one = options.measurement_uncertainty_m.value_or(0);
  compare::HistoryErrors errors;
  if (of_one > 0 || of_model > 0)
    errors = {std::hypot(std::sqrt(2.0) * of_one, of_model), {of_one, std::hypot(of_one, of_model)}};
  const auto measures = compare::measure_histories("history", first.name, first.history, second.history, errors,
                                                   first.unit, first.time_unit);
  if (!measures) throw InputError("compare: " + sources.first + " and " + sources.second + " have no time in common");
  Comparison comparison;
  comparison.names = {sources.first, sources.second};
  comparison.metrics = compare::metrics_of(*measures);
  for (Metric& m : comparison.metrics)
    compare::judge(m, {options.numerical_uncertainty_m > 0, options.input_uncertainty_m > 0});
  comparison.limits = compare::apply_limits(limits, comparison.metrics);
  const auto table = [&](DataSetRole role, const NamedHistory& h, const std::string& definition) {
    return ComparisonTable{history_table(role), h.name + " of " + definition,
                           {{"time", first.time_unit, h.history.time}, {"value", first.unit, h.history.value}}};
  };
  comparison.tables = {table(DataSetRole::first, first, sources.first),
                       table(DataSetRole::second, second, sources.second + " (scaled and shifted as compared)")};

  const Case c = comparison_case(sources, options, limits);
  io::RecordHead head;
  head.command = settings.command;
  head.case_text = write_case(c);
  io::RecordWriter writer(settings.out, head, false);
  return finish_comparison(c, std::move(comparison), writer, settings);
}

}  // namespace pivnp::app

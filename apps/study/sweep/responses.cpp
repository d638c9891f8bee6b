#include "apps/study/sweep/responses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/pipeline/record/outcome.hpp"
#include "compare/compare.hpp"
#include "compare/metrics/rows.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double moving = 0.5;       // of the greatest displacement at the end: what counts as the material that moves
constexpr double failed_at_m = 1.0;  // mean displacement of the zone

// What one pass over the frames collects.
struct Seen {
  std::vector<double> times, distance, speed, pressure_of_zone, forward, level;
  double pressure = nan, band_pressure = nan, band_temperature = nan, temperature = nan, displacement = 0;
  double band_temperature_mean = nan;  // at the end, over points with a band
};

double last_or_nan(const std::vector<double>& values) { return values.empty() ? nan : values.back(); }

double failure_index(const Seen& s, const std::vector<double>& of) {
  for (std::size_t k = 0; k < s.distance.size(); ++k)
    if (s.distance[k] > failed_at_m) {
      if (k == 0 || of.empty()) return of.empty() ? nan : of[k];
      const double part = (failed_at_m - s.distance[k - 1]) / (s.distance[k] - s.distance[k - 1]);
      return of[k - 1] + part * (of[k] - of[k - 1]);
    }
  return nan;
}

struct Row {
  SweepResponse response;
  double (*of)(const Seen&);
};
const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {{"top_speed", "m/s", "greatest mean speed of the zone at any output time"},
       [](const Seen& s) { return s.speed.empty() ? nan : *std::max_element(s.speed.begin(), s.speed.end()); }},
      {{"run_out", "m", "mean horizontal displacement of the zone at the end"}, [](const Seen& s) { return last_or_nan(s.forward); }},
      {{"displacement", "m", "greatest displacement of a particle at the end"}, [](const Seen& s) { return s.displacement; }},
      {{"failure_time", "s", "time at which the zone has moved by 1 m"}, [](const Seen& s) { return failure_index(s, s.times); }},
      {{"failure_level", "m", "level of the water at that time"}, [](const Seen& s) { return failure_index(s, s.level); }},
      {{"peak_pressure", "Pa", "greatest pore pressure, or excess pressure with a level, of a particle at any time"}, [](const Seen& s) { return s.pressure; }},
      {{"peak_band_pressure", "Pa", "greatest pore pressure in a band at any time"}, [](const Seen& s) { return s.band_pressure; }},
      {{"temperature_rise", "K", "greatest rise of a particle's temperature at any time"}, [](const Seen& s) { return s.temperature; }},
      {{"peak_band_temperature_rise", "K", "greatest rise of temperature in a band at any time"}, [](const Seen& s) { return s.band_temperature; }},
      {{"band_temperature_rise", "K", "mean rise of temperature in the bands at the end"}, [](const Seen& s) { return s.band_temperature_mean; }},
  };
  return all;
}

constexpr std::string_view of_difference = "difference.";

Comparison compared_with(const Case& c, const std::string& against, const MotionSource& simulated, Progress& progress) {
  const OpenedMotion measured = open_motion(against, {});
  compare::CompareOptions options = c.compare;
  add_camera(measured.residual(), options);
  return compare::compare(*measured.motion, simulated, options, {}, progress, {}, {measured.note, {}});
}

double level_at(const Case& c, double time) {
  if (!c.water) return nan;
  const auto& at = c.water->level_history;
  if (at.empty()) return c.water->level_m.value_or(nan);
  std::size_t k = 0;
  while (k < at.size() && at[k][0] <= time) ++k;
  if (k == 0 || k == at.size()) return at[k == 0 ? 0 : k - 1][1];
  return at[k - 1][1] + (at[k][1] - at[k - 1][1]) * (time - at[k - 1][0]) / (at[k][0] - at[k - 1][0]);
}

void raise(double& most, double value) {
  if (std::isfinite(value) && !(most >= value)) most = value;
}

std::vector<std::size_t> zone_of(const ParticleSet& set, const std::vector<double>& box, const MotionFrame& last) {
  std::vector<std::size_t> zone;
  if (!box.empty()) {
    for (std::size_t k = 0; k < set.size(); ++k)
      if (set.x0[k].x() >= box[0] && set.x0[k].x() <= box[2] && set.x0[k].y() >= box[1] && set.x0[k].y() <= box[3]) zone.push_back(k);
    return zone;
  }
  double most = 0;
  const auto moved = [&](std::size_t k) { return std::hypot(last.u[k][0], last.u[k][1]); };
  for (std::size_t k = 0; k < set.size(); ++k)
    if (last.status[k] != ParticleStatus::ended) raise(most, moved(k));
  for (std::size_t k = 0; k < set.size(); ++k)
    if (last.status[k] != ParticleStatus::ended && moved(k) >= moving * most) zone.push_back(k);
  return zone;
}

void see(const Case& c, const MotionFrame& frame, const std::vector<std::size_t>& zone, std::size_t particles, bool last, Seen& s) {
  const FieldValues *pressure = frame.find("excess_pressure") ? frame.find("excess_pressure") : frame.find("pressure"), *in_band = frame.find("band_pressure");
  const FieldValues* width = frame.find("band_width");
  double distance = 0, speed = 0, forward = 0, of_water = 0, of_bands = 0;
  std::size_t count = 0, with_band = 0;
  for (const std::size_t k : zone) {
    if (frame.status[k] == ParticleStatus::ended || frame.status[k] == ParticleStatus::unborn) continue;
    distance += std::hypot(frame.u[k][0], frame.u[k][1]);
    forward += std::abs(double(frame.u[k][0]));
    if (!frame.v.empty()) speed += std::hypot(frame.v[k][0], frame.v[k][1]);
    if (pressure) of_water += (*pressure)(k);
    if (in_band && width && (*width)(k) > 0) of_bands += (*in_band)(k), ++with_band;
    ++count;
  }
  if (count == 0) return;
  s.times.push_back(frame.time);
  s.distance.push_back(distance / double(count));
  s.forward.push_back(forward / double(count));
  s.speed.push_back(frame.v.empty() ? nan : speed / double(count));
  s.pressure_of_zone.push_back(with_band > 0 ? of_bands / double(with_band) : pressure ? of_water / double(count) : nan);
  s.level.push_back(level_at(c, frame.time));
  const FieldValues *temperature = frame.find("temperature"), *hot = frame.find("band_temperature");
  const double start = c.heat ? c.heat->initial_c : 0;
  double sum = 0;
  std::size_t banded = 0;
  for (std::size_t k = 0; k < particles; ++k) {
    if (frame.status[k] == ParticleStatus::ended || frame.status[k] == ParticleStatus::unborn) continue;
    if (last) raise(s.displacement, std::hypot(frame.u[k][0], frame.u[k][1]));
    if (pressure) raise(s.pressure, (*pressure)(k));
    if (temperature) raise(s.temperature, (*temperature)(k) - start);
    if (!width || !((*width)(k) > 0)) continue;
    if (in_band) raise(s.band_pressure, (*in_band)(k));
    if (!hot) continue;
    raise(s.band_temperature, (*hot)(k) - start);
    sum += (*hot)(k) - start;
    ++banded;
  }
  if (last && banded > 0) s.band_temperature_mean = sum / double(banded);
}

}  // namespace

std::vector<SweepResponse> sweep_responses() {
  std::vector<SweepResponse> all;
  for (const Row& row : rows()) all.push_back(row.response);
  return all;
}

SweepResponse sweep_response(const std::string& name) {
  std::vector<std::string> known;
  for (const Row& row : rows()) {
    if (row.response.name == name) return row.response;
    known.push_back(row.response.name);
  }
  for (const compare::MetricRow& row : compare::metric_rows()) {
    known.push_back(std::string(of_difference) + row.name);
    if (known.back() == name) return {name, row.unit == "1" ? "" : unit_in(row.unit, "m", "s"), row.definition};
  }
  throw InputError("--response: found '" + name + "'" + did_you_mean(name, known));
}

void read_responses(const Case& c, const SweepOptions& options, SweepRun& run, Progress& progress) {
  const io::RecordReader record(run.folder / "record.h5");
  const std::unique_ptr<MotionSource> motion = record.motion("mpm");
  const std::size_t frames = motion->times().size(), particles = motion->particles().size();
  const std::vector<std::size_t> zone = zone_of(motion->particles(), options.zone_m, motion->frame(frames - 1));
  if (zone.empty() && !options.zone_m.empty()) throw InputError("--zone: holds no particle of " + run.label + ", expected a box x0,y0,x1,y1 with material");
  Seen seen;
  for (std::size_t k = 0; k < frames; ++k) see(c, motion->frame(k), zone, particles, k + 1 == frames, seen);
  run.times = seen.times;
  run.distance = seen.distance;
  run.speed = seen.speed;
  run.pressure = seen.pressure_of_zone;
  run.responses.clear();
  run.uncertainties.assign(options.responses.size(), nan);
  std::optional<Comparison> found;
  for (std::size_t k = 0; k < options.responses.size(); ++k) {
    const std::string& name = options.responses[k];
    if (name.starts_with(of_difference)) {
      try {
        if (!found && run.failure.empty()) found = compared_with(c, options.against, *motion, progress);
      } catch (const InputError& error) {  // the other responses stand
        run.failure = std::string("no difference: ") + error.what();
      }
      const Metric* metric = found ? find(found->metrics, name.substr(of_difference.size())) : nullptr;
      run.responses.push_back(metric ? metric->value : nan);
      if (metric) run.uncertainties[k] = metric->uncertainty;
      continue;
    }
    const auto row = std::find_if(rows().begin(), rows().end(), [&](const Row& r) { return r.response.name == name; });
    run.responses.push_back(row->of(seen));
  }
}

LastField last_field(const std::filesystem::path& file, const std::string& field) {
  const io::RecordReader record(file);
  const std::unique_ptr<MotionSource> motion = record.motion("mpm");
  const std::size_t last = motion->times().size() - 1;
  const MotionFrame frame = motion->frame(last);
  LastField out;
  DerivedReader reader(*motion, false);
  out.values = reader.values(field, last);
  const ParticleSet& set = motion->particles();
  for (std::size_t k = 0; k < set.size(); ++k) {
    out.x.push_back(set.x0[k] + Vec2(frame.u[k][0], frame.u[k][1]));
    out.half.push_back(std::sqrt(set.area[k]) / 2);
    if (frame.status[k] == ParticleStatus::ended) out.values[k] = nan;
  }
  return out;
}

}  // namespace pivnp::app

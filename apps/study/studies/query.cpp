#include "apps/study/studies/query.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "apps/study/pipeline/record/opened_motion.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/gauge.hpp"
#include "pivnp/core/particles/places.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/exports/exports.hpp"

namespace pivnp::app {

namespace {

using SharedMotion = std::shared_ptr<const MotionSource>;

std::string in_cell(double value, int digits = 9) { return std::isfinite(value) ? number(value, digits) : std::string(); }
constexpr int digits_of_values = 7;  // records are in single precision
std::string csv_head(const std::string& name, const std::string& unit) { return unit.empty() || unit == "1" ? name : name + " (" + unit + ")"; }

std::string point_in_words(const Vec2& x) { return "(" + number(x.x()) + ", " + number(x.y()) + ")"; }

std::pair<Vec2, Vec2> two_of(const Points& points, const std::string& key) {
  const std::vector<Vec2> x = positions_of(points);
  if (x.size() != 2) throw InputError(key + ": found " + std::to_string(x.size()) + (x.size() == 1 ? " point" : " points") + ", expected two");
  if (x[0] == x[1]) throw InputError(key + ": found the same point twice, expected two");
  return {x[0], x[1]};
}

void require_particles(const MotionSource& places, const std::string& where) {
  const std::vector<ParticleStatus> status = places.frame(0).status;
  for (std::size_t q = 0; q < status.size(); ++q)
    if (status[q] == ParticleStatus::unborn) throw InputError(where + (status.size() > 1 ? " " + point_in_words(places.particles().x0[q]) : std::string()) +
                                                               ": no particle of the first frame is there");
}

// The fields that are asked for, each before its uncertainty.
std::vector<DerivedField> fields_with_errors(const QueryOptions& options) {
  std::vector<DerivedField> columns;
  for (const std::string& name : options.fields_shown) {
    columns.push_back(derived_field(name));
    if (const std::string sigma = sigma_field(name); !sigma.empty()) columns.push_back(derived_field(sigma));
  }
  return columns;
}

std::string at_material(const MotionSource& places, const QueryOptions& options, bool central) {
  const std::string &length = places.length_unit(), &clock = places.time_unit();
  const std::vector<DerivedField> fields = fields_with_errors(options);
  std::string text = csv_head("time", clock) + "," + csv_head("x0", length) + "," + csv_head("y0", length) + "," + csv_head("x", length) + "," +
                     csv_head("y", length) + ",status";
  for (const DerivedField& field : fields) text += "," + csv_head(field.name, unit_in(field.unit, length, clock));
  text += "\n";
  DerivedReader reader(places, central);
  for (const std::size_t k : io::chosen_frames(places.times(), options.times_s)) {
    const MotionFrame frame = places.frame(k);
    std::vector<std::vector<double>> values;
    for (const DerivedField& field : fields) values.push_back(reader.values(field.name, k));
    for (std::size_t q = 0; q < places.particles().size(); ++q) {
      const Vec2& x0 = places.particles().x0[q];
      text += in_cell(places.times()[k]) + "," + in_cell(x0.x()) + "," + in_cell(x0.y()) + "," + in_cell(x0.x() + double(frame.u[q][0])) + "," +
              in_cell(x0.y() + double(frame.u[q][1])) + "," + std::to_string(int(frame.status[q]));
      for (const std::vector<double>& v : values) text += "," + in_cell(v[q], digits_of_values);
      text += "\n";
    }
  }
  return text;
}

std::string along_line(const MotionSource& motion, const QueryOptions& options, bool central) {
  const auto [from, to] = two_of(options.line_m, "--line-m");
  const std::string &length = motion.length_unit(), &clock = motion.time_unit();
  std::string text = csv_head("time", clock) + "," + csv_head("distance", length) + "," + csv_head("x", length) + "," + csv_head("y", length);
  for (const std::string& name : options.fields_shown) {
    const std::string unit = unit_in(derived_field(name).unit, length, clock), sigma = sigma_field(name);
    text += "," + csv_head(name, unit);
    if (!sigma.empty()) text += "," + csv_head(sigma, unit);
  }
  text += "\n";
  const std::vector<double> times = options.times_s.empty() ? std::vector<double>{motion.times().back()} : options.times_s;
  bool met = false;
  for (const std::size_t k : io::chosen_frames(motion.times(), times)) {
    std::vector<SectionCurve> curves;
    for (const std::string& name : options.fields_shown) curves.push_back(section(motion, name, central, k, from, to));
    for (std::size_t j = 0; !curves.empty() && j < curves[0].distance.size(); ++j) {
      const double d = curves[0].distance[j];
      const Vec2 x = from + d / (to - from).norm() * (to - from);
      text += in_cell(motion.times()[k]) + "," + in_cell(d) + "," + in_cell(x.x()) + "," + in_cell(x.y());
      for (std::size_t c = 0; c < curves.size(); ++c) {
        met = met || std::isfinite(curves[c].value[j]);
        text += "," + in_cell(curves[c].value[j], digits_of_values);
        if (!sigma_field(options.fields_shown[c]).empty()) text += "," + in_cell(curves[c].sigma.empty() ? nan_value : curves[c].sigma[j], digits_of_values);
      }
      text += "\n";
    }
  }
  if (!met) throw InputError("--line-m: no particle is beside it at the times that are asked for");
  return text;
}

std::string strain_between(const MotionSource& motion, const QueryOptions& options) {
  const auto [from, to] = two_of(options.extensometer_m, "--extensometer-m");
  const ExtensometerCurve curve = extensometer(motion, from, to);
  if (std::none_of(curve.strain.begin(), curve.strain.end(), [](double e) { return std::isfinite(e); }))
    throw InputError("--extensometer-m: found no particles of the first frame at both ends, expected two");
  std::string text = csv_head("time", motion.time_unit()) + ",strain,sigma_strain\n";
  for (const std::size_t k : io::chosen_frames(curve.time, options.times_s))
    text += in_cell(curve.time[k]) + "," + in_cell(curve.strain[k], digits_of_values) + "," + in_cell(curve.sigma.empty() ? nan_value : curve.sigma[k], digits_of_values) + "\n";
  return text;
}

}  // namespace

std::string query_motion(const std::string& source, const QueryOptions& options) {
  const int kinds = int(!options.points_m.empty()) + int(!options.line_m.empty()) + int(!options.rectangle_m.empty()) + int(!options.extensometer_m.empty());
  if (kinds != 1)
    throw InputError("query: found " + std::to_string(kinds) + " kinds of place, expected one of --points-m, --line-m, --rectangle-m and --extensometer-m");
  for (const std::string& name : options.fields_shown) derived_field(name);
  const OpenedMotion opened = open_motion(source, {});
  SharedMotion motion = opened.motion;
  if (motion->times().empty()) throw InputError(source + ": holds no times");
  if (options.gauge_m) motion = with_gauge(motion, *options.gauge_m);
  if (!options.line_m.empty()) return along_line(*motion, options, opened.central);
  if (!options.extensometer_m.empty()) return strain_between(*motion, options);
  if (!options.points_m.empty()) {
    const SharedMotion places = at_points(motion, positions_of(options.points_m));
    require_particles(*places, "--points-m");
    return at_material(*places, options, opened.central);
  }
  const auto [one, two] = two_of(options.rectangle_m, "--rectangle-m");
  const SharedMotion place = in_rectangle(motion, one.cwiseMin(two), one.cwiseMax(two), opened.note ? opened.note->gauge_length : 0);
  require_particles(*place, "--rectangle-m");
  return at_material(*place, options, opened.central);
}

}  // namespace pivnp::app

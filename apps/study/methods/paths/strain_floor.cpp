#include "apps/study/methods/paths/strain_floor.hpp"

#include <cmath>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::app {

namespace {

std::vector<Vec2> zone(const Setting& setting, const np::NpOptions& options) {
  std::vector<Vec2> vertices = positions_of(options.still_zone_m);
  for (const Pair& p : options.still_zone_px) vertices.push_back(setting.camera.to_world({p[0], p[1]}));
  return vertices;
}

// RMS of a field over the particles chosen that have it.
double rms(DerivedReader& reader, const char* field, std::size_t frame, const std::vector<bool>& chosen) {
  double sum = 0;
  std::size_t count = 0;
  const std::vector<double> values = reader.values(field, frame);
  for (std::size_t p = 0; p < values.size(); ++p) {
    if (!chosen[p] || !std::isfinite(values[p])) continue;
    sum += values[p] * values[p];
    ++count;
  }
  return count > 0 ? std::sqrt(sum / double(count)) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void check_strain_floor(const Case& c, const Setting& setting, std::size_t frames) {
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  const std::string where = of_file(c) + ": np.";
  if (!options.still_zone_px.empty() && !options.still_zone_m.empty())
    throw InputError(where + "still_zone_m: found still_zone_px too, expected one of them");
  const std::vector<Vec2> vertices = zone(setting, options);
  if (!vertices.empty() && options.still_frames != 0)
    throw InputError(where + "still_frames: found a still zone too, expected one of them");
  if (options.still_frames != 0 && (options.still_frames < 2 || std::size_t(options.still_frames) > frames))
    throw InputError(where + "still_frames: found " + std::to_string(options.still_frames) +
                     ", expected 2 to the number of frames, " + std::to_string(frames));
  if (vertices.empty()) return;
  const Polygon polygon(vertices, where + (options.still_zone_px.empty() ? "still_zone_m" : "still_zone_px"));
  for (const Vec2& x : seed_particles(c, setting).x0)
    if (polygon.contains(x)) return;
  throw InputError(where + (options.still_zone_px.empty() ? "still_zone_m" : "still_zone_px") +
                   ": found no particle in it, expected some");
}

StrainNote strain_note(const Case& c, const Setting& setting, const MotionSource& motion, bool central) {
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  StrainNote note;
  // What other programs' vectors average over is not known.
  const double window = setting.imported ? 0 : c.piv.value_or(piv::PivOptions{}).window_px;
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  note.gauge_length = np::cells_spanned(options.shape) * setting.grid.spacing.maxCoeff() + window * pixel;
  const std::vector<Vec2> vertices = zone(setting, options);
  const std::size_t frames = motion.times().size();
  const ParticleSet& particles = motion.particles();
  if (vertices.empty() && options.still_frames == 0) return note;
  std::vector<bool> chosen(particles.size(), true);
  std::size_t frame = frames - 1;
  double growth = 1;
  if (!vertices.empty()) {
    const Polygon polygon(vertices, of_file(c) + ": np: still zone");
    for (std::size_t p = 0; p < chosen.size(); ++p) chosen[p] = polygon.contains(particles.x0[p]);
  } else {
    frame = std::size_t(options.still_frames) - 1;
    growth = double(frames - 1) / double(frame);
  }
  DerivedReader reader(motion, central);
  note.floor_dev = std::sqrt(growth) * rms(reader, "strain_dev", frame, chosen);
  note.floor_vol = std::sqrt(growth) * rms(reader, "strain_vol", frame, chosen);
  note.floor_path = growth * rms(reader, "strain_dev_path", frame, chosen);
  if (std::isfinite(note.floor_dev)) note.floor_source = vertices.empty() ? StrainFloor::still_frames : StrainFloor::still_zone;
  return note;
}

}  // namespace pivnp::app

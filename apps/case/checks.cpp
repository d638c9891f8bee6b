#include "apps/case/checks.hpp"

#include <algorithm>
#include <cmath>

#include "apps/case/fields.hpp"
#include "apps/case/lengths.hpp"
#include "apps/case/refusals.hpp"
#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/piv/methods.hpp"

namespace pivnp::app {

namespace {

// Empty: the field is known.
std::string fault_of_field(const std::string& name) {
  std::vector<std::string> known;
  for (const DerivedField& field : derived_fields()) known.emplace_back(field.name);
  if (std::find(known.begin(), known.end(), name) != known.end()) return "";
  return "unknown field \"" + name + "\"" + did_you_mean(name, known);
}

class Checker : Refusals {
 public:
  Checker(const Case& c, const Source& source) : Refusals{c, source} {}

  void all() const {
    Faults faults;
    for (const auto check : {&Checker::stages, &Checker::vectors, &Checker::camera, &Checker::grid, &Checker::rows_in_time, &Checker::shapes,
                             &Checker::simulation, &Checker::camera_moves, &Checker::synthetic, &Checker::verification, &Checker::lines})
      faults.gather([&] { (this->*check)(); });
    for (const std::string& field : c_.output.fields_stored) faults.gather([&] { known_field("output.fields", field); });
    for (const std::string& field : c_.report.fields_drawn) faults.gather([&] { known_field("report.fields", field); });
    faults.raise(source_.file());
  }

 private:
  void simulation() const { check_simulation(c_, source_); }

  void lines() const {
    for (const auto& [name, line] : c_.report.lines) {
      const std::string section = "report.line." + name;
      const std::optional<LineFault> fault = fault_of_line(name, line);
      if (fault && fault->key.empty()) refuse_section(section, fault->text);
      if (fault) refuse(section + "." + fault->key, fault->text);
    }
  }

  void stages() const {
    if (source_.given("piv") && !has_images())
      refuse_section("piv", "there are no frames to measure; expected [frames] or [synth]");
    if (source_.given("np") && !measures())
      refuse_section("np", "there are no frames to measure; expected [frames], [vectors] or [synth]");
    if (source_.given("preprocess") && !has_images())
      refuse_section("preprocess", "there are no frames to filter; expected [frames] or [synth]");
    if (source_.given("preprocess") && c_.vectors)
      refuse_section("preprocess",
                     "given together with [vectors], whose frames are not correlated; expected one of them");
    if (c_.frames && c_.frames->last && *c_.frames->last < c_.frames->first)
      refuse("frames.last", "found " + std::to_string(*c_.frames->last) + ", expected at least frames.first, " +
                                std::to_string(c_.frames->first));
    if (c_.frames && c_.frames->least_motion_px > 0) {
      if (c_.vectors)
        refuse("frames.least_motion_px",
               "given together with [vectors], which are of every frame; expected one of them");
      for (const auto& [name, mask] : c_.masks)
        if (!mask.images.empty() || !mask.motion.empty())
          refuse("frames.least_motion_px", "given together with mask." + name +
                                               (mask.images.empty() ? ".motion" : ".images") +
                                               ", which is of every frame; expected one of them");
    }
    if (c_.piv && c_.piv->first_window_px != 0 && c_.piv->first_window_px < c_.piv->window_px)
      refuse("piv.first_window_px", "found " + std::to_string(c_.piv->first_window_px) +
                                        ", expected 0 or at least piv.window_px, " + std::to_string(c_.piv->window_px) +
                                        " (px)");
    if (c_.piv && c_.piv->ensemble > 1 &&
        piv::piv_methods().at(c_.piv->method, "piv.method").family == piv::MethodFamily::gauss_newton)
      refuse("piv.ensemble", "found " + std::to_string(c_.piv->ensemble) + ", expected 1, as piv.method = \"" +
                                 c_.piv->method + "\" has no correlation to average; \"fft\" and \"ncc\" have");
    if (c_.piv && c_.piv->ensemble > 1 && c_.camera_motion.from != image::RestSource::none)
      refuse("piv.ensemble", "found " + std::to_string(c_.piv->ensemble) +
                                 " together with camera.motion.from, expected 1, as a camera that moves "
                                 "sees the nodes of every pair elsewhere");
    if (c_.np) square("np.per_element", c_.np->per_element);
    if (c_.mpm) square("mpm.per_element", c_.mpm->per_element);
    if (c_.synth_mpm) square("synth.mpm.per_element", c_.synth_mpm->per_element);
  }

  void vectors() const {
    if (!c_.vectors) return;
    if (c_.vectors->path.empty()) refuse("vectors.path", "missing; expected the files of the vectors");
    if (c_.vectors->format.empty())
      refuse("vectors.format", "missing; expected " + io::formats_text(&io::FileFormat::vectors));
    if (!c_.vectors->length_unit.empty() && !is_length_unit(c_.vectors->length_unit))
      refuse("vectors.length_unit", "found \"" + c_.vectors->length_unit + "\", expected m, mm, cm, km or um");
    if (c_.synth) refuse_section("vectors", "given together with [synth]; expected one of them");
    if (c_.frames && c_.vectors->rate_hz)
      refuse("vectors.rate_hz", "given together with [frames]; expected frames.rate_hz, which holds for both");
    const GridOptions none;
    GridOptions::fields(none, [&](std::string_view name, const auto&, const OptionInfo&) {
      const std::string key = "grid." + std::string(name);
      if (source_.given(key)) refuse(key, "given together with [vectors], whose files give the grid; expected one of them");
    });
  }

  void square(const std::string& key, int count) const {
    const int side = int(std::lround(std::sqrt(double(count))));
    if (side * side != count) refuse(key, "found " + std::to_string(count) + ", expected a square: 1, 4, 9, 16 ...");
  }

  void camera() const {
    const auto& camera = c_.camera;
    constexpr double largest = 0.1;  // m a pixel: a view of a hundred metres and more is no laboratory
    const bool plain = camera.points_px.empty() && camera.points_m.empty();
    if (plain && camera.metres_per_pixel && camera.length_unit == "m" && !source_.given("camera.length_unit") && *camera.metres_per_pixel > largest)
      refuse("camera.metres_per_pixel", "found " + toml_text(*camera.metres_per_pixel) + ", expected at most " +
                                            toml_text(largest) + " (m), or another camera.length_unit");
    constexpr double least = 1e-12, most = 1e12;  // of any unit: variances, of hundredths of a pixel too, are floats
    if (plain && camera.metres_per_pixel && !(*camera.metres_per_pixel >= least && *camera.metres_per_pixel <= most))
      refuse("camera.metres_per_pixel", "found " + toml_text(*camera.metres_per_pixel) + ", expected a number from " +
                                            toml_text(least) + " to " + toml_text(most));
    if (plain) return;
    if (camera.metres_per_pixel)
      refuse("camera.metres_per_pixel", "given together with targets (points_px, points_m); expected one of them");
    if (camera.points_px.size() != camera.points_m.size())
      refuse("camera.points_m", "found " + std::to_string(camera.points_m.size()) +
                                    " targets, expected as many as "
                                    "camera.points_px, " +
                                    std::to_string(camera.points_px.size()));
    if (camera.points_px.size() < 4)
      refuse("camera.points_px", "found " + std::to_string(camera.points_px.size()) + " targets, expected at least 4");
  }

  void grid() const {
    const GridOptions& grid = c_.grid;
    if (grid.spacing_px && grid.spacing_m)
      refuse("grid.spacing_m", "given together with grid.spacing_px; expected one of them");
    if (!grid.area_px.empty() && !grid.area_m.empty())
      refuse("grid.area_m", "given together with grid.area_px; expected one of them");
    corners("grid.area_px", grid.area_px);
    corners("grid.area_m", grid.area_m);
    if (c_.mpm) corners("mpm.domain_m", c_.mpm->domain_m);
    if (c_.synth_mpm) corners("synth.mpm.domain_m", c_.synth_mpm->domain_m);
  }

  void corners(const std::string& key, const Points& points) const {
    if (points.empty()) return;
    if (points.size() != 2)
      refuse(key, "found " + std::to_string(points.size()) + " points, expected two opposite corners");
    if (points[0][0] == points[1][0] || points[0][1] == points[1][1]) refuse(key, "the two corners span no area");
  }

  // Outlines are held to be polygons here, where the line is known.
  void polygon(const std::string& key, const Points& points) const {
    std::vector<Vec2> vertices = positions_of(points);
    Polygon(vertices, source_.at(key));
  }

  void circle(const std::string& key, const std::vector<double>& values) const {
    if (values.size() != 3)
      refuse(key, "found " + std::to_string(values.size()) + " numbers, expected 3: centre and radius");
    if (!(values[2] > 0)) refuse(key, "found radius " + toml_text(values[2]) + ", expected more than 0");
  }

  struct Shape {
    const char* key;
    bool given;
  };

  // Exactly one of several ways to give a shape.
  void one_of(const std::string& path, const std::vector<Shape>& shapes) const {
    std::string names;
    const Shape* first = nullptr;
    for (const Shape& shape : shapes) {
      names += (names.empty() ? "" : ", ") + std::string(shape.key);
      if (!shape.given) continue;
      if (first)
        refuse(path + "." + shape.key, std::string("given together with ") + first->key + "; expected one of them");
      first = &shape;
    }
    if (!first) refuse_section(path, "no shape is given; expected one of " + names);
  }

  void rows_in_time() const {
    if (c_.camera.row_time_s == 0) return;
    const std::string key = "camera.row_time_s";
    if (!has_images()) refuse(key, "found in a case without frames, expected frames whose rows are read one after the other");
    if (c_.vectors) refuse(key, "given together with [vectors], whose times are those of another program");
    if (c_.frames && c_.frames->path.size() > 0 && !c_.frames->rate_hz) refuse(key, "given without frames.rate_hz, expected the rate of the frames");
    if (c_.camera_motion.from != image::RestSource::none) refuse(key, "given together with [camera.motion], expected one of them: how a camera moves within a frame is not known");
    if (c_.piv && c_.piv->ensemble > 1) refuse(key, "given together with piv.ensemble, expected piv.ensemble = 1: a mean over several pairs has no time at which a row was read");
    if (c_.np && c_.np->drift != np::DriftScheme::none) refuse(key, "given together with np.drift, expected np.drift = \"none\": direct correlation does not know the rows' times");
  }

  void shapes() const {
    for (const auto& [name, region] : c_.regions) {
      const std::string path = "region." + name;
      one_of(path, {{"polygon_m", !region.polygon_m.empty()}, {"polygon_px", !region.polygon_px.empty()}});
      if (!region.polygon_m.empty()) polygon(path + ".polygon_m", region.polygon_m);
      if (!region.polygon_px.empty()) polygon(path + ".polygon_px", region.polygon_px);
    }
    for (const auto& [name, mask] : c_.masks) {
      const std::string path = "mask." + name;
      one_of(path, {{"polygon_px", !mask.polygon_px.empty()},
                    {"polygon_m", !mask.polygon_m.empty()},
                    {"circle_px", !mask.circle_px.empty()},
                    {"image", !mask.image.empty()}, {"images", !mask.images.empty()}, {"glare", mask.glare.has_value()},
                    {"air", mask.air != image::AirKind::none}});
      if (mask.air == image::AirKind::still && c_.regions.empty()) refuse(path + ".air", "found \"still\" in a case without [region.NAME], expected regions that say where material is in the first frame");
      if (mask.air == image::AirKind::still && c_.camera_motion.from != image::RestSource::none) refuse(path + ".air", "found \"still\" together with [camera.motion], expected a camera at rest");
      if (!mask.polygon_px.empty()) polygon(path + ".polygon_px", mask.polygon_px);
      if (!mask.polygon_m.empty()) polygon(path + ".polygon_m", mask.polygon_m);
      if (!mask.circle_px.empty()) circle(path + ".circle_px", mask.circle_px);
      if (mask.grow_px > 0 && !mask.moves()) refuse(path + ".grow_px", "found " + toml_text(mask.grow_px) + " for a mask that does not move, expected images, glare, air, motion or follow");
    }
    for (const auto& [name, boundary] : c_.boundaries) boundary_shape("boundary." + name, boundary);
    for (const auto& [name, body] : c_.bodies) {
      const std::string path = "body." + name;
      one_of(path, {{"circle_m", !body.circle_m.empty()}, {"polygon_m", !body.polygon_m.empty()}});
      if (!body.circle_m.empty()) circle(path + ".circle_m", body.circle_m);
      if (!body.polygon_m.empty()) polygon(path + ".polygon_m", body.polygon_m);
      if (body.until_s && *body.until_s <= body.from_s)
        refuse(path + ".until_s",
               "found " + toml_text(*body.until_s) + ", expected more than from_s, " + toml_text(body.from_s) + " (s)");
    }
    if (!c_.compare.reference_m.empty()) polygon("compare.reference_m", c_.compare.reference_m);
    if (!c_.compare.fixed_zone_m.empty()) polygon("compare.fixed_zone_m", c_.compare.fixed_zone_m);
    if (!c_.compare.fixed_zone_m.empty() && !c_.compare.reference_m.empty())
      refuse("compare.fixed_zone_m", "given together with reference_m; expected one of them");
    if (!c_.compare.increments_outside_m.empty())
      circle("compare.increments_outside_m", c_.compare.increments_outside_m);
    if (c_.compare.levelling && c_.vectors)
      refuse("compare.levelling", "given together with [vectors]; expected frames that are measured here, as the simulation "
                                  "would be");
    if (c_.compare.levelling && !(has_images() && c_.mpm))
      refuse("compare.levelling", "given, but there is nothing to level; expected frames and [mpm]");
    if (c_.compare.mesh_study > 0 && !(measures() && c_.mpm))
      refuse("compare.mesh_study", "given, but nothing is compared; expected frames and [mpm]");
    if (const compare::LimitRow* row = compare::limit_without_its_option(c_.limits, c_.compare))
      refuse("compare.limits." + row->name, "given, but compare." + row->needs + " is not; expected both");
  }

  void boundary_shape(const std::string& path, const mpm::BoundaryOptions& boundary) const {
    one_of(path, {{"line_m", !boundary.line_m.empty()}, {"polygon_m", !boundary.polygon_m.empty()}});
    if (!boundary.polygon_m.empty()) polygon(path + ".polygon_m", boundary.polygon_m);
    if (!boundary.line_m.empty() && boundary.line_m.size() != 2)
      refuse(path + ".line_m",
             "found " + std::to_string(boundary.line_m.size()) + " points, expected the line's two ends");
    if (boundary.line_m.size() == 2 && boundary.line_m[0] == boundary.line_m[1])
      refuse(path + ".line_m", "the line's two ends are the same point");
    if (boundary.normal && *boundary.normal == Pair{0.0, 0.0})
      refuse(path + ".normal", "found [0.0, 0.0], expected a direction");
    if (boundary.friction > 0 && boundary.type != mpm::BoundaryType::frictional)
      refuse(path + ".friction", "given, but the type is \"" + std::string(name_of(boundary.type)) + "\"; expected type = \"frictional\"");
  }

  void camera_moves() const {
    const image::CameraMotionOptions& o = c_.camera_motion;
    if (!o.zone_px.empty()) polygon("camera.motion.zone_px", o.zone_px);
    if (!o.zone_m.empty()) polygon("camera.motion.zone_m", o.zone_m);
    if (!o.zone_px.empty() && !o.zone_m.empty()) refuse("camera.motion.zone_m", "given together with zone_px; expected one of them");
    const bool zone = !o.zone_px.empty() || !o.zone_m.empty();
    if (zone && o.from != image::RestSource::still_zone)
      refuse(o.zone_px.empty() ? "camera.motion.zone_m" : "camera.motion.zone_px", "given, but from is \"" + std::string(name_of(o.from)) + "\"; expected from = \"still_zone\"");
    if (!o.targets_px.empty() && o.from != image::RestSource::targets)
      refuse("camera.motion.targets_px", "given, but from is \"" + std::string(name_of(o.from)) + "\"; expected from = \"targets\"");
    if (o.from != image::RestSource::none && c_.vectors)
      refuse("camera.motion.from", "given together with [vectors]; expected frames that are measured here");
    if (!c_.synth_camera.still_px.empty()) polygon("synth.camera.still_px", c_.synth_camera.still_px);
    if (c_.synth_camera.bump_at == 0 && (c_.synth_camera.bump_px != Pair{0.0, 0.0} || c_.synth_camera.bump_deg != 0))
      refuse("synth.camera.bump_at", "missing; expected the first frame after the bump");
  }

  void synthetic() const {
    if (!c_.synth) return;
    const SynthOptions& synth = *c_.synth;
    const bool moved = !synth.gradient_per_frame.empty() || synth.rotation_deg_per_frame != 0 ||
                       synth.shift_px_per_frame != Pair{0.0, 0.0};
    if (!synth.gradient_per_frame.empty() && synth.gradient_per_frame.size() != 4)
      refuse("synth.gradient_per_frame",
             "found " + std::to_string(synth.gradient_per_frame.size()) + " numbers, expected 4: xx xy yx yy");
    if (moved && synth.motion != SynthMotion::affine)
      refuse_section("synth", "an affine motion is described, but motion is \"" + std::string(name_of(synth.motion)) +
                                  "\"; expected motion = \"affine\"");
    if (synth.motion == SynthMotion::mpm && !c_.synth_mpm)
      refuse("synth.motion", "\"mpm\" needs the simulation that carries the texture; expected [synth.mpm]");
    if (c_.synth_mpm && synth.motion != SynthMotion::mpm)
      refuse_section("synth.mpm", "given, but synth.motion is \"" + std::string(name_of(synth.motion)) + "\"; expected motion = \"mpm\"");
    if (synth.motion == SynthMotion::record && synth.record.empty())
      refuse("synth.motion", "\"record\" needs the motion that carries the texture; expected synth.record = \"FILE:MOTION\"");
    if (!synth.record.empty() && synth.motion != SynthMotion::record)
      refuse("synth.record", "given, but synth.motion is \"" + std::string(name_of(synth.motion)) + "\"; expected motion = \"record\"");
    if (c_.synth_mpm) materials_of_regions("synth.mpm", "synth.material", c_.synth_materials);
    if (c_.texture.peak_max < c_.texture.peak_min)
      refuse("synth.texture.peak_max", "found " + toml_text(c_.texture.peak_max) + ", expected at least peak_min, " +
                                           toml_text(c_.texture.peak_min));
    if (c_.texture.bits != 8 && c_.texture.bits != 12 && c_.texture.bits != 16)
      refuse("synth.texture.bits", "found " + std::to_string(c_.texture.bits) + ", expected 8, 12 or 16");
  }

  void verification() const {
    if (!source_.given("verify")) return;
    if (!demands_anything(c_.verify))
      refuse_section("verify", "no threshold is given; expected displacement_rms_px, strain_error or nodal_error");
    if (!c_.synth) refuse_section("verify", "the truth is not known without synthetic frames; expected [synth]");
  }

  void known_field(const std::string& key, const std::string& name) const {
    if (const std::string fault = fault_of_field(name); !fault.empty()) refuse(key, fault);
  }
};

}  // namespace

std::optional<LineFault> fault_of_line(const std::string& name, const report::LineOptions& line) {
  if (!line.from_m || !line.to_m) return LineFault{"", std::string(line.from_m ? "to_m" : "from_m") + ": missing, expected [x, y]"};
  if (*line.from_m == *line.to_m) return LineFault{"to_m", "found from_m again, expected another point"};
  if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") != std::string::npos)
    return LineFault{"", "the name is that of a file; expected letters, digits, _ and -"};
  if (const std::string fault = fault_of_field(line.field); !fault.empty()) return LineFault{"field", fault};
  return std::nullopt;
}

void check_given(const Case& c, const Source& source) { Checker(c, source).all(); }

}  // namespace pivnp::app

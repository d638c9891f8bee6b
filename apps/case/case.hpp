// A case: one TOML file, read with line numbers, written back with every default filled in.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/case/document.hpp"
#include "apps/report/content/options.hpp"
#include "compare/data/options.hpp"
#include "compare/metrics/limits.hpp"
#include "mpm/constraint/options.hpp"
#include "mpm/heat/options.hpp"
#include "mpm/material/options.hpp"
#include "mpm/scene/centrifuge.hpp"
#include "mpm/scene/options.hpp"
#include "mpm/water/options.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/image/camera/camera.hpp"
#include "pivnp/image/camera/camera_motion_options.hpp"
#include "pivnp/image/frames/filter_options.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/image/masks/mask.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "pivnp/io/imports/import_vectors.hpp"
#include "pivnp/np/options.hpp"
#include "pivnp/piv/options.hpp"

namespace pivnp::app {

struct GridOptions {
  std::optional<double> spacing_px;
  std::optional<double> spacing_m;
  std::optional<double> margin_px;
  Points area_px;
  Points area_m;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("spacing_px", self.spacing_px, OptionInfo{.unit = "px", .text = "distance between nodes; default: a quarter of the window", .min = 1});
    visit("spacing_m", self.spacing_m, OptionInfo{.unit = "m", .text = "the same in the world", .min = 0, .above_min = true});
    visit("margin_px", self.margin_px, OptionInfo{.unit = "px", .text = "from the outermost nodes to the image's edge; default: half the window", .min = 0});
    visit("area_px", self.area_px, OptionInfo{.unit = "px", .text = "two opposite corners (column, row) of the grid; default: the whole image"});
    visit("area_m", self.area_m, OptionInfo{.unit = "m", .text = "the same in the world"});
  }
};

struct RegionOptions {
  Points polygon_m;
  Points polygon_px;
  std::string material;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "outline of the material at the first frame"});
    visit("polygon_px", self.polygon_px, OptionInfo{.unit = "px", .text = "the same in pixels (column, row)"});
    visit("material", self.material, OptionInfo{.text = "name of its material; default: the region's name"});
  }
};

/// What the simulation of a region starts with, [initial.REGION].
struct InitialOptions {
  Pair velocity_m_s = {0.0, 0.0};
  double spin_rad_s = 0;
  std::vector<double> stress_pa;
  std::vector<double> stress_gradient_pa_m;
  std::optional<double> stress_level_m;
  std::string stress_file;
  std::optional<double> pressure_pa;
  std::optional<double> pressure_gradient_pa_m, pressure_level_m;
  std::string pressure_file;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("velocity_m_s", self.velocity_m_s, OptionInfo{.unit = "m/s", .text = "velocity (x, y) at time 0"});
    visit("spin_rad_s", self.spin_rad_s, OptionInfo{.unit = "rad/s", .text = "angular velocity at time 0 about the centre of mass, anticlockwise"});
    visit("stress_pa", self.stress_pa, OptionInfo{.unit = "Pa", .text = "stress xx, yy, zz, xy at stress_level_m, tension positive (effective in wet soil)"});
    visit("stress_gradient_pa_m", self.stress_gradient_pa_m, OptionInfo{.unit = "Pa/m", .text = "change of stress_pa per metre upwards; default: 0"});
    visit("stress_level_m", self.stress_level_m, OptionInfo{.unit = "m", .text = "height y of stress_pa; default: 0"});
    visit("stress_file", self.stress_file, OptionInfo{.text = "CSV in place of stress_pa: x_m, y_m, stress_xx_pa, stress_yy_pa, stress_zz_pa, stress_xy_pa"});
    visit("pressure_pa", self.pressure_pa,
          OptionInfo{.unit = "Pa",
                     .text = "pore pressure at pressure_level_m and time 0; default: that of water.start"});
    visit("pressure_gradient_pa_m", self.pressure_gradient_pa_m,
          OptionInfo{.unit = "Pa/m", .text = "its change per metre upwards; default: 0"});
    visit("pressure_level_m", self.pressure_level_m, OptionInfo{.unit = "m", .text = "height y of pressure_pa; default: 0"});
    visit("pressure_file", self.pressure_file,
          OptionInfo{.text = "CSV in place of pressure_pa: x_m, y_m, pressure_pa"});
  }
};

struct OutputOptions {
  std::vector<std::string> fields_stored;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("fields", self.fields_stored, OptionInfo{.text = "computed fields to store as well, by their names in docs/format.md"});
  }
};

enum class SynthMotion { none, affine, mpm, slope, record };
inline constexpr std::array synth_motion_names{NamedValue{"none", SynthMotion::none}, NamedValue{"affine", SynthMotion::affine},
                                               NamedValue{"mpm", SynthMotion::mpm}, NamedValue{"slope", SynthMotion::slope},
                                               NamedValue{"record", SynthMotion::record}};
constexpr const auto& names_of(SynthMotion) { return synth_motion_names; }

/// Frames with truth: what `pivnp synth` draws, and `pivnp run` when no frames are given.
struct SynthOptions {
  int width_px = 512;
  int height_px = 512;
  int frames = 10;
  SynthMotion motion = SynthMotion::none;
  std::vector<double> gradient_per_frame;
  Pair shift_px_per_frame = {0.0, 0.0};
  double rotation_deg_per_frame = 0;
  Pair centre_px = {0.0, 0.0};
  int lose_texture_at = 0;
  double settlement = 0.02;
  double collapse = 0.04;
  Pair slip_centre_px = {0.0, 0.0};
  double slip_radius_px = 0;
  double slip_band_px = 16;
  double slip_deg = 0;
  std::string record;
  bool grains_deform = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("width_px", self.width_px, OptionInfo{.unit = "px", .text = "width of the frames", .min = 16, .max = 20000});
    visit("height_px", self.height_px, OptionInfo{.unit = "px", .text = "height of the frames", .min = 16, .max = 20000});
    visit("frames", self.frames, OptionInfo{.text = "number of frames", .min = 2, .max = 100000});
    visit("motion", self.motion, OptionInfo{.text = "affine: equal increments; mpm: by [synth.mpm]; slope: settlement, wetting, slip in closed form; record: of a simulation"});
    visit("gradient_per_frame", self.gradient_per_frame, OptionInfo{.text = "affine: displacement gradient xx xy yx yy of one frame"});
    visit("shift_px_per_frame", self.shift_px_per_frame, OptionInfo{.unit = "px", .text = "affine: shift of one frame (x, y up)"});
    visit("rotation_deg_per_frame", self.rotation_deg_per_frame, OptionInfo{.unit = "deg", .text = "affine: rotation of one frame, anticlockwise, after the gradient"});
    visit("centre_px", self.centre_px, OptionInfo{.unit = "px", .text = "affine: the fixed point (column, row)"});
    visit("lose_texture_at", self.lose_texture_at, OptionInfo{.text = "affine: from this frame on ten frames each lose a tenth of the texture (0: never)", .min = 0});
    visit("settlement", self.settlement, OptionInfo{.text = "slope: vertical strain under the weight, first third of the frames", .min = 0, .max = 0.5});
    visit("collapse", self.collapse, OptionInfo{.text = "slope: vertical strain behind the rising wetting front, second third", .min = 0, .max = 0.5});
    visit("slip_centre_px", self.slip_centre_px, OptionInfo{.unit = "px", .text = "slope: centre (column, row) of the slip circle"});
    visit("slip_radius_px", self.slip_radius_px, OptionInfo{.unit = "px", .text = "slope: its radius", .min = 0});
    visit("slip_band_px", self.slip_band_px, OptionInfo{.unit = "px", .text = "slope: half width of the shear band along it", .min = 0, .above_min = true});
    visit("slip_deg", self.slip_deg, OptionInfo{.unit = "deg", .text = "slope: rotation of the slipping body, anticlockwise, last third"});
    visit("record", self.record, OptionInfo{.text = "record: FILE or FILE:MOTION, with a state at every frame's time"});
    visit("grains_deform", self.grains_deform, OptionInfo{.text = "grains deform with their material"});
  }
};

/// How the camera moves that films synthetic frames. Left alone, it is at rest.
struct SynthCameraOptions {
  double shake_px = 0;
  Pair bump_px = {0.0, 0.0};
  double bump_deg = 0;
  int bump_at = 0;
  Pair drift_px_per_frame = {0.0, 0.0};
  double zoom_per_frame = 0;
  Points still_px;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("shake_px", self.shake_px, OptionInfo{.unit = "px", .text = "greatest random shift of a frame along columns and rows", .min = 0, .max = 100});
    visit("bump_px", self.bump_px, OptionInfo{.unit = "px", .text = "shift (columns, rows) from frame bump_at on"});
    visit("bump_deg", self.bump_deg, OptionInfo{.unit = "deg", .text = "rotation about the image's middle, clockwise, of the same"});
    visit("bump_at", self.bump_at, OptionInfo{.text = "first frame after the bump (0: none)", .min = 0});
    visit("drift_px_per_frame", self.drift_px_per_frame, OptionInfo{.unit = "px", .text = "shift (columns, rows) that grows from frame to frame"});
    visit("zoom_per_frame", self.zoom_per_frame, OptionInfo{.text = "growth of the image about its middle per frame, as a fraction", .min = -0.1, .max = 0.1});
    visit("still_px", self.still_px, OptionInfo{.unit = "px", .text = "polygon (column, row) of texture at rest"});
  }

  bool moves() const {
    return shake_px > 0 || bump_at > 0 || drift_px_per_frame != Pair{0.0, 0.0} || zoom_per_frame != 0;
  }
};

/// Thresholds that `pivnp verify` checks in a case with known truth.
struct VerifyOptions {
  std::optional<double> displacement_rms_px;
  std::optional<double> strain_error;
  std::optional<double> nodal_error;
  double lost_share = 0.0;
  std::optional<double> drift_px;
  std::optional<double> drift_ratio;
  std::optional<double> camera_px;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("displacement_rms_px", self.displacement_rms_px, OptionInfo{.unit = "px", .text = "RMS error of the particles' final displacement", .min = 0});
    visit("strain_error", self.strain_error, OptionInfo{.text = "error of any component of the mean final log strain", .min = 0});
    visit("nodal_error", self.nodal_error, OptionInfo{.text = "affine: error of log strain, and of displacement over spacing, with exact nodal increments", .min = 0});
    visit("lost_share", self.lost_share, OptionInfo{.text = "fraction of particles not followed to the end", .min = 0, .max = 1});
    visit("drift_px", self.drift_px, OptionInfo{.unit = "px", .text = "RMS error of the corrected final displacement; runs all schemes of np.drift", .min = 0});
    visit("camera_px", self.camera_px, OptionInfo{.unit = "px", .text = "part of the motion of [synth.camera] that [camera.motion] leaves, at the image's corners", .min = 0});
    visit("drift_ratio", self.drift_ratio, OptionInfo{.text = "that error over the one of summed increments", .min = 0});
  }
};

/// True if a threshold is given: the case is one for `pivnp verify`.
inline bool demands_anything(const VerifyOptions& v) { return v.displacement_rms_px || v.strain_error || v.nodal_error || v.drift_px || v.drift_ratio || v.camera_px; }

template <class T>
using Named = std::vector<std::pair<std::string, T>>;  // in the file's order

struct Case {
  std::string name;
  std::filesystem::path file;    // empty for the embedded case
  std::filesystem::path folder;  // what relative paths are relative to
  std::vector<std::string> notes;  // of reading it: keys by their former names; not written
  std::optional<Source> source;    // where its keys stand; none for a case that was not read

  std::optional<image::FrameOptions> frames;  // [frames]
  std::optional<io::VectorOptions> vectors;   // [vectors]; then the grid is that of its files
  image::CameraOptions camera;                // [camera]
  image::CameraMotionOptions camera_motion;   // [camera.motion]
  Named<image::MaskOptions> masks;            // [mask.NAME]
  GridOptions grid;                           // [grid]
  Named<RegionOptions> regions;               // [region.NAME]
  std::optional<image::FilterOptions> preprocess;  // [preprocess]
  std::optional<piv::PivOptions> piv;         // [piv]; present by default when there are frames to measure
  std::optional<np::NpOptions> np;            // [np]; present by default when there are frames or vectors
  Named<mpm::MaterialOptions> materials;      // [material.NAME]
  Named<InitialOptions> initial;              // [initial.REGION]
  std::optional<mpm::MpmOptions> mpm;         // [mpm]
  Named<mpm::BoundaryOptions> boundaries;     // [boundary.NAME]
  Named<mpm::RigidOptions> bodies;            // [body.NAME]
  Named<mpm::ContactOptions> contacts;        // [contact.NAME]
  std::optional<mpm::CentrifugeOptions> centrifuge;  // [centrifuge]
  std::optional<mpm::WaterOptions> water;     // [water]
  std::optional<mpm::HeatOptions> heat;       // [heat]
  compare::CompareOptions compare;            // [compare]
  compare::LimitOptions limits;               // [compare.limits]
  report::ReportOptions report;               // [report]
  OutputOptions output;                       // [output]
  std::optional<SynthOptions> synth;          // [synth]
  image::TextureOptions texture;              // [synth.texture]
  SynthCameraOptions synth_camera;            // [synth.camera]
  Named<mpm::MaterialOptions> synth_materials;  // [synth.material.NAME]
  std::optional<mpm::MpmOptions> synth_mpm;     // [synth.mpm]
  VerifyOptions verify;                       // [verify]
};

/// Reads a case. `path` is a TOML file or a folder with case.toml. Throws InputError of one line:
/// "FILE:LINE: unknown key 'piv.window'; did you mean 'window_px'?", wrong type, out of range, unknown choice,
/// duplicate key, syntax error, and what only the whole case shows (a region without a material, np without piv ...).
/// `given`: keys given beside the file, "piv.window_px=24" each, which win over it (given_keys.hpp).
/// `frames_follow`: frames are named beside the file; a case without frames of its own is read as if it had an empty [frames].
Case read_case(const std::filesystem::path& path, const std::vector<std::string>& given = {}, bool frames_follow = false);

/// The same from text; `name` stands in messages.
Case parse_case(const std::string& text, const std::string& name, const std::filesystem::path& folder,
                const std::vector<std::string>& given = {}, bool frames_follow = false);

/// The case of a record, which a later version may have written: sections, keys and values that this one does not know are
/// left out, with a note each. Throws InputError where the text is no TOML, or where a section is none.
Case parse_recorded_case(const std::string& text, const std::string& name, const std::filesystem::path& folder);

/// The case as run: every default filled in, as TOML that reads back to the same case.
std::string write_case(const Case& c);

/// A message about a key of this case, "camera.origin_px: expected ...", with its place before it: "FILE:LINE: camera.
/// origin_px: ..." (the line of its section where the key is left out). Other messages come back as they are.
std::string with_place(const Case& c, const std::string& message);

/// What a case's output folder is called: its folder's name (case.toml), else the file's; gate_slope if embedded.
std::string short_name(const Case& c);

/// The text of the embedded default case, datasets/gate_slope/case.toml as it was when the program was built.
std::string embedded_case_text();

/// The reference of all keys (docs/case.md), made from the option lists.
std::string case_reference();

/// The JSON schema (draft 7) of a case's TOML, for editors (docs/case.schema.json), made from the same lists.
std::string case_schema();

}  // namespace pivnp::app

#include "apps/case/init.hpp"

#include <algorithm>
#include <cmath>

#include "apps/case/case.hpp"
#include "apps/case/listing.hpp"
#include "apps/case/values.hpp"

namespace pivnp::app {

namespace fs = std::filesystem;

namespace {

// The frames as the case names them: absolute paths stay, others become relative to the case's folder.
std::string path_in_case(const InitOptions& options) {
  if (fs::path(options.frames).is_absolute()) return options.frames;
  const fs::path frames = fs::absolute(options.frames).lexically_normal();
  return frames.lexically_proximate(fs::absolute(options.folder).lexically_normal()).string();
}

// A grid that fits small images too: half of a window that is no more than an eighth of the image.
int window_for(const FrameFacts& facts) {
  int window = 32;
  while (window > 8 && window * 8 > std::min(facts.width, facts.height)) window /= 2;
  return window;
}

// All keys of a section as comments "# key = default  # unit: meaning", but for those in `skip`.
std::string commented_keys(const std::string& path, const std::vector<std::string>& skip) {
  std::string lines;
  for (const SectionRow& section : case_sections()) {
    if (section.path != path) continue;
    for (const KeyRow& row : section.keys) {
      if (std::find(skip.begin(), skip.end(), row.key) != skip.end()) continue;
      const std::string unit = row.unit.empty() ? "" : row.unit + ": ";
      lines += "# " + row.key + " = " + (row.fallback.empty() ? "..." : row.fallback) + "  # " + unit + row.text + "\n";
    }
  }
  return lines;
}

// A dozen lines: what nobody but the user knows. The name is that of the folder.
std::string short_case(const InitOptions& options, const FrameFacts& facts, const Points& outline, int window) {
  const std::string rate = facts.rate_hz ? toml_text(*facts.rate_hz) + "  # what the video claims" : "50.0  # frames per second; left out: times are counted in frames";
  return "# pivnp check FILE draws this case on the first frame; pivnp init --all and docs/case.md name all other keys.\n"
         "[frames]  # " + std::to_string(facts.count) + " frames of " + std::to_string(facts.width) + " x " + std::to_string(facts.height) + " px\n"
         "path = " + toml_text(path_in_case(options)) + "\n" +
         (options.rate_hz ? "rate_hz = " + toml_text(*options.rate_hz) : "# rate_hz = " + rate) +
         "\n\n[camera]\n" +
         (options.metres_per_pixel ? "metres_per_pixel = " + toml_text(*options.metres_per_pixel) : std::string("# metres_per_pixel = 2.0e-4  # left out: lengths are in px")) +
         "\n\n[region.soil]  # where the material is at the first frame: EDIT THIS, (column, row) with rows downward\n"
         "polygon_px = " + toml_text(outline) +
         "\n\n[piv]\nwindow_px = " + std::to_string(window) + "  # 8 or more grains or blobs in a window\n";
}

std::string frames_section(const InitOptions& options, const FrameFacts& facts) {
  std::string text = "[frames]  # " + std::to_string(facts.count) + " frames of " + std::to_string(facts.width) +
                     " x " + std::to_string(facts.height) + " px\n";
  text += "path = " + toml_text(path_in_case(options)) + "\n";
  if (options.rate_hz)
    text += "rate_hz = " + toml_text(*options.rate_hz) + "\n";
  else if (facts.rate_hz)
    text += "# rate_hz = " + toml_text(*facts.rate_hz) +
            "  # what the video claims and what is used; high-speed videos often claim the rate of playing\n";
  else
    text += "# rate_hz = 50.0  # frames per second; without it times are counted in frames\n";
  return text + commented_keys("frames", {"path", "rate_hz"});
}

std::string camera_section(const InitOptions& options, const FrameFacts& facts) {
  std::string text = "\n[camera]\n";
  text +=
      options.metres_per_pixel
          ? "metres_per_pixel = " + toml_text(*options.metres_per_pixel) + "\n"
          : std::string("# metres_per_pixel = 2.0e-4  # default: lengths are in px, and every _m below means px\n");
  text += "# origin_px = [0.0, " + toml_text(double(facts.height - 1)) +
          "]  # pixel (column, row) of the world's (0, 0); default: the lower left pixel\n";
  text += "# points_px = [[100, 900], [1800, 900], [1800, 100], [100, 100]]  # or targets in the image ...\n";
  text +=
      "# points_m = [[0.0, 0.0], [0.34, 0.0], [0.34, 0.16], [0.0, 0.16]]  # ... and in the world, for a tilted "
      "camera\n";
  return text;
}

std::string region_sections(const Points& outline) {
  std::string text =
      "\n# Where the material is at the first frame: EDIT THIS. Points are (column, row), row downward.\n";
  text += "[region.soil]\npolygon_px = " + toml_text(outline) + "\n";
  text += "# polygon_m in place of polygon_px gives the outline in the world, y upward.\n";
  text += "\n# What must not be measured (glare, labels, a structure): one section each, as many as needed.\n";
  text += "# [mask.glare]\n# circle_px = [100.0, 100.0, 20.0]  # centre column, row, radius\n";
  return text;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Comments within what is itself commented out; keys without a default stay comments when it no longer is.
std::string keys_to_uncomment(const std::string& path, const std::vector<std::string>& skip) {
  std::string lines, text = commented_keys(path, skip);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    lines += (line.find(" = ...") != std::string::npos ? "# " : "") + line + "\n";
    at = end + 1;
  }
  return lines;
}

// The base lies under the region that the template names, walls stand at its sides: it rests until one is taken away.
std::string simulation_sections(const InitOptions& options, const FrameFacts& facts, int window) {
  const double scale = options.metres_per_pixel.value_or(2.0e-4);
  const auto metres = [&](double px) { return std::round(px * scale * 1e9) / 1e9; };
  const double left = metres(window), right = metres(std::max(facts.width - 1.0 - window, window + 1.0));
  const double base = metres(std::max(0.0, facts.height - 1.0 - std::max(facts.height - 1.0 - window, window + 1.0)));
  const double top = metres(facts.height - 1.0 - window);
  const auto line = [](double x0, double y0, double x1, double y1) { return toml_text(Points{{x0, y0}, {x1, y1}}); };
  return R"(
# The simulation. To compare one with the measurement give frames.rate_hz and camera.metres_per_pixel above, then remove
# the first '# ' of every line below.
# [material.soil]  # the region's name
# model = "mohr_coulomb"  # )" +
         listed(mpm::material_model_names()) + R"(
# density_kg_m3 = 1600.0
# young_pa = 10e6
# poisson = 0.3
# friction_deg = 35.0
# cohesion_pa = 0.0
#
# [mpm]
)" + keys_to_uncomment("mpm", {"end_s", "output_rate_hz", "domain_m"}) +
         R"(#
# [boundary.base]
# line_m = )" + line(left, base, right, base) + R"(  # two ends; nodes within half a cell are held
# type = "fixed"  # )" +
         listed(choice_names<mpm::BoundaryType>()) + R"(
#
# [boundary.left]  # walls at both sides; until_s takes one away
# line_m = )" + line(left, base, left, top) + R"(
# type = "roller"
#
# [boundary.right]
# line_m = )" + line(right, base, right, top) + R"(
# type = "roller"
#
# [compare.limits]  # a limit that is exceeded ends the program with exit code 3
# displacement_rms_m = 0.005
)";
}

}  // namespace

std::string initial_case(const InitOptions& options, const FrameFacts& facts) {
  const int window = window_for(facts);
  const double left = window, right = std::max(facts.width - 1.0 - window, left + 1);
  const double top = window, bottom = std::max(facts.height - 1.0 - window, top + 1);
  const Points outline = {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
  std::string text = options.schema.empty() ? "" : "#:schema " + options.schema + "\n";
  if (!options.all) return text + short_case(options, facts, outline, window);
  text +=
      "# A case for pivnp. Lines that begin with '#' show what is chosen when nothing is said.\n"
      "# pivnp check FILE draws grid, masks and regions on the first frame; docs/case.md lists all keys.\n\n";
  const std::string folder = fs::absolute(options.folder / "x").lexically_normal().parent_path().filename().string();
  text += "name = " + toml_text(folder.empty() ? "experiment" : folder) + "\n\n";
  text += frames_section(options, facts) + camera_section(options, facts);
  text += "\n[grid]\nspacing_px = " + toml_text(double(window) / 4) + "  # distance of the nodes: a quarter of the window\n";
  text += commented_keys("grid", {"spacing_px", "spacing_m", "area_m"});
  text += region_sections(outline);
  text += "\n[piv]\nwindow_px = " + std::to_string(window) +
          "  # side of the last window; about 8 or more grains or blobs should fall into it\n" +
          commented_keys("piv", {"window_px"});
  text += "\n[np]\n" + commented_keys("np", {});
  return text + simulation_sections(options, facts, window);
}

std::string init_case(const InitOptions& options) {
  image::FrameOptions wanted;
  wanted.path = options.frames;
  const auto source = image::open_frames(wanted, fs::current_path());
  const auto& frames = source->frames();
  FrameFacts facts{source->width(), source->height(), frames.size(), {}};
  if (source->has_rate() && frames.size() > 1) {
    const double rate = double(frames.size() - 1) / (frames.back().time - frames.front().time);
    if (std::isfinite(rate) && rate > 0) facts.rate_hz = std::round(rate * 1000) / 1000;  // times carry round-off
  }
  return initial_case(options, facts);
}

}  // namespace pivnp::app

#include "apps/study/pipeline/record/record_head.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace pivnp::app {

std::string keys_of_stage(const std::string& case_text, const std::string& stage) {
  constexpr std::array results{"name", "compare", "report", "output", "verify"};
  constexpr std::array simulation{"material", "mpm", "initial", "boundary", "body", "contact", "centrifuge", "water", "heat"};
  const bool simulated = stage != "piv" && stage != "motion/np";
  std::string text, section = "name";  // the one key above all sections
  std::istringstream lines(case_text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[")) section = line.substr(1, line.find_first_of(".]") - 1);
    const auto in = [&](const auto& list) { return std::find(list.begin(), list.end(), section) != list.end(); };
    if (line.empty() || in(results) || (in(simulation) && !simulated)) continue;
    // What is at rest tells the vectors how the camera moved.
    if (section == "np" && (simulated || (stage == "piv" && !line.starts_with("still_zone_px")))) continue;
    text += line + "\n";
  }
  return text;
}

io::RecordHead record_head(const Case& c, const Setting& setting, const RunSettings& settings) {
  io::RecordHead head;
  head.command = settings.command;
  head.case_text = write_case(c);
  head.length_unit = setting.camera.length_unit();
  head.grid = setting.grid;
  head.per_radian = c.mpm && c.mpm->geometry == mpm::Geometry::axisymmetric;
  head.sources = setting.sources;
  head.world_from_pixel = setting.camera.world_from_pixel();
  const image::Lens& lens = setting.camera.lens();
  if (!lens.straight()) {
    head.lens = name_of(lens.model());
    head.distortion = lens.coefficients();
    head.focal = {lens.focal().x(), lens.focal().y()};
    head.principal = {lens.centre().x(), lens.centre().y()};
    const image::Window& window = lens.window();
    if (window.thickness > 0) head.window = {window.thickness, window.distance, window.index};
  }
  return head;
}

}  // namespace pivnp::app

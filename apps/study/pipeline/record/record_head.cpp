#include "apps/study/pipeline/record/record_head.hpp"

namespace pivnp::app {

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

#include "apps/study/pipeline/record_head.hpp"

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
  return head;
}

}  // namespace pivnp::app

#include "compare/alignment/bring_together.hpp"

#include <cmath>
#include <numbers>

#include "compare/alignment/outlines.hpp"
#include "compare/data/data_set.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::compare {

namespace {

std::string name_in_quotes(const MotionSource& motion) { return "'" + motion.name() + "'"; }

Transform declared(const CompareOptions& options) {
  Transform t;
  t.scale = options.second_scale;
  t.angle = options.second_rotation_deg * std::numbers::pi / 180;
  t.shift = Vec2(options.second_shift_m[0], options.second_shift_m[1]);
  t.time_scale = options.second_time_scale;
  t.time_offset = options.time_offset_s;
  return t;
}

// The offset to add to the second's times, with what it is uncertain by.
Onset find_offset(const MotionSource& first, const MotionSource& second, const CompareOptions& options) {
  const bool turn = !options.fixed_zone_m.empty();
  const Points& zone = turn ? options.fixed_zone_m : options.reference_m;
  const Onset offset = onset_offset(participation(first, zone, turn), participation(second, zone, turn));
  if (!std::isfinite(offset.time))
    throw InputError("compare.time_alignment: \"onset\", but motion " + name_in_quotes(first) + " or " + name_in_quotes(second) +
                     " shows no onset, expected both to move from rest");
  return offset;
}

// The rigid motion that brings the second's outline at the common start onto the first's.
RigidFit find_place(const MotionSource& first, const MotionSource& second, const CompareOptions& options) {
  const CommonTimes common = common_times(first, second);
  const DataSet a(first, common), b(second, common);
  return match_data_sets(a, b, options.fixed_zone_m);
}

}  // namespace

Together bring_together(const MotionSource& first, const MotionSource& second, const CompareOptions& options) {
  Together together{declared(options), {}, {}};
  Transform& transform = together.second;
  if (options.time_alignment == TimeAlignment::onset) {
    together.time = find_offset(first, TransformedMotion(second, transform), options);
    transform.time_offset += together.time->time;
  }
  if (options.space_alignment == SpaceAlignment::outline) {
    together.place = find_place(first, TransformedMotion(second, transform), options);
    const RigidMotion& m = together.place->motion;
    transform.shift = m.apply(transform.shift);
    transform.angle += m.angle;
  }
  return together;
}

}  // namespace pivnp::compare

// A record as the window shows it: fields on particles, vectors, frames, histories. One thread only, as records are read.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/plot/raster.hpp"
#include "apps/plot/scale.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/content/point_curves.hpp"
#include "apps/view/model/frames.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::view {

struct ShownField {
  std::string name, label, unit;
};

/// One motion at one time, coloured by a field.
struct ParticlePicture {
  std::string motion;
  std::size_t index = 0;      // of its times; `known` says whether there is one
  bool known = false;
  report::FieldAtTime field;
  std::vector<double> sigma;  // of `field.value`, where the record states it; else empty
};

/// Of a place that was clicked.
struct History {
  Vec2 x0 = Vec2::Zero();
  struct Side {
    std::string motion;
    report::PointCurve curve;
  };
  std::vector<Side> sides;
};

class RecordLook {
 public:
  /// Throws InputError with the command line's words.
  explicit RecordLook(const std::filesystem::path& record);

  const std::filesystem::path& file() const { return file_; }
  const std::vector<std::string>& motions() const { return names_; }
  const std::vector<double>& times() const { return times_; }  // of all motions and frames together, in order
  const std::string& length_unit() const { return head_.length_unit; }
  const std::string& time_unit() const { return head_.time_unit; }
  const std::string& complaint() const { return complaint_; }  // about frames that are not there; empty: none
  bool has_frames() const { return frames_ != nullptr; }
  const plot::Box& box() const { return box_; }                // of all that is ever shown
  /// What any of the motions can be coloured by; displacement_error is the stated standard uncertainty of a component.
  const std::vector<ShownField>& fields() const { return fields_; }

  ParticlePicture picture(const std::string& motion, const std::string& field, double time) const;
  /// The frame nearest to the time; nullptr without frames.
  std::shared_ptr<const Image> frame(double time) const;
  const Mat3& world_from_pixel() const { return head_.world_from_pixel; }
  /// The pair that begins nearest to the time; none without vectors.
  std::optional<VectorField> vectors(double time) const;
  /// Second minus first field at the particles of the first, by id, where both are alive; empty where the two share no material.
  static ParticlePicture difference(const ParticlePicture& first, const ParticlePicture& second, const MotionSource& of_first,
                                    const MotionSource& of_second);
  const MotionSource& motion(const std::string& name) const;
  /// Of the particle nearest to `place` at that time, in each of the motions. Throws InputError where none is near.
  History history(const std::string& motion, const ParticlePicture& shown, const Vec2& place, const std::vector<std::string>& sides) const;

 private:
  std::filesystem::path file_;
  std::unique_ptr<io::RecordReader> reader_;
  io::RecordHead head_;
  std::vector<std::string> names_;
  std::vector<std::shared_ptr<const MotionSource>> motions_;
  std::vector<double> times_;
  std::vector<ShownField> fields_;
  std::vector<Frame> listed_;
  std::shared_ptr<SharedFrames> frames_;
  std::string complaint_;
  plot::Box box_;
  bool central_ = true;
};

/// One scale for all pictures; `share` of the values is beyond its two ends together. Symmetric where both signs occur.
plot::Scale scale_of(const std::vector<const ParticlePicture*>& pictures, double share);

/// Particles as deformed squares over `box`, `width` px wide; those that ended pale.
plot::Raster raster_of(const ParticlePicture& picture, const plot::Scale& scale, const plot::Box& box, int width);

/// id, x0, y0, x, y, status, value and its standard uncertainty of each particle, as CSV with units.
std::string csv_of(const ParticlePicture& picture, const MotionSource& motion, const ShownField& field);

}  // namespace pivnp::view

// The motion of particles through time, whoever made it: numerical particles, material points, an import.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/end_reason.hpp"

namespace pivnp {

enum class ParticleStatus : std::uint8_t {
  unborn = 0,
  active = 1,
  flagged = 2,  // followed, but this step rests on replaced vectors or on a local fit
  ended = 3,    // values are those of the last good time
};

/// What stays the same for every particle; index = position in every per-particle array.
struct ParticleSet {
  std::vector<std::int64_t> id;   // stable; equal ids of two motions seeded alike mean the same material
  std::vector<std::int32_t> label;  // index into label_names: region, layer or body
  std::vector<Vec2> x0;           // material position (at the first frame), length unit
  std::vector<double> area;       // represented area at birth, length^2
  std::vector<double> born;       // time of birth
  std::vector<double> end;        // time of the last good state; NaN while the particle is followed to the last frame
  std::vector<EndReason> end_reason;
  std::vector<std::string> label_names;

  std::size_t size() const { return id.size(); }
};

struct MotionField;  // a row of motion_fields(), see fields.hpp

/// One field of a frame: `values` is [P][components].
struct FieldValues {
  const MotionField* field = nullptr;
  std::size_t components = 1;
  std::vector<float> values;

  float operator()(std::size_t particle, std::size_t component = 0) const {
    return values[particle * components + component];
  }
  float& operator()(std::size_t particle, std::size_t component = 0) { return values[particle * components + component]; }
};

/// One instant. Per-particle arrays; those a source does not know are empty. What each holds: motion_fields().
struct MotionFrame {
  double time = 0;
  std::vector<std::array<float, 2>> u;       // displacement since x0; position is x0 + u
  std::vector<std::array<float, 4>> F;       // deformation gradient, row-major xx xy yx yy
  std::vector<ParticleStatus> status;
  std::vector<std::array<float, 3>> cov_u;   // uu, vv, uv: covariance of u (measurement)
  std::vector<std::array<float, 2>> v;       // velocity, where the source states it
  std::vector<FieldValues> fields;           // what else the source knows: stress, plastic_dev ...

  /// nullptr: not known.
  const FieldValues* find(std::string_view name) const;
  /// Throws std::logic_error where it is not known.
  const FieldValues& field(std::string_view name) const;
  /// Zeros of a listed field for so many particles, in place of what the frame had of it; a later add() leaves them
  /// where they are. Throws std::logic_error for a name that is not listed.
  std::span<float> add(std::string_view name, std::size_t particles);
};

/// A motion to read frame by frame; memory is the caller's choice. Implementations: MotionMemory, the record reader.
class MotionSource {
 public:
  virtual ~MotionSource() = default;
  virtual const std::string& name() const = 0;
  virtual const std::string& length_unit() const = 0;
  virtual const std::string& time_unit() const = 0;
  virtual const ParticleSet& particles() const = 0;
  virtual const std::vector<double>& times() const = 0;
  virtual MotionFrame frame(std::size_t index) const = 0;
};

/// A motion held in memory.
class MotionMemory final : public MotionSource {
 public:
  MotionMemory(std::string name, std::string length_unit, std::string time_unit, ParticleSet particles);
  void add(MotionFrame frame);

  const std::string& name() const override { return name_; }
  const std::string& length_unit() const override { return length_unit_; }
  const std::string& time_unit() const override { return time_unit_; }
  const ParticleSet& particles() const override { return particles_; }
  const std::vector<double>& times() const override { return times_; }
  MotionFrame frame(std::size_t index) const override { return frames_.at(index); }

 private:
  std::string name_, length_unit_, time_unit_;
  ParticleSet particles_;
  std::vector<double> times_;
  std::vector<MotionFrame> frames_;
};

}  // namespace pivnp

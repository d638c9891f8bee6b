// The values that the module's sources share.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/comparison.hpp"
#include "pivnp/core/record/strain_note.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "python/src/arrays.hpp"

namespace pivnp::python {

/// The case that options given as TOML come to; messages name their keys, without a line. Throws InputError.
app::Case case_of(const std::string& toml, const std::vector<std::string>& given = {});

struct Vectors {
  VectorField field;
  std::string length_unit;
};

/// One instant of a motion.
struct Instant {
  MotionFrame frame;
};

/// A motion of a record, of another program, or kept in memory.
struct Motion {
  std::shared_ptr<MotionSource> source;
  std::optional<StrainNote> note;  // what its record states with its strains
  double residual = 0;             // of the camera it was measured with, length
  bool central = true;             // anchor of its increments
  bool file = false;               // reading it is HDF5's work
};

/// A motion that grows while it is read: what an engine leaves behind, frame by frame.
class KeptMotion final : public MotionSource {
 public:
  KeptMotion(std::string name, std::string length_unit, std::string time_unit, ParticleSet particles,
             std::vector<std::shared_ptr<const MotionFrame>> frames);
  const std::string& name() const override { return name_; }
  const std::string& length_unit() const override { return length_unit_; }
  const std::string& time_unit() const override { return time_unit_; }
  const ParticleSet& particles() const override { return particles_; }
  const std::vector<double>& times() const override { return times_; }
  MotionFrame frame(std::size_t index) const override { return *frames_.at(index); }

 private:
  std::string name_, length_unit_, time_unit_;
  ParticleSet particles_;
  std::vector<std::shared_ptr<const MotionFrame>> frames_;
  std::vector<double> times_;
};

/// A comparison as lists of tuples, whose arrays are its own.
py::dict in_python(const Comparison& comparison);

void bind_vectors(py::module_& m);
void bind_motions(py::module_& m);
void bind_tracker(py::module_& m);
void bind_simulation(py::module_& m);
void bind_comparison(py::module_& m);

}  // namespace pivnp::python

// Motions and records: what was measured, simulated or imported, as arrays.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "apps/study/pipeline/record/opened_motion.hpp"
#include "apps/study/pipeline/record/remarks.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/core/particles/gauge.hpp"
#include "pivnp/core/particles/places.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/records/record.hpp"
#include "python/src/guard.hpp"
#include "python/src/parts.hpp"

namespace pivnp::python {

KeptMotion::KeptMotion(std::string name, std::string length_unit, std::string time_unit, ParticleSet particles,
                       std::vector<std::shared_ptr<const MotionFrame>> frames)
    : name_(std::move(name)),
      length_unit_(std::move(length_unit)),
      time_unit_(std::move(time_unit)),
      particles_(std::move(particles)),
      frames_(std::move(frames)) {
  for (const auto& frame : frames_) times_.push_back(frame->time);
}

namespace {

Shape shape_of(const MotionField& field, std::size_t particles) {
  Shape shape{py::ssize_t(particles)};
  if (field.form == FieldForm::tensor) {
    shape.insert(shape.end(), {2, 2});
  } else if (field.components() > 1) {
    shape.push_back(py::ssize_t(field.components()));
  }
  return shape;
}

const MotionField* recorded(const std::string& name) {
  for (const MotionField& field : motion_fields())
    if (field.name == name) return &field;
  return nullptr;
}

std::vector<std::string> names_in(const MotionFrame& frame) {
  std::vector<std::string> names;
  for (const MotionField& field : motion_fields())
    if (particles_with(frame, field) > 0) names.push_back(field.name);
  return names;
}

[[noreturn]] void refuse_field(const std::string& name, const std::vector<std::string>& held) {
  std::string list;
  for (const std::string& n : held) list += (list.empty() ? "" : ", ") + n;
  throw InputError("field: found \"" + name + "\", which this motion does not hold; it holds " + list +
                   ", and what follows from u and F");
}

py::array instant_values(const std::shared_ptr<Instant>& instant, const std::string& name) {
  const MotionField* field = recorded(name);
  const std::size_t count = field ? particles_with(instant->frame, *field) : 0;
  if (count == 0) refuse_field(name, names_in(instant->frame));
  const void* data = values_of(instant->frame, *field);
  const py::object owner = py::cast(instant);
  return field->form == FieldForm::code ? view<std::uint8_t>(data, shape_of(*field, count), owner)
                                        : view<float>(data, shape_of(*field, count), owner);
}

// Reading by one thread at a time, without the interpreter's lock.
template <class Read>
auto read_from(const Motion& motion, const Read& read) {
  return unlocked([&](Progress& progress) {
    std::unique_lock<std::mutex> lock(hdf5_mutex(), std::defer_lock);
    if (motion.file) lock.lock();
    return read(progress);
  });
}

std::vector<std::size_t> checked_frames(const Motion& motion, const std::vector<std::int64_t>& frames) {
  const auto count = std::int64_t(motion.source->times().size());
  std::vector<std::size_t> out;
  for (const std::int64_t k : frames) {
    if (k < 0 || k >= count) throw py::index_error("frame " + std::to_string(k) + " of " + std::to_string(count));
    out.push_back(std::size_t(k));
  }
  return out;
}

// [frames][P][...], straight into the array.
py::array recorded_values(const Motion& motion, const MotionField& field, const std::vector<std::size_t>& frames) {
  const std::size_t particles = motion.source->particles().size();
  Shape shape = shape_of(field, particles);
  shape.insert(shape.begin(), py::ssize_t(frames.size()));
  const bool code = field.form == FieldForm::code;
  py::array array(code ? py::dtype::of<std::uint8_t>() : py::dtype::of<float>(), shape);
  const std::size_t bytes = particles * field.components() * (code ? 1 : sizeof(float));
  auto* to = static_cast<std::byte*>(array.mutable_data());
  read_from(motion, [&](Progress& progress) {
    for (const std::size_t k : frames) {
      if (progress.stop_requested()) throw Interrupted();
      const MotionFrame frame = motion.source->frame(k);
      if (particles_with(frame, field) != particles) refuse_field(field.name, names_in(frame));
      std::memcpy(to, values_of(frame, field), bytes);
      to += bytes;
    }
  });
  return array;
}

py::array computed_values(const Motion& motion, const std::string& name, const std::vector<std::size_t>& frames) {
  derived_field(name);  // throws for a name that is not known
  const std::size_t particles = motion.source->particles().size();
  py::array_t<double> array(Shape{py::ssize_t(frames.size()), py::ssize_t(particles)});
  double* to = array.mutable_data();
  read_from(motion, [&](Progress& progress) {
    DerivedReader reader(*motion.source, motion.central);
    for (const std::size_t k : frames) {
      if (progress.stop_requested()) throw Interrupted();
      const std::vector<double> values = reader.values(name, k);
      to = std::copy(values.begin(), values.end(), to);
    }
  });
  return array;
}

py::array values(const Motion& motion, const std::string& name, const std::vector<std::int64_t>& frames) {
  const std::vector<std::size_t> wanted = checked_frames(motion, frames);
  const MotionField* field = recorded(name);
  return field ? recorded_values(motion, *field, wanted) : computed_values(motion, name, wanted);
}

struct FieldNote {
  std::string unit, definition;
};

FieldNote note_on(const Motion& motion, const std::string& name) {
  const std::string &L = motion.source->length_unit(), &T = motion.source->time_unit();
  if (const MotionField* field = recorded(name)) return {unit_in(field->unit, L, T), field->definition};
  const DerivedField field = derived_field(name);
  return {unit_in(field.unit, L, T), field.definition};
}

std::vector<std::string> computed_names(const std::vector<std::string>& held) {
  std::vector<std::string> names;
  for (const DerivedField& field : derived_fields())
    if ((field.source.empty() || std::find(held.begin(), held.end(), field.source) != held.end()) &&
        std::find(held.begin(), held.end(), field.name) == held.end())
      names.push_back(field.name);
  return names;
}

// The motion as another source shows it.
Motion seen_as(const Motion& motion, std::shared_ptr<const MotionSource> source) {
  Motion out = motion;
  out.source = std::const_pointer_cast<MotionSource>(std::move(source));
  return out;
}

Vec2 point_of(const std::array<double, 2>& x) { return {x[0], x[1]}; }

Motion at_material_points(const Motion& motion, const std::vector<std::array<double, 2>>& points) {
  std::vector<Vec2> x;
  for (const auto& p : points) x.push_back(point_of(p));
  return seen_as(motion, at_points(motion.source, x));
}

Motion mean_in(const Motion& motion, const std::array<double, 2>& one, const std::array<double, 2>& two) {
  const Vec2 a = point_of(one), b = point_of(two);
  return seen_as(motion, in_rectangle(motion.source, a.cwiseMin(b), a.cwiseMax(b), motion.note ? motion.note->gauge_length : 0));
}

// Sigma: NaN where it is not known.
py::tuple curve_of(std::vector<double> at, std::vector<double> value, std::vector<double> sigma) {
  const py::ssize_t n = py::ssize_t(value.size());
  if (sigma.empty()) sigma.assign(value.size(), nan_value);
  return py::make_tuple(taken<double>(std::move(at), {n}), taken<double>(std::move(value), {n}), taken<double>(std::move(sigma), {n}));
}

py::tuple strain_between(const Motion& motion, const std::array<double, 2>& from, const std::array<double, 2>& to) {
  ExtensometerCurve c = read_from(motion, [&](Progress&) { return extensometer(*motion.source, point_of(from), point_of(to)); });
  return curve_of(std::move(c.time), std::move(c.strain), std::move(c.sigma));
}

py::tuple along(const Motion& motion, const std::string& name, const std::array<double, 2>& from, const std::array<double, 2>& to,
                std::int64_t frame) {
  derived_field(name);
  const std::size_t k = checked_frames(motion, {frame}).front();
  SectionCurve c = read_from(motion, [&](Progress&) { return section(*motion.source, name, motion.central, k, point_of(from), point_of(to)); });
  return curve_of(std::move(c.distance), std::move(c.value), std::move(c.sigma));
}

Motion opened(app::OpenedMotion from, bool central) {
  Motion motion;
  motion.residual = from.residual();
  motion.note = from.note;
  motion.source = std::move(from.motion);
  motion.central = central;
  motion.file = true;
  return motion;
}

// A finished record. The lock is held while HDF5 works.
class Record {
 public:
  explicit Record(const std::string& file) : file_(file) {
    unlocked([&](Progress&) {
      const std::lock_guard lock(hdf5_mutex());
      reader_ = std::make_unique<io::RecordReader>(file);
    });
  }
  template <class Read>
  auto read(const Read& read) const {
    return unlocked([&](Progress&) {
      const std::lock_guard lock(hdf5_mutex());
      return read(*reader_);
    });
  }
  const io::RecordHead& head() const { return reader_->head(); }

  Motion motion(const std::string& name) const {
    return read([&](const io::RecordReader& r) {
      const std::vector<std::string> names = r.motion_names();
      if (std::find(names.begin(), names.end(), name) == names.end()) {
        std::string known;
        for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
        throw InputError(file_ + ": no motion '" + name + "'; it holds: " + known);
      }
      const bool central = r.pair_count() == 0 || r.pair(0).anchor == Anchor::central;
      return opened({r.head(), std::shared_ptr<MotionSource>(r.motion(name)), r.strain_note(name)}, central);
    });
  }

 private:
  std::string file_;
  std::unique_ptr<io::RecordReader> reader_;
};

py::dict energy_columns(const std::vector<EnergyRow>& rows) {
  const std::pair<const char*, double EnergyRow::*> columns[] = {
      {"time", &EnergyRow::time},         {"kinetic", &EnergyRow::kinetic},  {"elastic", &EnergyRow::elastic},
      {"plastic", &EnergyRow::plastic},   {"damping", &EnergyRow::damping},  {"contact", &EnergyRow::contact},
      {"external", &EnergyRow::external}, {"residual", &EnergyRow::residual}};
  py::dict out;
  for (const auto& [name, member] : columns) {
    std::vector<double> values;
    for (const EnergyRow& row : rows) values.push_back(row.*member);
    const py::ssize_t count = py::ssize_t(values.size());
    out[name] = taken<double>(std::move(values), {count});
  }
  return out;
}

void bind_motion(py::module_& m) {
  const auto particles = [](const std::shared_ptr<Motion>& motion) -> const ParticleSet& {
    return motion->source->particles();
  };
  py::class_<Motion, std::shared_ptr<Motion>>(m, "Motion")
      .def_property_readonly("name", [](const Motion& v) { return v.source->name(); })
      .def_property_readonly("length_unit", [](const Motion& v) { return v.source->length_unit(); })
      .def_property_readonly("time_unit", [](const Motion& v) { return v.source->time_unit(); })
      .def_property_readonly("time",
                             [](const std::shared_ptr<Motion>& v) {
                               return view<double>(v->source->times().data(), {py::ssize_t(v->source->times().size())},
                                                   py::cast(v));
                             })
      .def_property_readonly("id",
                             [=](const std::shared_ptr<Motion>& v) {
                               return view<std::int64_t>(particles(v).id.data(), {py::ssize_t(particles(v).size())},
                                                         py::cast(v));
                             })
      .def_property_readonly("label",
                             [=](const std::shared_ptr<Motion>& v) {
                               return view<std::int32_t>(particles(v).label.data(), {py::ssize_t(particles(v).size())},
                                                         py::cast(v));
                             })
      .def_property_readonly("label_names", [=](const std::shared_ptr<Motion>& v) { return particles(v).label_names; })
      .def_property_readonly(
          "x0",
          [=](const std::shared_ptr<Motion>& v) {
            return view<double>(particles(v).x0.data(), {py::ssize_t(particles(v).size()), 2}, py::cast(v));
          })
      .def_property_readonly("area",
                             [=](const std::shared_ptr<Motion>& v) {
                               return view<double>(particles(v).area.data(), {py::ssize_t(particles(v).size())},
                                                   py::cast(v));
                             })
      .def_property_readonly("born",
                             [=](const std::shared_ptr<Motion>& v) {
                               return view<double>(particles(v).born.data(), {py::ssize_t(particles(v).size())},
                                                   py::cast(v));
                             })
      .def_property_readonly("end",
                             [=](const std::shared_ptr<Motion>& v) {
                               return view<double>(particles(v).end.data(), {py::ssize_t(particles(v).size())},
                                                   py::cast(v));
                             })
      .def_property_readonly("end_reason",
                             [=](const std::shared_ptr<Motion>& v) {
                               return view<std::uint8_t>(particles(v).end_reason.data(),
                                                         {py::ssize_t(particles(v).size())}, py::cast(v));
                             })
      .def("values", &values, py::arg("name"), py::arg("frames"))
      .def("at", &at_material_points, py::arg("points"))
      .def("mean", &mean_in, py::arg("corner"), py::arg("opposite"))
      .def(
          "with_gauge",
          [](const Motion& v, double diameter) {
            if (!(diameter > 0)) throw InputError("diameter: found " + number(diameter) + ", expected more than 0");
            return seen_as(v, with_gauge(v.source, diameter));
          },
          py::arg("diameter"))
      .def("extensometer", &strain_between, py::arg("start"), py::arg("end"))
      .def("section", &along, py::arg("name"), py::arg("start"), py::arg("end"), py::arg("frame"))
      .def("recorded",
           [](const Motion& v) {
             return v.source->times().empty() ? std::vector<std::string>{}
                                              : names_in(read_from(v, [&](Progress&) { return v.source->frame(0); }));
           })
      .def(
          "computed", [](const Motion&, const std::vector<std::string>& held) { return computed_names(held); },
          py::arg("recorded"))
      .def(
          "unit", [](const Motion& v, const std::string& name) { return note_on(v, name).unit; }, py::arg("name"))
      .def(
          "definition", [](const Motion& v, const std::string& name) { return note_on(v, name).definition; },
          py::arg("name"));

  py::class_<Instant, std::shared_ptr<Instant>>(
      m, "Frame", R"(One instant of a motion: frame["u"] and so on, [P, ...], sharing the engine's memory, read-only.)")
      .def_property_readonly(
          "time", [](const Instant& v) { return v.frame.time; }, "Time, in the motion's unit.")
      .def_property_readonly(
          "names", [](const Instant& v) { return names_in(v.frame); }, "Fields that it holds.")
      .def("__getitem__", &instant_values, py::arg("name"),
           "Values [P, ...] of a recorded field; ValueError where it is not held.");
}

}  // namespace

void bind_motions(py::module_& m) {
  static_assert(sizeof(Vec2) == 2 * sizeof(double));
  bind_motion(m);
  py::class_<Record>(m, "Record")
      .def(py::init<const std::string&>(), py::arg("file"))
      .def_property_readonly("command", [](const Record& r) { return r.head().command; })
      .def_property_readonly("case", [](const Record& r) { return r.head().case_text; })
      .def_property_readonly("length_unit", [](const Record& r) { return r.head().length_unit; })
      .def_property_readonly("time_unit", [](const Record& r) { return r.head().time_unit; })
      .def_property_readonly(
          "schema_version",
          [](const Record& r) { return r.read([](const auto& reader) { return reader.schema_version(); }); })
      .def_property_readonly(
          "pair_count", [](const Record& r) { return r.read([](const auto& reader) { return reader.pair_count(); }); })
      .def_property_readonly(
          "motion_names",
          [](const Record& r) { return r.read([](const auto& reader) { return reader.motion_names(); }); })
      .def_property_readonly(
          "energy",
          [](const Record& r) { return energy_columns(r.read([](const auto& reader) { return reader.energy(); })); })
      .def_property_readonly("comparison",
                             [](const Record& r) -> py::object {
                               const std::optional<Comparison> found =
                                   r.read([](const auto& reader) { return reader.comparison(); });
                               if (!found) return py::none();
                               return in_python(*found);
                             })
      .def("remarks",
           [](const Record& r) {
             py::list out;
             for (const Remark& remark : r.read([](const auto& reader) { return app::remarks_of(reader); }))
               out.append(py::make_tuple(remark.text, int(remark.weight), remark.id));
             return out;
           })
      .def("frames",
           [](const Record& r) {
             py::list names, times, flags;
             for (const Frame& frame : r.read([](const auto& reader) { return std::vector<Frame>(reader.frames()); })) {
               names.append(frame.name);
               times.append(frame.time);
               flags.append(int(frame.flag));
             }
             return py::make_tuple(names, times, flags);
           })
      .def(
          "pair",
          [](const Record& r, std::size_t k) {
            return r.read([&](const auto& reader) {
              if (k >= reader.pair_count())
                throw py::index_error("pair " + std::to_string(k) + " of " + std::to_string(reader.pair_count()));
              return Vectors{reader.pair(k), reader.head().length_unit};
            });
          },
          py::arg("index"))
      .def("motion", &Record::motion, py::arg("name"));
  m.def(
      "open_motion",
      [](const std::string& text, double step, const std::string& length_unit) {
        return unlocked([&](Progress&) {
          const std::lock_guard lock(hdf5_mutex());
          return opened(app::open_motion(text, {.step = step, .length_unit = length_unit}), true);
        });
      },
      py::arg("text"), py::arg("step"), py::arg("length_unit"));
}

}  // namespace pivnp::python

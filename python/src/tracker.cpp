// Numerical particles through vectors that are given pair by pair.
#include <pybind11/stl.h>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/np/tracker.hpp"
#include "python/src/guard.hpp"
#include "python/src/parts.hpp"

namespace pivnp::python {

namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

ParticleSet at_points(const std::vector<Vec2>& x0, double time) {
  ParticleSet set;
  set.x0 = x0;
  set.id.resize(x0.size());
  for (std::size_t k = 0; k < x0.size(); ++k) set.id[k] = std::int64_t(k);
  set.label.assign(x0.size(), 0);
  set.area.assign(x0.size(), 1.0);
  set.born.assign(x0.size(), time);
  set.end.assign(x0.size(), std::numeric_limits<double>::quiet_NaN());
  set.end_reason.assign(x0.size(), EndReason::none);
  set.label_names = {"points"};
  return set;
}

class Tracker {
 public:
  Tracker(const std::string& toml, const Vectors& vectors, const std::vector<std::pair<std::string, Points>>& regions,
          const std::optional<Points>& x0, double time, std::string time_unit)
      : length_unit_(vectors.length_unit),
        time_unit_(std::move(time_unit)),
        central_(vectors.field.anchor == Anchor::central) {
    const np::NpOptions options = case_of(toml).np.value_or(np::NpOptions{});
    ParticleSet set;
    if (x0) {
      set = at_points(positions(*x0, "x0"), time);
    } else {
      const Grid& grid = vectors.field.grid;
      std::vector<Region> all;
      for (const auto& [name, outline] : regions)
        all.push_back({name, Polygon(positions(outline, "regions." + name), "regions." + name)});
      const Vec2 a = grid.origin, b = grid.upper();
      if (all.empty()) all.push_back({"all", Polygon({a, {b.x(), a.y()}, b, {a.x(), b.y()}}, "the grid")});
      set = seed(grid, all, options.per_element, options.seeding, time, "np.per_element");
    }
    tracker_ = std::make_unique<np::Tracker>(options, std::move(set), time);
    keep();
  }

  void step(const Vectors& vectors, double time) {
    turn_.unlocked([&](Progress&) { tracker_->step(vectors.field, time); });
    keep();
  }
  std::shared_ptr<Instant> frame() const { return std::make_shared<Instant>(Instant{tracker().frame()}); }
  std::shared_ptr<Motion> motion() const {
    auto motion = std::make_shared<Motion>();
    motion->source = std::make_shared<KeptMotion>("np", length_unit_, time_unit_, tracker().particles(), frames_);
    motion->central = central_;
    return motion;
  }
  double time() const { return tracker().time(); }
  std::size_t size() const { return tracker().particles().size(); }

 private:
  const np::Tracker& tracker() const {
    turn_.demand();
    return *tracker_;
  }
  void keep() { frames_.push_back(std::make_shared<MotionFrame>(tracker_->frame())); }

  std::string length_unit_, time_unit_;
  bool central_;
  std::unique_ptr<np::Tracker> tracker_;
  std::vector<std::shared_ptr<const MotionFrame>> frames_;
  Turn turn_{"Tracker"};
};

}  // namespace

void bind_tracker(py::module_& m) {
  py::class_<Tracker>(m, "Tracker")
      .def(py::init<const std::string&, const Vectors&, const std::vector<std::pair<std::string, Points>>&,
                    const std::optional<Points>&, double, std::string>(),
           py::arg("toml"), py::arg("vectors"), py::arg("regions"), py::arg("x0"), py::arg("time"),
           py::arg("time_unit"))
      .def("step", &Tracker::step, py::arg("vectors"), py::arg("time"))
      .def("frame", &Tracker::frame)
      .def("motion", &Tracker::motion)
      .def_property_readonly("time", &Tracker::time)
      .def("__len__", &Tracker::size);
}

}  // namespace pivnp::python

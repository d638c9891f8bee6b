// The material point solver on a case given as text.
#include <pybind11/stl.h>

#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "pivnp/core/error.hpp"
#include "python/src/guard.hpp"
#include "python/src/parts.hpp"

namespace pivnp::python {

namespace {

class Solver {
 public:
  Solver(const std::string& toml, const std::string& file, const std::vector<std::string>& given, int threads)
      : case_(file.empty() ? case_of(toml, given) : app::read_case(file, given)) {
    if (case_.frames || case_.vectors || case_.synth)
      throw InputError(
          app::of_file(case_) +
          ": found [frames], [vectors] or [synth], expected a case that only simulates (pivnp.run measures too)");
    if (!case_.mpm) throw InputError(app::of_file(case_) + ": there is nothing to simulate; expected [mpm]");
    setting_ = app::make_setting(case_, 0, 0);
    solver_.reset(new mpm::Solver(app::make_solver(case_, setting_, threads_here(threads))));  // not one that could be moved
  }

  void advance_to(double time) {
    turn_.unlocked([&](Progress& progress) {
      begin(progress);
      solver_->advance_to(time, progress);
    });
  }
  std::shared_ptr<Instant> frame() {
    turn_.unlocked([&](Progress& progress) { begin(progress); });
    return std::make_shared<Instant>(Instant{solver_->frame()});
  }
  std::shared_ptr<Motion> run(const std::vector<double>& times) {
    auto motion = std::make_shared<Motion>();
    turn_.unlocked([&](Progress& progress) {
      begin(progress);
      std::vector<std::shared_ptr<const MotionFrame>> frames;
      for (const double time : times) {
        solver_->advance_to(time, progress);
        frames.push_back(std::make_shared<MotionFrame>(solver_->frame()));
      }
      motion->source = std::make_shared<KeptMotion>("mpm", setting_.camera.length_unit(), "s", solver_->particles(),
                                                    std::move(frames));
    });
    return motion;
  }
  py::dict energy() const {
    const EnergyRow row = solver().energy();
    py::dict out;
    out["kinetic"] = row.kinetic;
    out["elastic"] = row.elastic;
    out["plastic"] = row.plastic;
    out["damping"] = row.damping;
    out["contact"] = row.contact;
    out["external"] = row.external;
    out["residual"] = row.residual;
    return out;
  }
  py::bytes save() const {
    const std::vector<std::byte> bytes = solver().save();
    return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  void load(const std::string& bytes) {
    turn_.demand();
    const auto* data = reinterpret_cast<const std::byte*>(bytes.data());
    solver_->load({data, data + bytes.size()});
    begun_ = true;
  }
  const mpm::Solver& solver() const {
    turn_.demand();
    return *solver_;
  }
  std::optional<double> end_s() const { return case_.mpm->end_s; }
  std::optional<double> rate_hz() const { return case_.mpm->output_rate_hz; }
  std::string text() const { return app::write_case(case_); }

 private:
  void begin(Progress& progress) {
    if (!begun_ && case_.mpm->initial_equilibrium) solver_->find_initial_equilibrium(progress);
    begun_ = true;
  }

  app::Case case_;
  app::Setting setting_;
  std::unique_ptr<mpm::Solver> solver_;
  bool begun_ = false;
  Turn turn_{"Solver"};
};

}  // namespace

void bind_simulation(py::module_& m) {
  py::class_<Solver>(m, "Solver")
      .def(py::init<const std::string&, const std::string&, const std::vector<std::string>&, int>(), py::arg("toml"),
           py::arg("file"), py::arg("given"), py::arg("threads"))
      .def("advance_to", &Solver::advance_to, py::arg("time"))
      .def("frame", &Solver::frame)
      .def("run", &Solver::run, py::arg("times"))
      .def("save", &Solver::save)
      .def("load", &Solver::load, py::arg("state"))
      .def_property_readonly("energy", &Solver::energy)
      .def_property_readonly("time", [](const Solver& s) { return s.solver().time(); })
      .def_property_readonly("steps", [](const Solver& s) { return s.solver().steps(); })
      .def_property_readonly("stable_step", [](const Solver& s) { return s.solver().stable_step(); })
      .def_property_readonly("at_rest", [](const Solver& s) { return s.solver().at_rest(); })
      .def_property_readonly("end_s", &Solver::end_s)
      .def_property_readonly("rate_hz", &Solver::rate_hz)
      .def_property_readonly("case", &Solver::text)
      .def("__len__", [](const Solver& s) { return s.solver().particles().size(); });
}

}  // namespace pivnp::python

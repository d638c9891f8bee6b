#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/case/refusals.hpp"
#include "mpm/material/model.hpp"
#include "mpm/water/pore_soil.hpp"

namespace pivnp::app {

namespace {

class SimulationChecker : Refusals {
 public:
  SimulationChecker(const Case& c, const Source& source) : Refusals{c, source} {}

  void all() const {
    materials();
    simulation();
    centrifuge();
    water();
    initial();
    contacts();
  }

 private:
  void materials() const {
    if (c_.mpm) each_material("material.", c_.materials);
    if (c_.synth_mpm) each_material("synth.material.", c_.synth_materials);
  }

  // The laws' own rules, with the place.
  void each_material(const std::string& prefix, const Named<mpm::MaterialOptions>& materials) const {
    for (const auto& [name, m] : materials) {
      try {
        mpm::check_material(m);
      } catch (const mpm::MaterialFault& fault) {
        refuse(prefix + name + "." + fault.key, fault.text);
      }
    }
  }

  void simulation() const {
    if (!c_.mpm) return;
    materials_of_regions("mpm", "material", c_.materials);
    if (measures()) return;
    if (!c_.mpm->end_s) refuse("mpm.end_s", "missing; without frames the end of the simulation must be given (s)");
    if (!c_.mpm->output_rate_hz)
      refuse("mpm.output_rate_hz", "missing; without frames the rate of the states written must be given (Hz)");
    if (!c_.grid.spacing_m && !c_.grid.spacing_px)
      refuse_section("mpm", "without frames the grid must be given; expected grid.spacing_m");
  }

  void centrifuge() const {
    if (!c_.centrifuge) return;
    if (!c_.mpm && !c_.synth_mpm) refuse_section("centrifuge", "nothing is simulated in it, expected [mpm] or [synth.mpm]");
    for (const char* section : {"mpm", "synth.mpm"}) {
      const auto& options = std::string_view(section) == "mpm" ? c_.mpm : c_.synth_mpm;
      const std::string key = std::string(section) + ".gravity_m_s2";
      if (options && !source_.given(key))
        refuse(key, "left out beside [centrifuge], expected Earth's gravity in the plane of the simulation ([0.0, 0.0] where it acts across it)");
    }
  }

  // What goes with water otherwise is the solver's to say; that there is some is known here.
  void water() const {
    const bool porous = in_pores("material.", c_.materials), in_texture = in_pores("synth.material.", c_.synth_materials);
    if (c_.water) {
      if (!porous && !in_texture) refuse_section("water", "no material has a porosity, expected one that holds water");
      return;
    }
    if (c_.mpm) without_water("mpm.pressure", c_.mpm->pressure.has_value());
    if (c_.synth_mpm) without_water("synth.mpm.pressure", c_.synth_mpm->pressure.has_value());
    for (const auto& [name, b] : c_.boundaries) {
      without_water("boundary." + name + ".pressure_pa", b.pressure_pa.has_value());
      without_water("boundary." + name + ".water_level_m", b.water_level_m.has_value());
      without_water("boundary." + name + ".drained", b.drained);
      without_water("boundary." + name + ".flux_m_s", b.flux_m_s.has_value());
    }
  }

  void without_water(const std::string& key, bool given) const {
    if (given) refuse(key, "given without [water], expected both or neither");
  }

  bool in_pores(const std::string& table, const Named<mpm::MaterialOptions>& materials) const {
    bool any = false;
    for (const auto& [name, m] : materials) {
      if (!c_.water) without_water(table + name + ".porosity", m.porosity.has_value());
      else if (const std::string fault = mpm::fault_of_grains(m, *c_.water); !fault.empty()) refuse(table + name + ".grain_density_kg_m3", fault);
      any |= m.porosity.has_value();
    }
    return any;
  }

  void initial() const {
    std::vector<std::string> known;
    for (const auto& item : c_.regions) known.push_back(item.first);
    for (const auto& [name, o] : c_.initial) {
      const std::string path = "initial." + name;
      if (std::find(known.begin(), known.end(), name) == known.end())
        refuse_section(path, "there is no [region." + name + "]" + did_you_mean(name, known));
      for (const auto& [key, list] : {std::pair{".stress_pa", &o.stress_pa}, {".stress_gradient_pa_m", &o.stress_gradient_pa_m}})
        if (!list->empty() && list->size() != 4)
          refuse(path + key, "found " + std::to_string(list->size()) + " numbers, expected 4: xx yy zz xy");
      if (!o.stress_file.empty() && !o.stress_pa.empty())
        refuse(path + ".stress_file", "given together with stress_pa, expected one of them");
      if (o.stress_pa.empty() && (!o.stress_gradient_pa_m.empty() || o.stress_level_m))
        refuse(path + (o.stress_gradient_pa_m.empty() ? ".stress_level_m" : ".stress_gradient_pa_m"), "given without stress_pa, expected both or neither");
      if (!o.pressure_file.empty() && o.pressure_pa)
        refuse(path + ".pressure_file", "given together with pressure_pa, expected one of them");
      for (const auto& [key, value] : {std::pair{".pressure_gradient_pa_m", &o.pressure_gradient_pa_m}, {".pressure_level_m", &o.pressure_level_m}})
        if (!o.pressure_pa && *value) refuse(path + key, "given without pressure_pa, expected both or neither");
      if (!c_.water)
        without_water(path + (o.pressure_pa ? ".pressure_pa" : ".pressure_file"),
                      o.pressure_pa || !o.pressure_file.empty());
      const bool stressed = !o.stress_pa.empty() || !o.stress_file.empty();
      if (stressed && c_.mpm && c_.mpm->k0) refuse("mpm.k0", "given together with a stress of [" + path + "], expected one of them");
    }
  }

  // How bodies pair is the solver's to say; what they are made of is known here.
  void contacts() const {
    std::vector<std::string> known;
    for (const auto& item : c_.regions) known.push_back(item.first);
    for (const auto& [name, contact] : c_.contacts) {
      const std::string path = "contact." + name;
      if (contact.regions.empty()) refuse(path + ".regions", "missing; expected the names of one or more regions");
      for (const auto& [key, list] : {std::pair{".regions", &contact.regions}, {".against", &contact.against}})
        for (const std::string& region : *list)
          if (std::find(known.begin(), known.end(), region) == known.end())
            refuse(path + key, "there is no [region." + region + "]" + did_you_mean(region, known));
    }
  }
};

}  // namespace

void check_simulation(const Case& c, const Source& source) { SimulationChecker(c, source).all(); }

}  // namespace pivnp::app

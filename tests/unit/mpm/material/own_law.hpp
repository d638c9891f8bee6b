// A law that no source of the solver knows, with a key, rules and history of its own.
#pragma once

#include <memory>

#include "mpm/material/model.hpp"
#include "mpm/state/stress_batch.hpp"

namespace pivnp::mpm::test {

/// Elastic; remembers the sum of its volumetric strain, the signs of the last increment's axes, and whether it was strained.
class OwnLaw final : public Material {
 public:
  OwnLaw(const Elastic& elastic, double scale) : Material(elastic), scale_(scale) {}
  void update(const StressBatch& b) const override {
    for (std::size_t k = 0; k < b.size; ++k) {
      store(b, k, elastic_trial(elastic_, b, k));
      b.history[0][k] += scale_ * (b.de_xx[k] + b.de_yy[k] + b.de_zz[k]);
      b.history[1][k] = b.de_xx[k] > 0 ? 1 : -1;
      b.history[2][k] = b.de_yy[k] > 0 ? 1 : -1;
      b.flags[0][k] = 1;
    }
  }

 private:
  double scale_;
};

inline MaterialModel own_model() {
  return {.name = "of_a_test",
          .text = "elastic, remembers its volume",
          .keys = {{"friction_deg"},
                   {.name = "scale_of_test", .required = true, .own = OptionInfo{.text = "scale of what it remembers", .min = 0, .max = 10}}},
          .history = {{.name = "volume_of_test",
                       .definition = "sum of the volumetric strain, scaled",
                       .recorded = Recorded::declared,
                       .label = "remembered volume"},
                      {.name = "axes_of_test", .form = FieldForm::vector, .reset = false},
                      {.name = "strained_of_test", .form = FieldForm::code, .recorded = Recorded::declared}},
          .check = [](const MaterialOptions& o) {
            require(o.friction_deg <= 10 * *o.own_value("scale_of_test"), "scale_of_test", *o.own_value("scale_of_test"),
                    "a tenth of friction_deg or more");
          },
          .make = [](const MaterialOptions& o, double) -> std::unique_ptr<Material> {
            return std::make_unique<OwnLaw>(Elastic(o.young_pa, o.poisson), *o.own_value("scale_of_test"));
          }};
}

/// Lists it, and takes it off again with its motion fields.
struct OwnLawListed {
  OwnLawListed() { add_material_model(own_model()); }
  ~OwnLawListed() {
    material_models().remove_last();
    for (int k = 0; k < 2; ++k) motion_fields().remove_last();
  }
};

}  // namespace pivnp::mpm::test

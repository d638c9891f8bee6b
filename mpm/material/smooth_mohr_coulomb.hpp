// Mohr-Coulomb on the smooth surface of Abbo & Sloan (abbo_sloan.hpp), integrated by substeps.
//
// Source: Sloan, Abbo & Sheng 2001 (Eng. Comput. 18:121): modified Euler with the error kept below 1e-4 of the stress a
// substep, yield crossing by the Pegasus method, drift corrected along the plastic flow after every substep (else at
// constant mean stress and Lode angle, which the surface allows in closed form). Departures: the strength follows the
// accumulated strain and the pressure inside the step (strength.hpp); the drift's correction softens
// too, so that strength which falls faster than stress can is let down by it; tension, below.
//
// Tension: the mean stress is at most tension, and 0.9 of the apex (next to the surface's vertex). Expansion beyond it is
// kept as the opening strain: volume by which the material stands open; the deviator goes on yielding at that mean stress (Koiter), and
// compression first closes it. Once open, the limit is zero. So sand without cohesion carries next to nothing while
// it is open (the surface's floor), flies free and lands with the volume it left with. An open point's substeps err by
// 1e-4 of max(c, p, 1 kPa), and end where its flow has become steady.
#pragma once

#include "mpm/material/abbo_sloan.hpp"
#include "mpm/material/model.hpp"

namespace pivnp::mpm {

MaterialModel smooth_mohr_coulomb_model();

class SmoothMohrCoulomb final : public Material {
 public:
  SmoothMohrCoulomb(const Elastic& elastic, const StrengthLaw& strength, double tension_pa, double apex_pa);
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
  /// Point `k` by the whole algorithm; update() does so where the lanes' common path does not apply.
  void update_point(const StressBatch& batch, std::size_t k) const;
  double nonlocal_length() const override { return strength_.nonlocal_length(); }

  /// F over max(c, p, 1 kPa) at a stress (Kirchhoff), after a history; J the volume ratio.
  double relative_yield(const Tensor& stress, double history, double J) const;
  const AbboSloan& surface() const { return surface_; }

 private:
  struct Point {
    Tensor stress;
    double history, opening;
    double J;
    bool separated;
    const double* softened_by = nullptr;  // the strain that softens, where given from outside: it stays in the step
  };
  struct Here;  // the surface at a point
  struct Rate {
    Tensor stress;
    double history, opening;
  };
  Tensor stiff(const Tensor& strain) const;
  double energy_of(const Tensor& stress) const;
  double work_of_unresolved(const Tensor& before, const Tensor& after, const Tensor& de) const;
  Strength strength_of(const Point& p, double mean) const;
  Rate rate(const Point& p, const Here& at, const Tensor& de, double way, bool flows) const;
  Rate yielding(const Here& at, const Tensor& de, bool held, double way, bool flows) const;
  double open_leg(Point& p, Here& at, const Tensor& de, double& work, int& substeps) const;
  double elastic_leg(Point& p, const Here& at, const Tensor& rest) const;
  double crossing(const Point& p, const Here& at, const Tensor& ds, double low, double high) const;
  void integrate(Point& p, Here at, const Tensor& de, double& work) const;
  Here correct(Point& p, Here at) const;
  SmoothConstants constants() const;

  StrengthLaw strength_;
  AbboSloan surface_;
  double tension_, bulk_;
  SmoothConstants constants_;
};

}  // namespace pivnp::mpm

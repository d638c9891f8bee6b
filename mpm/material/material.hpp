// Constitutive laws: each updates a batch of material points in one call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mpm/state/stress_batch.hpp"

namespace pivnp::mpm {

struct HistoryVariable;
struct MaterialModel;

/// Isotropic elastic constants.
struct Elastic {
  double lambda = 0, shear = 0;  // Lame's constants, Pa
  double young = 0, poisson = 0;

  Elastic() = default;
  Elastic(double young_pa, double poisson_ratio)
      : lambda(young_pa * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))),
        shear(young_pa / (2 * (1 + poisson_ratio))),
        young(young_pa),
        poisson(poisson_ratio) {}
  double p_wave_modulus() const { return lambda + 2 * shear; }
  /// 1/2 tau : C^-1 : tau, J per initial m^3.
  double energy(double xx, double yy, double zz, double xy) const {
    const double trace = xx + yy + zz;
    return 0.5 / young *
           ((1 + poisson) * (xx * xx + yy * yy + zz * zz + 2 * xy * xy) - poisson * trace * trace);
  }
};

class Material {
 public:
  explicit Material(const Elastic& elastic) : elastic_(elastic) {}
  virtual ~Material() = default;
  virtual void update(const StressBatch& batch) const = 0;
  /// Elastic energy of a point, J per initial m^3.
  virtual double energy(const StressBatch& batch, std::size_t k) const {
    return elastic_.energy(batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]);
  }
  /// Greatest stiffness against a compression wave in the batch, as it is now: c^2 times the initial density, Pa.
  virtual double stiffness(const StressBatch& batch) const;
  /// Can update() do with StressBatch::places?
  virtual bool takes_places() const { return false; }
  /// Is the stress a function of F alone (so that no stress can be given at the start)?
  virtual bool from_deformation() const { return false; }
  /// Length of the weights with which the plastic strain that softens is averaged (transfer/nonlocal.hpp), m; 0: it is not.
  virtual double nonlocal_length() const { return 0; }
  const Elastic& elastic() const { return elastic_; }
  /// What it remembers of a point, in the order in which a batch holds it, and its name: those of the row that it was made
  /// from (nothing for one that make_material() has not made).
  const std::vector<HistoryVariable>& history() const;
  const std::string& name() const;
  void made_as(const MaterialModel& model) { model_ = &model; }

 protected:
  Elastic elastic_;

 private:
  const MaterialModel* model_ = nullptr;
};

/// The history of laws with a yield surface: places among StressBatch::history and flags. Those that never open have the
/// first two.
namespace plastic {
enum Number : std::size_t { strain, work, opening };
enum Flag : std::size_t { separated };  // 1 once the point has separated: no tension any more
}  // namespace plastic

/// Stress of point `k`, turned by the step's rotation (Hughes & Winget 1980: tan(theta/2) = spin/2, so that the turn is
/// a true rotation for any step) and advanced elastically by the step's strain: the trial state of every law.
struct Stress {
  double xx, yy, zz, xy;
};
inline Stress turned_by(double spin, const Stress& stress) {
  const double t = 0.5 * spin, scale = 1 / (1 + t * t);
  const double c = (1 - t * t) * scale, s = 2 * t * scale;  // cosine and sine of the turn
  const double mean = 0.5 * (stress.xx + stress.yy), half = 0.5 * (stress.xx - stress.yy), xy = stress.xy;
  const double c2 = c * c - s * s, s2 = 2 * c * s;
  const double half_turned = c2 * half - s2 * xy;
  return {mean + half_turned, mean - half_turned, stress.zz, s2 * half + c2 * xy};
}
inline Stress rotated(const StressBatch& b, std::size_t k) {
  return turned_by(b.spin[k], {b.xx[k], b.yy[k], b.zz[k], b.xy[k]});
}
inline void add_elastic(const Elastic& e, double de_xx, double de_yy, double de_zz, double de_xy, Stress& s) {
  const double volumetric = e.lambda * (de_xx + de_yy + de_zz), two_shear = 2 * e.shear;
  s.xx += volumetric + two_shear * de_xx;
  s.yy += volumetric + two_shear * de_yy;
  s.zz += volumetric + two_shear * de_zz;
  s.xy += two_shear * de_xy;
}
inline Stress elastic_trial(const Elastic& e, const StressBatch& b, std::size_t k) {
  Stress s = rotated(b, k);
  add_elastic(e, b.de_xx[k], b.de_yy[k], b.de_zz[k], b.de_xy[k], s);
  return s;
}
inline void store(const StressBatch& b, std::size_t k, const Stress& s) {
  b.xx[k] = s.xx;
  b.yy[k] = s.yy;
  b.zz[k] = s.zz;
  b.xy[k] = s.xy;
}

}  // namespace pivnp::mpm

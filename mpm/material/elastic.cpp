#include "mpm/material/elastic.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/material/lanes.hpp"

namespace pivnp::mpm {

namespace {

// A symmetric 2 x 2 tensor by mean, half difference and shear.
struct Plane {
  double mean, half, xy;
};

// 1/2 ln(exp(d) exp(2 e) exp(d)) of traceless d and e: how the deviators in the plane combine. The traces just add.
Plane combined(const Plane& d, const Plane& e) {
  const double rd2 = d.half * d.half + d.xy * d.xy, re2 = e.half * e.half + e.xy * e.xy;
  const auto exponential = [](const Plane& s, double r2, double scale) {
    const double r = std::sqrt(r2) * scale, factor = r > 0 ? std::sinh(r) / r * scale : scale;
    return Plane{std::cosh(r), factor * s.half, factor * s.xy};
  };
  const Plane V = exponential(d, rd2, 1), b = exponential(e, re2, 2);
  const double vxx = V.mean + V.half, vyy = V.mean - V.half, bxx = b.mean + b.half, byy = b.mean - b.half;
  const double mxx = vxx * bxx + V.xy * b.xy, mxy = vxx * b.xy + V.xy * byy;
  const double myx = V.xy * bxx + vyy * b.xy, myy = V.xy * b.xy + vyy * byy;
  const Plane out{0, 0.5 * (mxx * vxx + mxy * V.xy - myx * V.xy - myy * vyy), mxx * V.xy + mxy * vyy};
  const double sinh = std::sqrt(out.half * out.half + out.xy * out.xy);
  const double factor = sinh > 0 ? 0.5 * std::asinh(sinh) / sinh : 0;
  return {0, factor * out.half, factor * out.xy};
}

struct LeftCauchyGreen {
  double xx, yy, zz, xy, log_J;
};

LeftCauchyGreen averaged(const StressBatch& s, std::size_t k) {
  const double a = s.F_xx[k], b = s.F_xy[k], c = s.F_yx[k], d = s.F_yy[k];
  if (s.F_zz) {
    const double e = s.F_zz[k], scale = std::pow(s.J[k] / ((a * d - b * c) * e), 2.0 / 3);
    return {scale * (a * a + b * b), scale * (c * c + d * d), scale * e * e, scale * (a * c + b * d), std::log(s.J[k])};
  }
  const double scale = std::pow(s.J[k] / (a * d - b * c), 2.0 / 3);
  return {scale * (a * a + b * b), scale * (c * c + d * d), scale, scale * (a * c + b * d), std::log(s.J[k])};
}

template <class Law>
std::unique_ptr<Material> make(const MaterialOptions& o, double) {
  return std::make_unique<Law>(Elastic(o.young_pa, o.poisson));
}

}  // namespace

MaterialModel linear_elastic_model() {
  return {.name = "linear_elastic", .text = "isotropic, linear in the logarithmic strain", .keys = {}, .make = make<LinearElastic>};
}

MaterialModel neo_hookean_model() {
  return {.name = "neo_hookean", .text = "compressible neo-Hookean solid", .keys = {}, .make = make<NeoHookean>};
}

void LinearElastic::update(const StressBatch& batch) const {
  const Elastic& c = elastic_;
  update_in_lanes(
      batch, [&](const StressBatch& part, std::uint32_t* rare) { return hencky_lanes(c, part, rare); },
      [&](const StressBatch& b, std::size_t k) {
        Stress s = rotated(b, k);
        const double per = 1 / (2 * c.shear);
        const Plane d{0, 0.5 * (b.de_xx[k] - b.de_yy[k]), b.de_xy[k]};
        const Plane e{0, 0.5 * (s.xx - s.yy) * per, s.xy * per};
        const Plane to = combined(d, e);
        // What the deviator in the plane gains on top of the sum.
        const double half = 2 * c.shear * (to.half - d.half - e.half), xy = 2 * c.shear * (to.xy - d.xy - e.xy);
        add_elastic(c, b.de_xx[k], b.de_yy[k], b.de_zz[k], b.de_xy[k], s);
        store(b, k, {s.xx + half, s.yy - half, s.zz, s.xy + xy});
      });
}

void NeoHookean::update(const StressBatch& batch) const {
  const double mu = elastic_.shear;
  for (std::size_t k = 0; k < batch.size; ++k) {
    const LeftCauchyGreen b = averaged(batch, k);
    const double pressure = elastic_.lambda * b.log_J;
    store(batch, k, {mu * (b.xx - 1) + pressure, mu * (b.yy - 1) + pressure, mu * (b.zz - 1) + pressure, mu * b.xy});
  }
}

double NeoHookean::energy(const StressBatch& batch, std::size_t k) const {
  const LeftCauchyGreen b = averaged(batch, k);
  return 0.5 * elastic_.shear * (b.xx + b.yy + b.zz - 3) - elastic_.shear * b.log_J +
         0.5 * elastic_.lambda * b.log_J * b.log_J;
}

double NeoHookean::stiffness(const StressBatch& batch) const {
  // J times the spatial modulus along a direction n, with the stress: lambda + 2 (mu - lambda ln J) + tau_nn.
  double greatest = elastic_.p_wave_modulus();
  for (std::size_t k = 0; k < batch.size; ++k) {
    const double stress = std::max(batch.xx[k], batch.yy[k]) + std::abs(batch.xy[k]);
    greatest = std::max(greatest, elastic_.p_wave_modulus() - 2 * elastic_.lambda * std::log(batch.J[k]) + stress);
  }
  return greatest;
}

}  // namespace pivnp::mpm

#include "mpm/material/linear_elastic.hpp"

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

}  // namespace

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

}  // namespace pivnp::mpm

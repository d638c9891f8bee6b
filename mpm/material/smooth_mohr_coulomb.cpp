#include "mpm/material/smooth_mohr_coulomb.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

namespace {

constexpr double stress_tolerance = 1e-4;  // of a substep, over the stress
constexpr double yield_tolerance = 1e-9;   // over max(c, p, 100 apex_pa)
constexpr double least_size = 100;         // over apex_pa, of the stress that errors are measured against
constexpr double near_surface = 1e-5;      // the same; within it no elastic part is looked for
constexpr double least_substep = 1e-5;     // of the step
constexpr int most_substeps = 2000;  // a step; then the rest goes at once, back to the surface, whatever its error
constexpr double least_hardness = 0.5;     // of a : D : b; steeper softening is left to the drift's correction
constexpr int most_corrections = 12;
constexpr double corner = 8;  // curvature of the surface's rounded corners times its radius

Tensor plus(const Tensor& a, const Tensor& b, double factor = 1) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2], a[3] + factor * b[3]};
}
Tensor times(const Tensor& a, double factor) { return {factor * a[0], factor * a[1], factor * a[2], factor * a[3]}; }
double trace(const Tensor& a) { return a[0] + a[1] + a[2]; }
Tensor deviator_of(const Tensor& a) {
  const double mean = trace(a) / 3;
  return {a[0] - mean, a[1] - mean, a[2] - mean, a[3]};
}
double length(const Tensor& a) { return std::sqrt(product(a, a)); }

double scale_of(const Strength& s, double mean, double J, double apex) {
  return std::max({s.cohesion * J, std::abs(mean), least_size * apex});
}

}  // namespace

MaterialModel smooth_mohr_coulomb_model() {
  std::vector<MaterialKey> keys = soil_keys();
  keys.push_back({"apex_pa"});
  return {.name = "mohr_coulomb_smooth",
          .text = "friction and cohesion on Abbo & Sloan's smooth surface, by substeps",
          .keys = keys,
          .history = cone_history(),
          .check = check_soil,
          .make = [](const MaterialOptions& o, double cell_m) -> std::unique_ptr<Material> {
            return std::make_unique<SmoothMohrCoulomb>(Elastic(o.young_pa, o.poisson), StrengthLaw(o, cell_m), o.tension_pa,
                                                       o.apex_pa);
          },
          .reduce = reduce_cone};
}

struct SmoothMohrCoulomb::Here : AbboSloan::Place {
  double most_mean, tolerance, size;  // greatest mean stress; of F; Pa that count

  Here(const SmoothMohrCoulomb& law, const Point& p) : Here(law, p, Invariants(p.stress)) {}
  /// Where the history is that of another place, so is the strength, unless it depends on pressure.
  Here(const SmoothMohrCoulomb& law, const Point& p, const Here& other)
      : Here(law, p, Invariants(p.stress), law.strength_.by_pressure() ? nullptr : &other.strength) {}
  bool on_surface() const { return F >= -near_surface * size; }
  double within() const { return std::min(F, 0.0); }
  bool at_limit(const Point& p) const { return p.opening > 0 || at.mean >= most_mean - tolerance; }

 private:
  Here(const SmoothMohrCoulomb& law, const Point& p, const Invariants& of, const Strength* known = nullptr)
      : Place(law.surface_.place(of, known ? *known : law.strength_of(p, of.mean), p.J)),
        most_mean(std::min(p.separated ? 0.0 : law.tension_ * p.J, AbboSloan::greatest_mean(*this))),
        tolerance(yield_tolerance * scale_of(strength, at.mean, p.J, law.surface_.floor_pa())),
        size(scale_of(strength, at.mean, p.J, law.surface_.floor_pa())) {}
};

SmoothMohrCoulomb::SmoothMohrCoulomb(const Elastic& elastic, const StrengthLaw& strength, double tension_pa,
                                     double apex_pa)
    : Material(elastic),
      strength_(strength),
      surface_(apex_pa),
      tension_(tension_pa),
      bulk_(elastic.lambda + 2.0 / 3 * elastic.shear),
      constants_(constants()) {}

Strength SmoothMohrCoulomb::strength_of(const Point& p, double mean) const {
  if (!p.softened_by) return strength_.at(p.history, -mean / p.J);
  Strength s = strength_.at(*p.softened_by, -mean / p.J);
  s.friction_by_history = s.cohesion_by_history = 0;
  return s;
}

double SmoothMohrCoulomb::relative_yield(const Tensor& stress, double history, double J) const {
  const Here here(*this, {stress, history, 0, J, false});
  return here.F / here.size;
}

Tensor SmoothMohrCoulomb::stiff(const Tensor& e) const {
  const double volumetric = elastic_.lambda * trace(e), two_shear = 2 * elastic_.shear;
  return {volumetric + two_shear * e[0], volumetric + two_shear * e[1], volumetric + two_shear * e[2],
          two_shear * e[3]};
}

double SmoothMohrCoulomb::energy_of(const Tensor& s) const { return elastic_.energy(s[0], s[1], s[2], s[3]); }

// Plastic flow at the surface; `held`: at the greatest mean stress, which stays. `way`: F, or zero, where the substep
// began; what lies within the surface goes to it first, to first order. `flows`: it did where the substep began, so a
// place that it left inside the surface (by the surface's curvature, or by softening) is no elastic one.
SmoothMohrCoulomb::Rate SmoothMohrCoulomb::yielding(const Here& here, const Tensor& de, bool held, double way,
                                                    bool flows) const {
  Tensor a = surface_.gradient(here), b = surface_.flow(here);
  const Tensor moved = held ? deviator_of(de) : de;
  const double dilation = trace(b);
  if (held) {
    a = deviator_of(a);
    b = deviator_of(b);
  }
  const Tensor elastic = stiff(moved), Db = stiff(b), b_dev = deviator_of(b);
  const double per = std::sqrt(2.0 / 3 * product(b_dev, b_dev)), hardness = product(a, Db);
  double amount = 0;
  if ((flows || held || here.on_surface()) && hardness > 0) {
    const double softened = hardness - surface_.by_history(here) * per;
    amount = std::max(0.0, (product(a, elastic) + way) / std::max(softened, least_hardness * hardness));
  }
  return {plus(elastic, Db, -amount), amount * per, held ? trace(de) - amount * dilation : 0};
}

SmoothMohrCoulomb::Rate SmoothMohrCoulomb::rate(const Point& p, const Here& here, const Tensor& de, double way,
                                                bool flows) const {
  if (here.at_limit(p)) {
    const Rate held = yielding(here, de, true, way, flows);
    if (p.opening > 0 || held.opening >= 0) return held;
  }
  return yielding(here, de, false, way, flows);
}

// Where F along stress + x ds is zero, between x = low (inside) and high (outside): Dowell & Jarratt's Pegasus method.
double SmoothMohrCoulomb::crossing(const Point& p, const Here& start, const Tensor& ds, double low, double high) const {
  const auto at = [&](double x) {
    Point moved = p;
    moved.stress = plus(p.stress, ds, x);
    return Here(*this, moved, start);
  };
  double f_low = low > 0 ? at(low).F : start.F, f_high = at(high).F;
  for (int n = 0; n < 60; ++n) {
    const double x = high - f_high * (high - low) / (f_high - f_low);
    const Here here = at(x);
    if (std::abs(here.F) <= here.tolerance) return x;
    if (here.F * f_high < 0) {
      low = high;
      f_low = f_high;
    } else {
      f_low *= f_high / (f_high + here.F);
    }
    high = x;
    f_high = here.F;
  }
  return std::min(low, high);
}

// Advances elastically to the surface, the greatest mean stress or the end of `rest`; the share of `rest` used.
double SmoothMohrCoulomb::elastic_leg(Point& p, const Here& here, const Tensor& rest) const {
  const Tensor ds = stiff(rest);
  const bool inside = !here.on_surface();
  if (!inside && product(surface_.gradient(here), ds) >= 0) return 0;
  Point end = p;
  end.stress = plus(p.stress, ds);
  const Here there(*this, end, here);
  double share = 1;
  const double rise = there.at.mean - here.at.mean;
  if (rise > 0 && there.at.mean > there.most_mean)
    share = std::clamp((there.most_mean - here.at.mean) / rise, 0.0, 1.0);
  if (there.F > there.tolerance || share < 1) {
    const auto F_at = [&](double x) {
      Point moved = p;
      moved.stress = plus(p.stress, ds, x);
      return Here(*this, moved, here).F;
    };
    if (share > 0 && (share == 1 ? there.F : F_at(share)) > 0) {
      double low = 0;
      if (!inside)  // leaves the surface first: F is convex along the line
        for (low = 0.5 * share; low > 1e-12 && F_at(low) >= 0;) low *= 0.5;
      if (!inside && low <= 1e-12) return 0;
      share = crossing(p, here, ds, low, share);
    }
  }
  p.stress = plus(p.stress, ds, share);
  return share;
}

// Back to the surface and below the greatest mean stress; what flows on the way softens. Returns where the point is
// then; `here`: where it is.
SmoothMohrCoulomb::Here SmoothMohrCoulomb::correct(Point& p, Here here) const {
  for (int n = 0; n < most_corrections; ++n) {
    if (here.at.mean > here.most_mean + here.tolerance || here.F <= here.tolerance || p.opening > 0) break;
    const Tensor a = surface_.gradient(here), b = surface_.flow(here), b_dev = deviator_of(b), Db = stiff(b);
    const double hardness = product(a, Db), per = std::sqrt(2.0 / 3 * product(b_dev, b_dev));
    if (!(hardness > 0)) break;
    const double softened = hardness - surface_.by_history(here) * per;
    const double amount = here.F / std::max(softened, least_hardness * hardness);
    Point moved = p;
    moved.stress = plus(p.stress, Db, -amount);
    moved.history += amount * per;
    Here there(*this, moved);
    if (there.F < -here.tolerance) {  // past the surface: without softening that cannot be, F being convex
      moved.stress = plus(p.stress, Db, -here.F / hardness);
      moved.history = p.history;
      there = Here(*this, moved, here);
    }
    if (!(there.F < here.F)) break;
    p = moved;
    here = there;
  }
  const double over = here.at.mean - here.most_mean;
  if (over > 0) {
    p.opening += over / bulk_;
    for (std::size_t q = 0; q < 3; ++q) p.stress[q] -= over;
    here = Here(*this, p);
  } else if (p.opening > 0) {
    const double closed = std::min(p.opening, -over / bulk_);
    p.opening -= closed;
    for (std::size_t q = 0; q < 3; ++q) p.stress[q] += bulk_ * closed;
    here = Here(*this, p);
  }
  if (here.F <= here.tolerance) return here;
  const double bar = surface_.bar_on_surface(here);
  const double keep = here.at.bar > 0 ? std::min(1.0, bar / here.at.bar) : 0;
  for (std::size_t q = 0; q < 4; ++q) p.stress[q] = keep * here.at.deviator[q] + (q < 3 ? here.at.mean : 0);
  return Here(*this, p);
}

// How far a step that is not resolved leaves the surface is no stress that the point had: its work is that between the stresses
// on the surface, and no less than what it stores.
double SmoothMohrCoulomb::work_of_unresolved(const Tensor& before, const Tensor& after, const Tensor& de) const {
  return std::max(0.5 * (product(before, de) + product(after, de)), energy_of(after) - energy_of(before));
}

// Flow of an open point at its greatest mean stress, until it closes or `de` is through; the share of `de` used.
//
// Its deviator is bounded by a radius r (sand in flight carries some Pa, of 2 G |de| a step there may be hundreds), and
// goes to the place where strain and flow agree, where it stays. Explicit substeps would hover about that place, each
// no longer than stability allows. So they end when what is left of the way is below their tolerance: a way that
// shrinks from `first` to `second` in one substep leaves first^2/(first - second) in all (Aitken). What counts for an
// open point is the scale of the strength and of the yield function's tolerance (`size`), not its own few Pa.
double SmoothMohrCoulomb::open_leg(Point& p, Here& here, const Tensor& de, double& work, int& substeps) const {
  const double distortion = 2 * elastic_.shear * length(deviator_of(de)), closed = 1e-9 * length(de);
  double done = 0, size = 0;
  bool failed = false, steady = false;
  while (done < 1 && p.opening > 0) {
    const double right = stress_tolerance * here.size;
    double rest = 1 - done;
    Rate all = yielding(here, times(de, rest), true, here.within(), false);
    if (p.opening + all.opening < 0) {  // closes on the way
      rest *= p.opening / -all.opening;
      all = yielding(here, times(de, rest), true, here.within(), false);
    }
    const double way = length(all.stress);
    const bool there = steady || way <= right, enough = !there && ++substeps > most_substeps, last = there || enough;
    const bool within = here.F < -right;
    if (size == 0) {  // to the surface; on it by the error that a corner makes
      const double along = 2 * elastic_.shear * product(surface_.gradient(here), deviator_of(de));
      const double radius = std::sqrt(2.0) * surface_.bar_on_surface(here);
      size = within ? (along > 0 ? -here.F / along : 1)
                    : 0.9 * std::sqrt(2 * right * radius / (corner * way / rest * distortion));
    }
    size = last ? rest : std::min(std::max(size, least_substep), rest);
    const Rate first = last ? all : yielding(here, times(de, size), true, here.within(), false);
    Point end = p;
    Rate mean = first;
    double better = 1;
    if (steady) {
      mean.stress = {};
    } else if (!last) {
      Point middle = p;
      middle.stress = plus(p.stress, first.stress);
      middle.history += first.history;
      const Rate second = yielding(Here(*this, middle), times(de, size), true, here.within(), first.history > 0);
      const double error = 0.5 * length(plus(second.stress, first.stress, -1));
      better = error > 0 ? 0.9 * std::sqrt(right / error) : 4;
      if (error > right && size > least_substep) {
        size *= std::max(0.1, better);
        failed = true;
        continue;
      }
      const double way2 = product(first.stress, first.stress), shrunk = way2 - product(first.stress, second.stress);
      steady = shrunk > 0 && way2 * std::sqrt(way2) <= right * shrunk;
      mean = {times(plus(first.stress, second.stress), 0.5), 0.5 * (first.history + second.history),
              0.5 * (first.opening + second.opening)};
    }
    end.stress = plus(p.stress, mean.stress);
    end.history += mean.history;
    end.opening = std::max(0.0, p.opening + mean.opening);
    if (!enough) work += 0.5 * size * (product(p.stress, de) + product(end.stress, de));
    here = correct(end, Here(*this, end));
    if (enough) work += work_of_unresolved(p.stress, end.stress, times(de, size));
    p = end;
    if (p.opening <= closed) p.opening = 0;
    done = 1 - done - size < 1e-12 ? 1 : done + size;
    size = within ? 0 : size * std::min(failed ? 1.0 : 4.0, better);
    failed = false;
  }
  return done;
}

void SmoothMohrCoulomb::integrate(Point& p, Here here, const Tensor& de, double& work) const {
  double done = 0, size = 1;
  bool failed = false;
  int substeps = 0;
  const auto add_work = [&](const Tensor& before, const Tensor& after, double share) {
    work += 0.5 * share * (product(before, de) + product(after, de));
  };
  while (done < 1) {
    if (p.opening > 0) {
      const double share = open_leg(p, here, times(de, 1 - done), work, substeps);
      done = share < 1 ? done + share * (1 - done) : 1;
      continue;
    }
    if (!failed && !here.at_limit(p)) {
      const Tensor before = p.stress;
      const double share = elastic_leg(p, here, times(de, 1 - done));
      if (share > 0) {
        add_work(before, p.stress, share * (1 - done));
        here = Here(*this, p, here);
        if (share >= 1) break;
        done += share * (1 - done);
      }
    }
    const bool enough = ++substeps > most_substeps;
    size = enough ? 1 - done : std::min(size, 1 - done);
    const Tensor part = times(de, size);
    const Rate first = rate(p, here, part, here.within(), false);
    Point middle = p;
    middle.stress = plus(p.stress, first.stress);
    middle.history += first.history;
    middle.opening = std::max(0.0, p.opening + first.opening);
    const Rate second = rate(middle, Here(*this, middle), part, here.within(), first.history > 0);
    Point end = p;
    end.stress = plus(p.stress, plus(first.stress, second.stress), 0.5);
    end.history += 0.5 * (first.history + second.history);
    end.opening += 0.5 * (first.opening + second.opening);
    if (end.opening < 0) {  // closed on the way: what is left over loads
      for (std::size_t q = 0; q < 3; ++q) end.stress[q] += bulk_ * end.opening;
      end.opening = 0;
    }
    const double error =
        0.5 * length(plus(second.stress, first.stress, -1)) / std::max(length(end.stress), 0.1 * here.size);
    if (error > stress_tolerance && size > least_substep && !enough) {
      size = std::max(least_substep, size * std::max(0.1, 0.9 * std::sqrt(stress_tolerance / error)));
      failed = true;
      continue;
    }
    if (!enough) add_work(p.stress, end.stress, size);
    here = correct(end, Here(*this, end));  // at constant strain: no work
    if (enough) work += work_of_unresolved(p.stress, end.stress, part);
    p = end;
    done = 1 - done - size < 1e-12 ? 1 : done + size;
    double grow = error > 0 ? std::min(4.0, 0.9 * std::sqrt(stress_tolerance / error)) : 4.0;
    if (failed) grow = std::min(grow, 1.0);
    failed = false;
    size = std::max(least_substep, size * grow);
  }
}

void SmoothMohrCoulomb::update_point(const StressBatch& batch, std::size_t k) const {
  const Stress turned = rotated(batch, k);
  Point p{{turned.xx, turned.yy, turned.zz, turned.xy},
          batch.history[plastic::strain][k],
          batch.history[plastic::opening][k],
          batch.J[k],
          batch.flags[plastic::separated][k] != 0,
          batch.softened_by ? batch.softened_by + k : nullptr};
  const double start = energy_of(p.stress);
  const Here here = correct(p, Here(*this, p));  // to this step's J and pressure
  const Tensor de{batch.de_xx[k], batch.de_yy[k], batch.de_zz[k], batch.de_xy[k]};
  double work = 0;
  integrate(p, here, de, work);
  batch.history[plastic::work][k] += work - (energy_of(p.stress) - start);
  batch.history[plastic::strain][k] = p.history;
  batch.history[plastic::opening][k] = p.opening;
  if (p.opening > 0) batch.flags[plastic::separated][k] = 1;
  store(batch, k, {p.stress[0], p.stress[1], p.stress[2], p.stress[3]});
}

void SmoothMohrCoulomb::update(const StressBatch& batch) const {
  update_in_lanes(
      batch,
      [&](const StressBatch& part, std::uint32_t* rare) { return smooth_lanes(elastic_, constants_, part, rare); },
      [&](const StressBatch& b, std::size_t k) { update_point(b, k); });
}

SmoothConstants SmoothMohrCoulomb::constants() const {
  SmoothConstants c{};
  c.strength = strength_.constants();
  c.constant = strength_.constant();
  c.sin_friction = strength_.initial().sin_friction;
  c.cos_friction = strength_.initial().cos_friction;
  c.sin_dilatancy = c.constant ? strength_.initial().sin_dilatancy : strength_.peak_sin_dilatancy();
  c.tension = tension_;
  surface_.put_constants(c);
  c.stress_tolerance = stress_tolerance;
  c.yield_tolerance = yield_tolerance;
  c.near_surface = near_surface;
  c.least_size = least_size * surface_.floor_pa();
  c.least_substep = least_substep;
  c.least_hardness = least_hardness;
  c.corner = corner;
  return c;
}

}  // namespace pivnp::mpm

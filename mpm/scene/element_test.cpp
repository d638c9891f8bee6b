#include "mpm/scene/element_test.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "mpm/state/stress_batch.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

// A step's deformation: x' = xx x + xy y, y' = yx x + yy y, out of the plane zz.
struct StepDeformation {
  double xx = 1, yy = 1, zz = 1, xy = 0;  // yx = 0: sides of a sheared specimen turn, its base does not
};

constexpr double at_the_peak = 1e-6;  // relative, of what a path is read for
constexpr std::size_t volume_xx = 0, volume_yy = 1, volume_zz = 2, plane_xy = 3;

// A point with all that its law remembers. Copies are trials.
struct Specimen {
  std::array<double, 4> stress{};  // Kirchhoff
  double J = 1, F_xx = 1, F_xy = 0, F_yy = 1, F_zz = 1;
  std::vector<double> numbers;
  std::vector<std::uint8_t> flags;

  double cauchy(std::size_t q) const { return stress[q] / J; }

  void advance(const Material& law, const StepDeformation& f, double dt) {
    // f = V R: tan of the turn is (f_yx - f_xy)/(f_xx + f_yy); ln V by its mean and its deviator.
    const double angle = std::atan2(-f.xy, f.xx + f.yy), c = std::cos(angle), s = std::sin(angle);
    // V = f R^T, R = [[c, -s], [s, c]].
    const double v_xx = f.xx * c - f.xy * s, v_xy = f.xx * s + f.xy * c, v_yy = f.yy * c;
    const double half = 0.5 * (v_xx - v_yy), radius = std::hypot(half, v_xy), mean = 0.5 * (v_xx + v_yy);
    const double log_mean = 0.5 * std::log(mean * mean - radius * radius);
    const double factor = radius > 0 ? std::atanh(radius / mean) / radius : 1 / mean;
    const double de_xx = log_mean + factor * half, de_yy = log_mean - factor * half, de_zz = std::log(f.zz), de_xy = factor * v_xy;
    const double spin = 2 * std::tan(angle / 2), zero = 0;
    F_xy = f.xx * F_xy + f.xy * F_yy;
    F_xx *= f.xx, F_yy *= f.yy, F_zz *= f.zz;
    J = F_xx * F_yy * F_zz;
    StressBatch b;
    b.size = 1;
    b.de_xx = &de_xx, b.de_yy = &de_yy, b.de_zz = &de_zz, b.de_xy = &de_xy;
    b.spin = &spin, b.J = &J;
    b.F_xx = &F_xx, b.F_xy = &F_xy, b.F_yx = &zero, b.F_yy = &F_yy, b.F_zz = &F_zz;
    b.xx = &stress[volume_xx], b.yy = &stress[volume_yy], b.zz = &stress[volume_zz], b.xy = &stress[plane_xy];
    for (std::size_t n = 0; n < numbers.size(); ++n) b.history[n] = &numbers[n];
    for (std::size_t n = 0; n < flags.size(); ++n) b.flags[n] = &flags[n];
    b.dt = dt;
    law.update(b);
  }
};

// The x in reach of a guess at which residual(x), which grows with x, is zero: a bracket that doubles, then regula falsi (Illinois).
std::optional<double> root_near(double guess, double width, double tolerance, const std::function<double(double)>& residual) {
  constexpr int most_doublings = 24, most_steps = 100;
  double a = guess - width, b = guess + width, fa = residual(a), fb = residual(b);
  for (int k = 0; k < most_doublings && !(fa <= 0 && fb >= 0); ++k) {
    width *= 2;
    if (!(fa <= 0)) a = guess - width, fa = residual(a);
    if (!(fb >= 0)) b = guess + width, fb = residual(b);
  }
  if (!(fa <= 0 && fb >= 0)) return std::nullopt;
  for (int k = 0; k < most_steps; ++k) {
    const double x = fb > fa ? b - fb * (b - a) / (fb - fa) : 0.5 * (a + b), f = residual(x);
    if (std::abs(f) <= tolerance || !(b - a > 1e-15)) return x;
    if (f > 0) fa *= k % 2 ? 0.5 : 1, b = x, fb = f;
    else fb *= k % 2 ? 0.5 : 1, a = x, fa = f;
  }
  return std::nullopt;
}

void check_test(const ElementTestOptions& o) {
  const auto refuse_option = [](const std::string& what, double found, const std::string& expected) {
    throw InputError(what + ": found " + number(found) + ", expected " + expected);
  };
  if (!(o.pressure_pa > 0 && std::isfinite(o.pressure_pa))) refuse_option("pressure", o.pressure_pa, "more than 0 (Pa)");
  if (!(o.strain > 0 && o.strain < (is_shear(o.test) ? 10 : 0.9))) refuse_option("strain", o.strain, is_shear(o.test) ? "0 to 10" : "0 to 0.9");
  if (!(o.k0 > 0 && o.k0 <= 20)) refuse_option("k0", o.k0, "0 to 20");
  if (!(o.rate_1_s > 0)) refuse_option("rate", o.rate_1_s, "more than 0 (1/s)");
  if (o.steps < 10 || o.steps > 1000000) refuse_option("steps", o.steps, "10 to 1,000,000");
  if (o.undrained && ends_by_stress(o.test))
    throw InputError("undrained: an " + std::string(name_of(o.test)) + " test has no undrained form, expected a drained one");
}

class ElementRun {
 public:
  ElementRun(const Material& law, const ElementTestOptions& options) : law_(law), o_(options) {
    std::size_t numbers = 0, flags = 0;
    for (const HistoryVariable& v : law.history()) {
      if (!v.flag() && v.field().components() == 1) named_.emplace_back(std::string(v.name), numbers), path_.history.push_back({std::string(v.name), {}});
      (v.flag() ? flags : numbers) += v.field().components();
    }
    now_.numbers.assign(numbers, 0.0);
    now_.flags.assign(flags, 0);
  }

  ElementPath path() && {
    if (start()) ends_by_stress(o_.test) ? load_and_unload() : strain();
    return std::move(path_);
  }

 private:
  double tolerance() const { return 1e-9 * o_.pressure_pa; }

  // Consolidated to the stress at which the test begins. A law that gets its stress from F is compressed to it.
  bool start() {
    const double p = ends_by_stress(o_.test) ? o_.pressure_pa / 100 : o_.pressure_pa, across = is_shear(o_.test) ? o_.k0 * p : p;
    if (law_.from_deformation()) {
      const auto found = settle(-1e-3, [](double e) { return StepDeformation{std::exp(e), std::exp(e), std::exp(e), 0}; }, volume_yy, -p);
      if (!found) return end("does not reach the pressure at the start");
      now_.advance(law_, *found, 0);
    } else {
      now_.stress = {-across, -p, -across, 0};
      now_.advance(law_, {}, 0);
    }
    size_ = {now_.F_xx, now_.F_yy, now_.J};
    held_ = -now_.cauchy(component());
    keep(0);
    return true;
  }

  // What the test holds: the lateral stress of a compression test, the vertical one of a shear test.
  std::size_t component() const { return is_shear(o_.test) ? volume_yy : volume_xx; }

  // The deformation, of a family with one parameter, that gives a stress component its value.
  template <class Family>
  std::optional<StepDeformation> settle(double guess, Family&& family, std::size_t q, double target) {
    const auto residual = [&](double e) {
      Specimen trial = now_;
      trial.advance(law_, family(e), dt_);
      const double value = trial.cauchy(q) - target;
      return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
    };
    const double width = std::max(std::abs(guess), 1e-9);
    const std::optional<double> e = root_near(guess, width, tolerance(), residual);
    if (!e) return std::nullopt;
    found_ = *e;
    return family(*e);
  }

  void strain() {
    const double step = o_.strain / o_.steps;
    dt_ = step / o_.rate_1_s;
    for (int k = 1; k <= o_.steps; ++k) {
      const double before = step * (k - 1), at = step * k;
      // The height's stretch, or the shear, which the upper plate makes at its present height.
      const double axial = is_shear(o_.test) ? 1 : (1 - at) / (1 - before), gamma = is_shear(o_.test) ? step : 0;
      const auto family = [&](double e) {
        const double a = std::exp(e);
        if (is_shear(o_.test)) return StepDeformation{1, a, 1, gamma * size_[1] / now_.F_yy};
        return o_.test == ElementTest::triaxial ? StepDeformation{a, axial, a, 0} : StepDeformation{a, axial, 1, 0};
      };
      std::optional<StepDeformation> f;
      if (o_.undrained) f = family(is_shear(o_.test) ? 0 : -std::log(axial) / (o_.test == ElementTest::triaxial ? 2 : 1));
      else f = settle(k > 1 ? found_ : step / 2, family, component(), -held_);
      if (!f && !end("no longer carries the stress that is held: the material has opened")) return;
      now_.advance(law_, *f, dt_);
      if (!std::isfinite(now_.stress[0] + now_.stress[1] + now_.stress[2] + now_.stress[3]) && !end("its stress is no number")) return;
      keep(at);
    }
  }

  // Stress in equal ratios up to the pressure, and down to a tenth of it.
  void load_and_unload() {
    const int up = 2 * o_.steps / 3, down = o_.steps - up;
    const double size = o_.test == ElementTest::isotropic;
    const auto family = [&](double e) { return StepDeformation{std::exp(size * e), std::exp(e), std::exp(size * e), 0}; };
    found_ = -1e-6;
    for (int k = 1; k <= o_.steps; ++k) {
      const double target = k <= up ? o_.pressure_pa * std::pow(100, double(k) / up - 1) : o_.pressure_pa * std::pow(10, -double(k - up) / down);
      if (k == up + 1) found_ = std::abs(found_);
      dt_ = std::max(std::abs(found_), 1e-9) / o_.rate_1_s;
      const auto f = settle(found_, family, volume_yy, -target);
      if (!f && !end("does not reach the next stress")) return;
      now_.advance(law_, *f, dt_);
      keep(1 - now_.F_yy / size_[1]);
    }
  }

  bool end(const std::string& why) {
    path_.ended = (path_.size() == 0 ? "" : "at a strain of " + percent(path_.strain.back()) + " it ") + why;
    return false;
  }
  static std::string percent(double strain) { return number(100 * strain, 3) + " %"; }

  void keep(double strain) {
    const double xx = -now_.cauchy(volume_xx), yy = -now_.cauchy(volume_yy), zz = -now_.cauchy(volume_zz), xy = now_.cauchy(plane_xy);
    const double mean = (xx + yy + zz) / 3, half = 0.5 * (xx - yy), centre = 0.5 * (xx + yy), radius = std::hypot(half, xy);
    const double j2 = 0.5 * ((xx - mean) * (xx - mean) + (yy - mean) * (yy - mean) + (zz - mean) * (zz - mean)) + xy * xy;
    path_.strain.push_back(strain);
    path_.volume.push_back(1 - now_.J / size_[2]);
    path_.vertical.push_back(yy), path_.horizontal.push_back(xx), path_.out_of_plane.push_back(zz), path_.shear.push_back(xy);
    path_.mean.push_back(mean), path_.deviator.push_back(std::sqrt(3 * j2));
    path_.major.push_back(std::max(centre + radius, zz)), path_.minor.push_back(std::min(centre - radius, zz));
    path_.pore_pressure.push_back(o_.undrained ? held_ + now_.cauchy(component()) : 0.0);
    for (std::size_t n = 0; n < named_.size(); ++n) path_.history[n].second.push_back(now_.numbers[named_[n].second]);
  }

  const Material& law_;
  const ElementTestOptions& o_;
  Specimen now_;
  ElementPath path_;
  std::vector<std::pair<std::string, std::size_t>> named_;
  std::array<double, 3> size_{1, 1, 1};  // width, height, volume when the test begins
  double held_ = 0, found_ = 0, dt_ = 0;
};

}  // namespace

std::size_t peak_of(const ElementPath& path, ElementTest test) {
  const std::vector<double>& of = is_shear(test) ? path.shear : path.deviator;
  // (Perfect plasticity stays at its peak but for round-off.)
  const double most = *std::max_element(of.begin(), of.end());
  return std::size_t(std::find_if(of.begin(), of.end(), [&](double v) { return v >= most * (1 - at_the_peak); }) - of.begin());
}

ElementPath element_test(const MaterialOptions& material, const std::string& key, const ElementTestOptions& options, double cell_m) {
  check_test(options);
  const std::unique_ptr<Material> law = make_material(material, key, cell_m);
  return ElementRun(*law, options).path();
}

std::optional<StrengthLine> strength_line(const std::vector<ElementPath>& paths, ElementTest test) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const ElementPath& path : paths) {
    if (path.size() == 0) continue;
    const std::size_t k = peak_of(path, test);
    const double a = is_shear(test) ? path.vertical[k] : 0.5 * (path.major[k] + path.minor[k]);
    const double b = is_shear(test) ? path.shear[k] : 0.5 * (path.major[k] - path.minor[k]);
    if (a > 0 && b > 0) n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  if (ends_by_stress(test) || n == 0) return std::nullopt;
  const double spread = n * xx - x * x;
  const bool line = n > 1 && spread > 1e-12 * n * xx;
  double slope = line ? (n * xy - x * y) / spread : y / x, offset = line ? (y - slope * x) / n : 0;
  if (std::abs(slope) < at_the_peak) slope = 0;
  if (std::abs(offset) < at_the_peak * x / n) offset = 0;
  if (!(slope > -1 && slope < 1) && !is_shear(test)) return std::nullopt;
  const double angle = is_shear(test) ? std::atan(slope) : std::asin(slope);
  return StrengthLine{offset / (is_shear(test) ? 1 : std::cos(angle)), angle * 180 / std::numbers::pi};
}

}  // namespace pivnp::mpm

// A shear band resolved by finite volumes, in double precision and independent of the solver: temperature and pressure across a band
// and its surroundings, symmetric about its middle,
//   C dT/dt = Gamma T'' + h(y),   S dp/dt = (K/gamma) p'' + beta dT/dt,
// h = tau v/L in the band, tau = (sigma - p_B) tan(phi), p_B the mean over the band; by backward Euler on volumes that grow from its edge.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pivnp::test {

struct HeatedBand {
  // Alvarado 2018, table 4.1; the conductivity is assumed.
  double thickness = 0.01, capacity = 3.03032e6, beta = 1.54e-4, conductivity = 1.4, permeability = 1e-11;
  double skeleton = 1.5e-9, of_water = 0.4 / 2.2e9;  // compressibility, 1/Pa
  double stress = 1e6, friction_deg = 28, depth = 20;
  // Water that expands and thins as it warms, by fits other than the solver's.
  bool by_temperature = false;
  double start_c = 20, porosity = 0.4, grains = 1.8e-5;

  double storage() const { return skeleton + of_water; }
  double mobility() const { return permeability / 9810; }
  /// Volume of water over that at the start (Tilton & Taylor 1937), and its viscosity likewise (Vogel's equation).
  double water_volume(double rise) const { return tilton(start_c) / tilton(start_c + rise); }
  double thinner(double rise) const { return std::exp(507.88 / (start_c + 123.85) - 507.88 / (start_c + rise + 123.85)); }
  double tan_friction() const { return std::tan(friction_deg * M_PI / 180); }

 private:
  static double tilton(double t) { return 1 - (t + 288.9414) * (t - 3.9863) * (t - 3.9863) / (508929.2 * (t + 68.12963)); }
};

class ResolvedBand {
 public:
  explicit ResolvedBand(const HeatedBand& of, std::size_t inside = 24, double growth = 1.06) : of_(of) {
    const double ratio = 1.15, half = 0.5 * of.thickness;
    double sum = 0, term = 1;
    for (std::size_t k = 0; k < inside; ++k, term *= ratio) sum += term;
    double size = half / sum;
    for (std::size_t k = 0; k < inside; ++k, size *= ratio) volume_.insert(volume_.begin(), size);
    inside_ = inside;
    size = half / sum;
    for (double y = half; y < of.depth; y += volume_.back(), size *= growth) volume_.push_back(size);
    hot_.assign(volume_.size(), 0.0);
    pressure_.assign(volume_.size(), 0.0);
  }

  /// Slips at this speed for a step.
  void slip(double speed, double dt) {
    const double work = speed * shear_stress() / of_.thickness;
    std::vector<double> before = hot_, source(hot_.size(), 0.0);
    for (std::size_t k = 0; k < inside_; ++k) source[k] = dt * work;
    diffuse(hot_, of_.capacity, std::vector<double>(hot_.size(), of_.conductivity), dt, source);
    std::vector<double> mobility(hot_.size(), of_.mobility());
    for (std::size_t k = 0; k < hot_.size(); ++k) {
      source[k] = of_.beta * (hot_[k] - before[k]);
      if (!of_.by_temperature) continue;
      source[k] = of_.porosity * (of_.water_volume(hot_[k]) - of_.water_volume(before[k])) + of_.grains * (hot_[k] - before[k]);
      mobility[k] *= of_.thinner(hot_[k]);
    }
    diffuse(pressure_, of_.storage(), mobility, dt, source);
  }
  /// The band loses this share of its volume, `spread` of that from layers as wide on either side, and water flows in a
  /// step.
  void give_way(double by, double spread, double dt) {
    std::vector<double> source(hot_.size(), 0.0);
    double from = 0;
    for (std::size_t k = 0; k < hot_.size(); from += volume_[k++]) {
      const double beside = std::min(1.0, std::max(0.0, 1.5 * of_.thickness - from) / volume_[k]);
      source[k] = by * (k < inside_ ? 1 - spread : 0.5 * spread * beside);
    }
    diffuse(pressure_, of_.storage(), std::vector<double>(hot_.size(), of_.mobility()), dt, source);
  }
  void set_stress(double stress) { of_.stress = stress; }
  double shear_stress() const { return std::max(0.0, of_.stress - pressure()) * of_.tan_friction(); }
  double pressure() const { return mean(pressure_); }
  double temperature() const { return mean(hot_); }

 private:
  double mean(const std::vector<double>& of) const {
    double sum = 0;
    for (std::size_t k = 0; k < inside_; ++k) sum += volume_[k] * of[k];
    return sum / (0.5 * of_.thickness);
  }
  void diffuse(std::vector<double>& x, double storage, const std::vector<double>& conductance, double dt, const std::vector<double>& source) const {
    const std::size_t n = x.size();
    std::vector<double> upper(n, 0.0), right(n);
    double left = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double next = k + 1 < n && conductance[k] > 0 ? dt * 2 / (volume_[k] / conductance[k] + volume_[k + 1] / conductance[k + 1]) : 0;
      const double diagonal = storage * volume_[k] + left + next - (k > 0 ? left * upper[k - 1] : 0);
      upper[k] = next / diagonal;
      right[k] = (volume_[k] * (storage * x[k] + source[k]) + (k > 0 ? left * right[k - 1] : 0)) / diagonal;
      left = next;
    }
    x[n - 1] = right[n - 1];
    for (std::size_t k = n - 1; k-- > 0;) x[k] = right[k] + upper[k] * x[k + 1];
  }

  HeatedBand of_;
  std::size_t inside_;
  std::vector<double> volume_, hot_, pressure_;
};

/// The planar slide of Alvarado 2018's figure 4.6 as this project assumes it: an endless slope of 20 degrees.
///
/// Soil of the shear modulus G that slips in a layer of some width under the shear stress T has normal stresses that
/// differ along and across it by 2 s, s = T^2/G once it has slipped by more than T/G of the width (each increment of
/// elastic strain turns with the slip, and lasts T/G of shear). So the mean stress that the strength follows is s below
/// that across it; while the pores are closed, suction of m s/S in the layer makes up for it, and this flows away.
/// Rigid soil (the default) has none of it.
struct PlanarSlide {
  HeatedBand band;
  double drive = 127.38e3, mass = 37964;
  double shear_modulus = 0, layer = 0;  // Pa, 0: rigid; width of what slips, m
  double spread = 0;                    // of the suction, to layers beside it

  explicit PlanarSlide(HeatedBand of) : band(of) { band.stress = 238.69e3; }
  struct State {
    double time = 0, slip = 0, speed = 0, pressure = 0, temperature = 0;
  };
  /// The state once it has slipped so far.
  State after(double slip, double dt = 2e-3) const {
    ResolvedBand resolved(band);
    HeatedBand as_layer = band;
    as_layer.thickness = layer > 0 ? layer : band.thickness;
    ResolvedBand wide(as_layer);
    State s;
    double difference = 0;
    while (s.slip < slip) {
      if (shear_modulus > 0) {
        const double stress = resolved.shear_stress(), last = difference;
        difference =
            stress * stress / shear_modulus * -std::expm1(-s.slip / as_layer.thickness * shear_modulus / stress);
        wide.give_way(-band.skeleton * (difference - last), spread, dt);
        resolved.set_stress(band.stress - difference - wide.pressure());
      }
      s.speed += dt * (drive - resolved.shear_stress()) / mass;
      resolved.slip(s.speed, dt);
      s.slip += dt * s.speed;
      s.time += dt;
    }
    s.pressure = resolved.pressure() + (shear_modulus > 0 ? wide.pressure() : 0);
    s.temperature = resolved.temperature();
    return s;
  }
};

}  // namespace pivnp::test

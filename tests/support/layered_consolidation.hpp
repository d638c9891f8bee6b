// One-dimensional consolidation of layers at small strain, solved for a test.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace pivnp::test {

/// Layers of unit area, from the base (impervious) to the top (drained), without weight, under a load q that rises linearly
/// until `rise`. The balance of water in a volume, with the flow continuous through the borders of layers:
///   (1/M + n/K_w) dp/dt = d/dz [(K/gamma) dp/dz] + (1/M) dq/dt
/// Finite volumes with harmonic means between centres; backward Euler in steps that grow with time, extrapolated from a step and its
/// halves (second order).
class LayeredConsolidation {
 public:
  struct Layer {
    double thickness, modulus, permeability, storage;  // m, Pa, m/s, n/K_w in 1/Pa
  };
  std::vector<Layer> layers;
  double load = 1, rise = 0;  // Pa, s
  bool base_drained = false;

  /// At `time`, where `per_layer` volumes fill a layer: heights of the centres, and pressures.
  struct State {
    std::vector<double> height, pressure;
    double settlement = 0;  // of the top
    double at(double z) const {
      std::size_t i = 0;
      while (i + 2 < height.size() && height[i + 1] < z) ++i;
      const double t = (z - height[i]) / (height[i + 1] - height[i]);
      return (1 - t) * pressure[i] + t * pressure[i + 1];
    }
  };
  State at(double time, int per_layer = 200, int steps = 2000) const {
    State coarse = march(time, per_layer, steps), fine = march(time, per_layer, 2 * steps);
    for (std::size_t i = 0; i < fine.pressure.size(); ++i) fine.pressure[i] = 2 * fine.pressure[i] - coarse.pressure[i];
    fine.settlement = 2 * fine.settlement - coarse.settlement;
    return fine;
  }

 private:
  static constexpr double weight = 9810;  // of water, N/m^3

  State march(double time, int per_layer, int steps) const {
    State s;
    std::vector<double> size, storage, compliance, mobility;
    double base = 0;
    for (const Layer& layer : layers) {
      for (int i = 0; i < per_layer; ++i) {
        size.push_back(layer.thickness / per_layer);
        s.height.push_back(base + (i + 0.5) * size.back());
        compliance.push_back(1 / layer.modulus);
        storage.push_back(1 / layer.modulus + layer.storage);
        mobility.push_back(layer.permeability / weight);
      }
      base += layer.thickness;
    }
    const std::size_t n = size.size();
    s.pressure.assign(n, 0.0);
    std::vector<double> up(n), diagonal(n), right(n);
    const auto loaded = [&](double t) { return load * (rise > 0 ? std::min(1.0, t / rise) : 1.0); };
    for (std::size_t i = 0; i < n; ++i) {
      const double half = 0.5 * size[i] / mobility[i];
      up[i] = 1 / (half + (i + 1 < n ? 0.5 * size[i + 1] / mobility[i + 1] : 0));
    }
    const double below = base_drained ? mobility[0] / (0.5 * size[0]) : 0;
    double before = rise > 0 ? 0 : load;
    if (rise <= 0)
      for (std::size_t i = 0; i < n; ++i) s.pressure[i] = load * compliance[i] / storage[i];
    double now = 0;
    for (int step = 1; step <= steps; ++step) {
      const double next = time * std::pow(double(step) / steps, 2), dt = next - now, q = loaded(next);
      now = next;
      for (std::size_t i = 0; i < n; ++i) {
        diagonal[i] = storage[i] * size[i] + dt * (up[i] + (i > 0 ? up[i - 1] : below));
        right[i] = storage[i] * size[i] * s.pressure[i] + compliance[i] * size[i] * (q - before);
      }
      before = q;
      for (std::size_t i = 1; i < n; ++i) {
        const double f = -dt * up[i - 1] / diagonal[i - 1];
        diagonal[i] += f * dt * up[i - 1];
        right[i] -= f * right[i - 1];
      }
      for (std::size_t i = n; i-- > 0;) s.pressure[i] = (right[i] + (i + 1 < n ? dt * up[i] * s.pressure[i + 1] : 0)) / diagonal[i];
    }
    for (std::size_t i = 0; i < n; ++i) s.settlement += compliance[i] * size[i] * (before - s.pressure[i]);
    return s;
  }
};

}  // namespace pivnp::test

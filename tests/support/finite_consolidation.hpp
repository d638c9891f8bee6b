// One-dimensional consolidation at finite strain (Gibson, England & Hussey 1967, Geotechnique 17:261), solved for a test.
#pragma once

#include <cmath>
#include <vector>

namespace pivnp::test {

/// A layer of unit area, drained at its top, impervious below, without weight, under a load at once. Lagrangian: Y is the height at
/// time 0, J the stretch. The skeleton follows Hencky's law (Kirchhoff stress M ln J), water fills n J = J - (1 - n0).
///   d/dt [(J - 1 + n0) (1 + p/K_w)] = d/dY [(k/J) dp/dY],   p = q + M ln(J)/J
/// Finite volumes in Y, backward Euler in steps that grow with time, Newton's iteration.
class FiniteConsolidation {
 public:
  double height = 1, modulus = 1e6, porosity = 0.5, bulk = 1e9, load = 0, mobility = 1e-9;  // M, n0, K_w, q, k = K/gamma

  /// At `time`: pressures at the volumes' centres, from the base upwards, and the settlement of the top.
  struct State {
    std::vector<double> pressure;
    double settlement = 0;
  };
  State at(double time, int volumes = 200, int steps = 4000) const {
    const auto n = std::size_t(volumes);
    const double dy = height / volumes;
    double undrained = 1;
    for (int k = 0; k < 50; ++k) undrained -= (water(undrained) - porosity) / storage(undrained);
    std::vector<double> J(n, undrained), lower(n), diagonal(n), upper(n), right(n);
    double now = 0;
    for (int step = 1; step <= steps; ++step) {
      const double next = time * std::pow(double(step) / steps, 2), dt = next - now;
      now = next;
      const std::vector<double> before = J;
      for (int iteration = 0; iteration < 4; ++iteration) {
        for (std::size_t i = 0; i < n; ++i) {
          right[i] = water(before[i]) - water(J[i]);
          diagonal[i] = storage(J[i]);
          lower[i] = upper[i] = 0;
          // (The conductance of a face as of its two volumes, one behind the other.)
          if (i > 0) add(J[i], J[i - 1], dt * mobility * 2 / (dy * dy), right[i], diagonal[i], lower[i]);
          if (i + 1 < n) add(J[i], J[i + 1], dt * mobility * 2 / (dy * dy), right[i], diagonal[i], upper[i]);
          else {
            const double across = dt * mobility * 2 / (dy * dy) / J[i];
            right[i] -= across * pressure(J[i]);
            diagonal[i] += across * slope(J[i]);
          }
        }
        for (std::size_t i = 1; i < n; ++i) {
          const double f = lower[i] / diagonal[i - 1];
          diagonal[i] -= f * upper[i - 1];
          right[i] -= f * right[i - 1];
        }
        for (std::size_t i = n; i-- > 0;) {
          right[i] = (right[i] - (i + 1 < n ? upper[i] * right[i + 1] : 0)) / diagonal[i];
          J[i] += right[i];
        }
      }
    }
    State state;
    for (const double j : J) {
      state.pressure.push_back(pressure(j));
      state.settlement += (1 - j) * dy;
    }
    return state;
  }
  double pressure(double J) const { return load + modulus * std::log(J) / J; }
  /// J when all has drained.
  double end() const {
    double J = 1;
    for (int k = 0; k < 100; ++k) J -= pressure(J) / slope(J);
    return J;
  }

 private:
  double slope(double J) const { return modulus * (1 - std::log(J)) / (J * J); }
  double water(double J) const { return (J - 1 + porosity) * (1 + pressure(J) / bulk); }
  double storage(double J) const { return 1 + pressure(J) / bulk + (J - 1 + porosity) * slope(J) / bulk; }
  void add(double own, double other, double through, double& right, double& diagonal, double& beside) const {
    const double across = through / (own + other);
    right -= across * (pressure(own) - pressure(other));
    diagonal += across * slope(own);
    beside -= across * slope(other);
  }
};

}  // namespace pivnp::test

// Scattered particles and what is read between them, for the tests.
#pragma once

#include <random>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {

/// The lattice of 10 by 10 unit squares, each point moved by up to 0.3 along both axes.
inline std::vector<Vec2> jittered(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  std::vector<Vec2> points = square_lattice(10, 10, 1);
  for (Vec2& p : points) p += Vec2(jitter(random), jitter(random));
  return points;
}

/// Weights of the shares on all points of a mesh.
inline std::vector<double> dense(const Natural& place, std::size_t points) {
  std::vector<double> w(points, 0.0);
  for (const Natural::Share& s : place.shares) w[std::size_t(s.point)] += s.weight;
  return w;
}

}  // namespace pivnp::compare

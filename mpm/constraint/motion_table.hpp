// What a table says of the motion of a body or boundary, and of the forces on it.
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::mpm {

/// One component over the times of a table: values, linear between, or rates, linear between, whose integral it is. At rest before the
/// first row and after the last; before the first row an integral is 0.
struct Course {
  std::vector<double> rows;
  bool rates = false;

  std::vector<double> before;  // of rates: the integral up to each row; prepare()

  bool given() const { return !rows.empty(); }
  void prepare(const std::vector<double>& time);
  double at(const std::vector<double>& time, double t) const;
  double fastest(const std::vector<double>& time) const;
};

struct MotionTable {
  std::vector<double> time;       // s, ascending, two or more
  std::array<Course, 3> courses;  // shift x, y, m; turn, rad, anticlockwise

  bool any() const { return !time.empty(); }
  void prepare();
  /// Since time 0.
  Vec2 shift(double t) const;
  double turn(double t) const;
};

/// On a free body, N/m: linear between rows, constant beyond.
struct ForceTable {
  std::vector<double> time;
  std::array<std::vector<double>, 2> rows;  // x, y; empty: 0

  bool any() const { return !time.empty(); }
  Vec2 at(double t) const;
};

}  // namespace pivnp::mpm

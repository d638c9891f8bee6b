// Where a method works, where it says that it does not, and where it is wrong without a word.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// Errors that count as right (less) and as wrong (more), in the unit of the error.
struct Bounds {
  double right, wrong;
};

/// What became of the results of one combination; counts.
struct Survival {
  double good = 0;     // trusted, and right
  double fair = 0;     // trusted, and between right and wrong
  double flagged = 0;  // not trusted, or no result at all
  double wrong = 0;    // trusted, and wrong: a silent failure
  // Of those that have a value, trusted or not:
  double wrong_values = 0, right_values = 0;
  double wrong_flagged = 0, right_flagged = 0;

  double all() const { return good + fair + flagged + wrong; }
  /// One result that is off by `error` (not a number: wrong).
  void count(double error, const Bounds& bounds, bool trusted) {
    const bool is_right = error < bounds.right, is_wrong = !(error <= bounds.wrong);
    (!trusted ? flagged : is_right ? good : is_wrong ? wrong : fair) += 1;
    if (is_wrong) wrong_values += 1, wrong_flagged += !trusted;
    if (is_right) right_values += 1, right_flagged += !trusted;
  }
  /// One that claims no value.
  void count_none() { flagged += 1; }
  void add(const Survival& other) {
    good += other.good, fair += other.fair, flagged += other.flagged, wrong += other.wrong;
    wrong_values += other.wrong_values, right_values += other.right_values;
    wrong_flagged += other.wrong_flagged, right_flagged += other.right_flagged;
  }
};

struct MapAxis {
  std::string label;
  std::vector<double> levels = {};      // ascending
  std::vector<std::string> names = {};  // in the place of numbers
  std::size_t size() const { return names.empty() ? levels.size() : names.size(); }
};

/// What holds on one side of: y at x, both in the axes' units.
struct LimitLine {
  std::string name;
  std::vector<Vec2> points;
};

struct SurvivalMap {
  std::string name;   // of its files; begins with the stage: piv_, np_, mpm_, compare_
  std::string title;
  std::string made_of;  // one sentence, with what counts as right and as wrong
  MapAxis x, y;
  std::vector<Survival> cells;  // row after row, [y][x]
  std::vector<LimitLine> theory;

  Survival& at(std::size_t i, std::size_t j) { return cells[j * x.size() + i]; }
  const Survival& at(std::size_t i, std::size_t j) const { return cells[j * x.size() + i]; }
  Survival total() const {
    Survival sum;
    for (const Survival& s : cells) sum.add(s);
    return sum;
  }
};

/// A map that is to be made. A combination rests on nothing but its own indices, so that combinations can be made in any order, several
/// at a time, and some of them in an earlier run.
struct MapPlan {
  SurvivalMap map;       // without cells
  std::string settings;  // in words, what its results rest on beside the levels
  /// Works on one thread; throws Interrupted where the progress asks it to stop.
  std::function<Survival(std::size_t i, std::size_t j, Progress& progress)> result;
};

}  // namespace pivnp::app

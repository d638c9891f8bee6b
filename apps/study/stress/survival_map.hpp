// Where a method works, where it says that it does not, and where it is wrong without a word.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::app {

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

/// What theory expects to hold on one side of: y at x, both in the axes' units.
struct TheoryLine {
  std::string name;
  std::vector<Vec2> points;
};

struct SurvivalMap {
  std::string name;   // of its files
  std::string title;
  std::string made_of;  // one sentence, with what counts as right and as wrong
  MapAxis x, y;
  std::vector<Survival> cells;  // row after row, [y][x]
  std::vector<TheoryLine> theory;

  Survival& at(std::size_t i, std::size_t j) { return cells[j * x.size() + i]; }
  const Survival& at(std::size_t i, std::size_t j) const { return cells[j * x.size() + i]; }
  Survival total() const {
    Survival sum;
    for (const Survival& s : cells) sum.add(s);
    return sum;
  }
};

}  // namespace pivnp::app

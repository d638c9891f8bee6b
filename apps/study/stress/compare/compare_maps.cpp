#include "apps/study/stress/compare/compare_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "compare/compare.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr int block_columns = 12, block_rows = 6, instants = 9, at_rest = 3, verdicts = 20;  // particles, times, pairs of motions a combination
constexpr double stated = 1, u_val = 1.4142135623730951 * stated;               // of a component; of both
constexpr double clear_difference = 4, least_coverage = 0.9;

// Two motions of one block that is at rest, and then moves evenly.
struct Apart {
  double error = stated;        // standard deviation of the first's error, common to all its particles, in a component
  double difference = 0;        // rms at the end, u_val
  double overlap = 1;           // share of the block, from its left, that the second motion has
  double offset_frames = 0;     // of the second's clock
  bool in_last_quarter = false;  // the difference is there alone
  compare::TimeAlignment alignment = compare::TimeAlignment::none;
};

ParticleSet part_of_block(double share) {
  ParticleSet set;
  for (int j = 0; j < block_rows; ++j)
    for (int i = 0; i < block_columns; ++i) {
      if (i + 0.5 > share * block_columns) continue;
      set.id.push_back(std::int64_t(j) * block_columns + i);
      set.label.push_back(0);
      set.x0.push_back({100.0 * (i + 0.5), 100.0 * (j + 0.5)});
      set.area.push_back(1e4);
      set.born.push_back(0);
      set.end.push_back(std::numeric_limits<double>::quiet_NaN());
      set.end_reason.push_back(EndReason::none);
    }
  set.label_names = {"soil"};
  return set;
}

template <class Displacement>
MotionMemory motion_of(const std::string& name, ParticleSet set, double clock, bool with_cov, const Displacement& u) {
  MotionMemory m(name, "px", "frames", set);
  for (int k = 0; k < instants; ++k) {
    MotionFrame frame;
    frame.time = k + clock;
    for (const Vec2& x : set.x0) {
      const Vec2 d = u(x, k);
      frame.u.push_back({float(d.x()), float(d.y())});
      frame.F.push_back({1, 0, 0, 1});
      frame.status.push_back(ParticleStatus::active);
      if (with_cov) frame.cov_u.push_back({k == 0 ? 0 : float(stated * stated), k == 0 ? 0 : float(stated * stated), 0});
    }
    m.add(std::move(frame));
  }
  return m;
}

void judge(Survival& s, const Apart& apart, std::mt19937_64& random, Progress& progress) {
  std::normal_distribution<double> normal;
  const double ex = apart.error * normal(random), ey = apart.error * normal(random);
  constexpr double a_frame = 10 * u_val;
  const auto moved = [](int k) { return std::max(0, k - at_rest); };
  const double most = apart.difference * u_val * (apart.in_last_quarter ? 2 : 1);  // of a quarter of them: twice their rms
  const MotionMemory first = motion_of("first", part_of_block(1), 0, true, [&](const Vec2&, int k) -> Vec2 { return Vec2(a_frame * moved(k), 0) + (k == 0 ? Vec2(0, 0) : Vec2(ex, ey)); });
  const MotionMemory second = motion_of("second", part_of_block(apart.overlap), apart.offset_frames, false, [&](const Vec2& x, int k) -> Vec2 {
    const bool differs = !apart.in_last_quarter || x.x() > 75.0 * block_columns;
    return {a_frame * moved(k) + (differs ? most * moved(k) / moved(instants - 1) : 0), 0};
  });
  compare::CompareOptions options;
  options.time_alignment = apart.alignment;
  try {
    const Comparison c = compare::compare(first, second, options, {}, progress);
    const Metric* rms = find(c.metrics, "displacement_rms_final");
    const Metric* coverage = find(c.metrics, "coverage_first");
    if (!rms || !std::isfinite(rms->uncertainty) || !coverage || coverage->value < least_coverage) {
      s.count_none();
      return;
    }
    // Said to be doubtful: clocks that differ, or errors beyond what is stated while nothing moves.
    const Metric *onset = find(c.metrics, "onset_difference"), *rest = find(c.metrics, "rest_over_u");
    const bool clocks = apart.alignment == compare::TimeAlignment::none && onset && std::abs(onset->value) > 2 * onset->uncertainty;
    if (clocks || (rms->told_apart() && rest && rest->value > 2)) {
      s.count_none();
      return;
    }
    const bool told_apart = rms->told_apart();
    const bool clear = apart.difference >= clear_difference, none = apart.difference == 0;
    // (Where an onset is not known well, u_val is more than that of the motions, and the verdict says what it would have seen.)
    const bool unseen = clear && !told_apart && apart.difference * u_val < rms->seen();
    ((!clear && !none) || unseen ? s.fair : told_apart == clear ? s.good : s.wrong) += 1;
  } catch (const InputError&) {
    s.count_none();
  }
}

template <class Put>
void add(std::vector<MapPlan>& all, const std::string& name, const std::string& title, const std::string& words, MapAxis x, MapAxis y, std::vector<LimitLine> theory, Put put) {
  MapPlan plan;
  plan.map = {name, title,
              words + ". " + std::to_string(verdicts) + " pairs of motions of " + std::to_string(block_columns * block_rows) + " particles a combination; an error is common to all particles. Wrong: told apart where there is no difference, or not told apart where there are " +
                  number(clear_difference) + " u_val and more and the verdict says that it would have found that difference; in between both may be said. Flagged: no verdict, less than " + number(100 * least_coverage) + " % of the first with a partner, or a difference of which the comparison remarks that the clocks differ or that errors before the motion are larger than stated.",
              std::move(x), std::move(y), {}, std::move(theory)};
  plan.result = [=, xs = plan.map.x.levels, ys = plan.map.y.levels](std::size_t i, std::size_t j, Progress& progress) {
    std::mt19937_64 random(7000 + 37 * i + j);
    Apart apart;
    put(apart, xs[i], ys.empty() ? double(j) : ys[j]);
    Survival s;
    for (int k = 0; k < verdicts; ++k) judge(s, apart, random, progress);
    return s;
  };
  all.push_back(std::move(plan));
}

}  // namespace

std::vector<MapPlan> compare_maps() {
  const MapAxis difference{"difference (u_val)", {0, 2, 4, 6, 10}};
  const LimitLine two{"two u_val", {{0, 2}, {1, 2}}};
  std::vector<MapPlan> all;
  add(all, "compare_noise", "Errors against what is stated of them", "Motions that differ evenly", {"error over the stated one", {0.1, 0.25, 0.5, 1, 1.5, 2, 4}}, difference,
      {{two.name, {{0.1, 2}, {4, 2}}}, {"errors as stated", {{1, 0}, {1, 10}}}}, [](Apart& a, double x, double y) {
        a.error = x * stated;
        a.difference = y;
      });
  add(all, "compare_overlap", "Partial overlap", "Motions that differ in the last quarter of the block", {"share of the block that both have", {0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 1}}, difference,
      {{two.name, {{0.05, 2}, {1, 2}}}}, [](Apart& a, double x, double y) {
        a.overlap = x;
        a.difference = y;
        a.in_last_quarter = true;
      });
  add(all, "compare_offset", "Clocks that differ", "Motions of 10 u_val a frame after three frames at rest, that do not differ or by 6 u_val at the end", {"offset of the second's clock (frames)", {0, 0.05, 0.1, 0.2, 0.5, 1, 2}},
      {"time_alignment, difference", {}, {"none, none", "none, 6 u_val", "onset, none", "onset, 6 u_val"}}, {{"the offset makes two u_val", {{0.2, 0}, {0.2, 2}}}}, [](Apart& a, double x, double row) {
        a.offset_frames = x;
        a.difference = int(row) % 2 ? 6 : 0;
        a.alignment = row < 2 ? compare::TimeAlignment::none : compare::TimeAlignment::onset;
      });
  return all;
}

}  // namespace pivnp::app

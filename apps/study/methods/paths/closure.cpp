#include "apps/study/methods/paths/closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/study/methods/frames/repeated_cause.hpp"
#include "apps/study/pipeline/measure/material_masks.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/np/tracker.hpp"
#include "pivnp/piv/validation/closure.hpp"

namespace pivnp::app {

namespace {

constexpr int most_strides = 8;

ParticleSet at_nodes(const Grid& grid) {
  ParticleSet set;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      set.id.push_back(std::int64_t(set.id.size()));
      set.x0.push_back(grid.position(i, j));
    }
  const std::size_t n = set.size();
  set.label.assign(n, 0);
  set.area.assign(n, 0);
  set.born.assign(n, 0);
  set.end.assign(n, nan_value);
  set.end_reason.assign(n, EndReason::none);
  set.label_names = {"nodes"};
  return set;
}

// Nodes carried through `fields` in turn; those that rest on anything but measured vectors throughout are not `good`.
struct Carried {
  np::Tracker tracker;
  std::vector<std::uint8_t> good;

  Carried(const np::NpOptions& options, const Grid& grid)
      : tracker(options, at_nodes(grid), 0), good(grid.node_count(), 1) {}
  void step(const VectorField& field) {
    tracker.step(field, tracker.time() + 1);
    for (std::size_t n = 0; n < good.size(); ++n) good[n] &= tracker.state()[n].status == ParticleStatus::active;
  }
};

struct Closed {
  piv::ClosureChain chain;
  double share = 0;               // of the nodes that are valid in the first pair
  double correlation_length = 0;  // of the first pair
};

Closed close_chain(const np::NpOptions& options, const Grid& grid, int first, int steps,
                   const std::function<VectorField(int)>& pair, const VectorField& direct) {
  Carried stepwise(options, grid), at_once(options, grid);
  Closed out;
  std::size_t valid = 0, closed = 0;
  for (int k = first; k < first + steps; ++k) {
    VectorField field = pair(k);
    field.path_factor.clear();  // of paths from the first frame on
    if (k == first) {
      valid = std::size_t(std::count(field.status.begin(), field.status.end(), VectorStatus::valid));
      out.correlation_length = double(field.correlation_length);
    }
    stepwise.step(field);
  }
  at_once.step(direct);
  out.chain.steps = steps;
  out.chain.off.assign(grid.node_count(), {nan_value, nan_value});
  out.chain.variance = out.chain.off;
  for (std::size_t n = 0; n < grid.node_count(); ++n) {
    if (!stepwise.good[n] || !at_once.good[n]) continue;
    const np::Tracker::Particle a = stepwise.tracker.state()[n], b = at_once.tracker.state()[n];
    out.chain.off[n] = {a.x.x() - b.x.x(), a.x.y() - b.x.y()};
    out.chain.variance[n] = {a.cov[0] + b.cov[0], a.cov[1] + b.cov[1]};
    ++closed;
  }
  out.share = valid > 0 ? double(closed) / double(valid) : 0;
  return out;
}

// By the first and last frame that chains reach, between which the material moves on as in the first chain.
std::string cause_of(const ClosureNote& note, const Setting& setting, image::FrameSource& source, const VectorField& direct) {
  constexpr double grain = 6;  // px, a generous one
  const auto [first, last] = note.chains.front();
  const int end = note.chains.back()[1];
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  std::vector<double> moved_px(direct.grid.node_count(), NAN);
  for (std::size_t n = 0; n < moved_px.size(); ++n)
    if (direct.status[n] == VectorStatus::valid)
      moved_px[n] = std::hypot(double(direct.displacement[n][0]), double(direct.displacement[n][1])) / pixel * (end - first) / (last - first);
  const std::vector<Vec2> moved = amid_motion(setting, first, moved_px, grain);
  const StillPicture still = setting.cameras.empty() ? still_picture(prepared(setting, source.read(first)), prepared(setting, source.read(end)), moved) : StillPicture{};
  return repeated_cause(still, bent_share(note.repeated, direct, last - first, pixel));
}

}  // namespace

ClosureNote check_closure(const Case& c, const Setting& setting, image::FrameSource& source,
                          const std::function<VectorField(int)>& pair, int threads, Progress& progress) {
  ClosureNote note;
  const int pairs = int(source.frames().size()) - 1, asked = c.piv.value_or(piv::PivOptions{}).closure;
  const int chains = std::min(asked, pairs / 2);
  if (asked < 2) {
    note.verdict = "not checked: switched off";
    return note;
  }
  if (c.camera.row_time_s != 0) {
    note.verdict = "not checked: rows are read one after the other, so that pairs further apart show other times";
    return note;
  }
  if (chains < 2) {
    note.verdict = "not checked: fewer than five frames";
    return note;
  }
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  const int spacing = pairs / chains;
  int steps = std::clamp(spacing, 2, most_strides);
  std::vector<piv::ClosureChain> closed;
  std::vector<double> lengths;
  VectorField first_direct;
  MaterialMasks material(c, setting, pair);
  for (int k = 0; k < chains; ++k) {
    const int first = k * (pairs - spacing) / (chains - 1);
    for (;; steps /= 2) {
      if (progress.stop_requested()) throw Interrupted();
      const VectorField direct = measure_pair(c, setting, source, {first, first + steps}, threads, &material);
      Closed found = close_chain(options, setting.grid, first, steps, pair, direct);
      if (found.share >= 0.5) {
        closed.push_back(std::move(found.chain));
        lengths.push_back(found.correlation_length);
        note.chains.push_back({first, first + steps});
        if (first_direct.displacement.empty()) first_direct = direct;
        break;
      }
      if (steps < 4) break;
    }
    progress.update("closure", k + 1, chains);
  }
  if (closed.size() < 2) {
    note.verdict = "not checked: frames two steps apart do not correlate";
    return note;
  }
  std::nth_element(lengths.begin(), lengths.begin() + std::ptrdiff_t(lengths.size() / 2), lengths.end());
  piv::RepeatedError found = piv::repeated_error(setting.grid, lengths[lengths.size() / 2], closed);
  note.verdict = found.cov.empty() ? "agrees" : "repeated error";
  note.strength = found.strength;
  note.threshold = found.threshold;
  note.repeated = std::move(found.cov);
  if (!note.repeated.empty()) note.cause = cause_of(note, setting, source, first_direct);
  return note;
}

void add_repeated(const ClosureNote& note, int step, VectorField& field) {
  if (note.repeated.empty() || field.cov.size() != note.repeated.size()) return;
  for (std::size_t n = 0; n < field.cov.size(); ++n) {
    const double moved = std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1]));
    const double alike = moved > 0 ? double(field.correlation_length) / moved : std::numeric_limits<double>::infinity();
    const auto times = static_cast<float>(2 * std::min(double(step), std::max(1.0, alike)) - 1);
    const float before = field.cov[n][0] + field.cov[n][1], more = times * (note.repeated[n][0] + note.repeated[n][1]);
    for (std::size_t k = 0; k < 3; ++k) field.cov[n][k] += times * note.repeated[n][k];
    // It has its own share of what adds up.
    if (!field.path_factor.empty() && before + more > 0) field.path_factor[n] = (field.path_factor[n] * before + more) / (before + more);
  }
}

std::vector<std::string> closure_remarks(const ClosureNote& note, const Setting& setting) {
  if (note.repeated.empty()) return {};
  std::vector<double> sigma;
  for (const auto& cov : note.repeated) sigma.push_back(std::sqrt(0.5 * (double(cov[0]) + double(cov[1]))));
  std::sort(sigma.begin(), sigma.end());
  const double pixel = setting.grid.spacing.x() / node_spacing_px(setting);
  std::int32_t longest = 0;
  for (const auto& chain : note.chains) longest = std::max(longest, std::int32_t(chain[1] - chain[0]));
  const auto at = [&](double q) { return number(sigma[std::size_t(q * double(sigma.size() - 1))] / pixel, 2); };
  return {
      "Steps in turn differ from direct correlation over up to " + std::to_string(longest) +
      " of them by more than their uncertainty explains: every pair repeats an error at the same place, of " +
      at(0.5) + " px in the median and of more than " + at(0.95) +
      " px in the worst twentieth. " +
      (note.cause.empty() ? std::string("What causes it the frames do not tell.") : "What they show: " + note.cause + ".") +
      " The uncertainty of the paths includes it."};
}

}  // namespace pivnp::app

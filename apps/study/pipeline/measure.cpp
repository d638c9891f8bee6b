#include "apps/study/pipeline/measure.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/study/pipeline/shutter.hpp"
#include "apps/study/pipeline/statistics.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/piv/sequence.hpp"

namespace pivnp::app {

namespace {

// Where the nodes of a pair are, and how what is at rest moves in it.
piv::CameraStep camera_step(const Setting& setting, std::array<int, 2> pair, Anchor anchor) {
  return {node_lattice(setting, pair, anchor).pixel, motion_at_rest(setting, pair)};
}

}  // namespace

StepQuality quality_of(const VectorField& field) {
  StepQuality q;
  std::size_t asked = 0, valid = 0;
  std::vector<double> scores, shifts;
  for (std::size_t n = 0; n < field.status.size(); ++n) {
    if (field.status[n] == VectorStatus::masked) continue;
    ++asked;
    if (std::isfinite(field.score[n])) scores.push_back(double(field.score[n]));
    if (field.status[n] != VectorStatus::valid) continue;
    ++valid;
    shifts.push_back(std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1])) /
                     field.grid.spacing.x());
  }
  q.valid = asked > 0 ? double(valid) / double(asked) : 0;
  q.median_score = median(std::move(scores));
  q.median_shift = median(std::move(shifts));
  return q;
}

void measure(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer, int threads,
             Progress& progress) {
  const io::StageState done = writer.stage("piv");
  if (done.complete) return;
  const int frames = int(source.frames().size());
  piv::NodeLattice lattice = node_lattice(setting);
  const piv::PivOptions options = c.piv.value_or(piv::PivOptions{});
  const bool moves = !setting.cameras.empty();
  piv::SequenceCorrelator correlator(options, lattice, setting.width, setting.height, threads);
  // Pairs are smoothed in groups: those of a group that was begun are measured again, with the same bits.
  const int first_pair = int(done.items);
  int from = first_pair - first_pair % piv::SequenceCorrelator::group;
  std::optional<RowClock> rows;  // of each pair it asks those beside it, so that the group before is measured again too
  if (c.camera.row_time_s != 0) rows.emplace(c.camera.row_time_s, setting, source.frames());
  if (rows) from = std::max(0, from - piv::SequenceCorrelator::group);
  const auto keep = [&](const VectorField& field) {
    if (field.pair[0] < first_pair) return;
    writer.add_pair(field);
    if (writer.segment_full("piv")) writer.close_segment("piv", {});
  };
  Image before;
  image::Mask mask_before;
  const bool moving = !setting.moving_masks.empty();
  if (first_pair + 1 < frames) before = source.read(from);
  if (moving && !before.empty()) mask_before = mask_of(setting, from, before.view());
  for (int k = from; first_pair + 1 < frames && k + 1 < frames; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    Image after = source.read(k + 1);
    const auto camera = moves ? camera_step(setting, {k, k + 1}, options.anchor) : piv::CameraStep{};
    image::Mask mask_after = moving ? mask_of(setting, k + 1, after.view()) : image::Mask();
    const image::Mask mask = moving ? image::both(mask_before, mask_after) : image::Mask();
    correlator.add(before.view(), after.view(), moving ? mask.view() : setting.mask.view(), moves ? &camera : nullptr);
    mask_before = std::move(mask_after);
    before = std::move(after);
    progress.update("PIV", k + 1, frames - 1);
    if (correlator.held() < piv::SequenceCorrelator::group && k + 2 < frames) continue;
    for (const piv::PixelVectors& pixels : correlator.finish()) {
      if (rows || from >= first_pair) {
        if (moves) lattice = node_lattice(setting, {from, from + 1}, options.anchor);
        VectorField field = world_vectors(pixels, lattice, setting, {from, from + 1});
        if (!rows) keep(field);
        else
          for (const VectorField& ready : rows->add(std::move(field))) keep(ready);
      }
      ++from;
    }
  }
  if (rows)
    for (const VectorField& ready : rows->finish()) keep(ready);
  writer.end_stage("piv", nullptr);
}

VectorField measure_pair(const Case& c, const Setting& setting, image::FrameSource& source, std::array<int, 2> pair,
                         int threads) {
  const piv::PivOptions options = c.piv.value_or(piv::PivOptions{});
  const piv::NodeLattice lattice = node_lattice(setting, pair, options.anchor);
  piv::PairCorrelator correlator(options, lattice, setting.width, setting.height, threads);
  const Image first = source.read(pair[0]), second = source.read(pair[1]);
  const image::Mask mask = setting.moving_masks.empty()
                               ? setting.mask
                               : image::both(mask_of(setting, pair[0], first.view()), mask_of(setting, pair[1], second.view()));
  VectorField field = world_vectors(correlator.correlate(first.view(), second.view(), mask.view()), lattice, setting, pair);
  if (c.camera.row_time_s == 0) return field;
  return RowClock(c.camera.row_time_s, setting, source.frames()).alone(field);
}

std::vector<std::uint8_t> step_flags(const std::vector<StepQuality>& pairs) {
  std::vector<double> valid, score;
  for (const StepQuality& q : pairs) {
    valid.push_back(q.valid);
    score.push_back(q.median_score);
  }
  const double usual_valid = median(valid), usual_score = median(score);
  constexpr double still = 0.01;  // spacings: less is no motion to compare
  constexpr double noisy_score = 0.999, same_exposure = 0.99999;
  std::vector<std::uint8_t> flags(pairs.size(), frame_ok);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const StepQuality& q = pairs[k];
    if (q.valid < 0.5 * usual_valid || q.median_score < 0.6 * usual_score) {
      flags[k] |= frame_decorrelated;
      continue;
    }
    // Of two exposures the noise differs, however slow the test; where it does not, they are one.
    if (usual_score < noisy_score && q.median_score > same_exposure) {
      flags[k] |= frame_repeated;
      continue;
    }
    if (k == 0 || k + 1 == pairs.size()) continue;
    const double before = pairs[k - 1].median_shift, after = pairs[k + 1].median_shift, mean = (before + after) / 2;
    if (mean < still || std::abs(after - before) > 0.25 * mean) continue;
    if (q.median_shift < 0.05 * mean)
      flags[k] |= frame_repeated;
    else if (std::abs(q.median_shift - mean) > 0.5 * mean)
      flags[k] |= frame_jump;
  }
  return flags;
}

std::vector<Frame> flagged_frames(std::vector<Frame> frames, const io::RecordWriter& writer) {
  std::vector<StepQuality> pairs;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) pairs.push_back(quality_of(writer.pair(k)));
  const std::vector<std::uint8_t> flags = step_flags(pairs);
  for (std::size_t k = 0; k < flags.size(); ++k) frames[k + 1].flag |= flags[k];
  return frames;
}

}  // namespace pivnp::app

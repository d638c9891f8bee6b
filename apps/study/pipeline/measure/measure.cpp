#include "apps/study/pipeline/measure/measure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <utility>

#include "apps/study/pipeline/measure/material_masks.hpp"
#include "apps/study/pipeline/measure/moving_regions.hpp"
#include "apps/study/pipeline/measure/shutter.hpp"
#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/piv/sequence.hpp"

namespace pivnp::app {

namespace {

// Where the nodes of a pair are, and how what is at rest moves in it.
piv::CameraStep camera_step(const Setting& setting, std::array<int, 2> pair, Anchor anchor) {
  return {node_lattice(setting, pair, anchor).pixel, motion_at_rest(setting, pair)};
}

void look_at(const Image& frame, int k, FrameLooks* looks) {
  if (looks != nullptr) looks->at(std::size_t(k)) = look_of(frame.view());
}

template <class Grey>
FrameLook looked_at(const ImageView& frame, double white) {
  constexpr int apart = 4;
  double sum = 0, bright = 0, count = 0;
  for (int r = 0; r < frame.height; r += apart)
    for (int c = 0; c < frame.width; c += apart) {
      const double value = double(frame.row<Grey>(r)[c]) / white;
      sum += value, bright += value > 0.99, ++count;
    }
  return {sum / count, bright / count};
}

// What the steps about step k say of it, and how far they are from saying one thing (logarithms); NaN without two
// moving steps on each side.
struct Expected {
  double log_shift = NAN, scatter = NAN;
};

Expected expected_step(const std::vector<StepQuality>& pairs, std::size_t k, double still) {
  if (k < 2 || k + 2 >= pairs.size()) return {};
  double mean = 0, slope = 0, left = 0;
  const auto at = [&](int by) { return pairs[std::size_t(std::ptrdiff_t(k) + by)].median_shift; };
  for (const int by : {-2, -1, 1, 2}) {
    if (!(at(by) >= still)) return {};
    mean += std::log(at(by)) / 4, slope += by * std::log(at(by)) / 10;
  }
  for (const int by : {-2, -1, 1, 2}) left += std::pow(std::log(at(by)) - mean - slope * by, 2) / 2;
  return {mean, std::sqrt(left)};
}

constexpr double third = 1.0 / 3;  // of what other steps differ by: noise of two exposures would not be so small

// The exposure before, compressed anew: its noise is the same but for the compression's. `usual`: 1 - score of the
// steps about it.
bool same_noise(const StepQuality& q, double usual) { return q.same || 1 - q.median_score < third * usual; }

double unlikeness_about(const std::vector<StepQuality>& pairs, std::size_t k) {
  std::vector<double> unlike;
  for (const int by : {-2, -1, 1, 2}) {
    const std::ptrdiff_t n = std::ptrdiff_t(k) + by;
    if (n >= 0 && n < std::ptrdiff_t(pairs.size())) unlike.push_back(1 - pairs[std::size_t(n)].median_score);
  }
  return median(std::move(unlike));
}

bool compressed_anew(const std::vector<StepQuality>& pairs, std::size_t k) {
  if (k < 2 || k + 2 >= pairs.size() || !(pairs[k].along > 0.5)) return false;
  for (const std::size_t n : {k - 1, k + 1})
    if (!(pairs[k].median_shift < 0.5 * pairs[n].median_shift)) return false;
  return same_noise(pairs[k], unlikeness_about(pairs, k));
}

// Of a recording that holds each frame several times: the steps within the holds. All else between them is one step
// each time, and the holds are of one length, or of two that follow one another. Else empty.
std::vector<std::uint8_t> held(const std::vector<StepQuality>& pairs) {
  constexpr std::size_t most = 8, least_holds = 4;
  std::vector<double> unlike;
  for (const StepQuality& q : pairs) unlike.push_back(q.same ? 0 : 1 - q.median_score);
  std::sort(unlike.begin(), unlike.end());
  if (unlike.empty()) return {};
  const double between = unlike[unlike.size() - 1 - unlike.size() / (2 * most)];
  std::vector<std::uint8_t> within;
  for (const StepQuality& q : pairs) within.push_back(same_noise(q, between));
  std::vector<std::size_t> steps, lengths;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (!within[k]) steps.push_back(k);
  for (std::size_t n = 0; n + 1 < steps.size(); ++n) {
    lengths.push_back(steps[n + 1] - steps[n]);
    const double moved = std::max(pairs[steps[n]].median_shift, pairs[steps[n + 1]].median_shift);
    for (std::size_t k = steps[n] + 1; k < steps[n + 1]; ++k)
      if (!pairs[k].same && (!(pairs[k].median_shift < 0.5 * moved) || (lengths.back() == 2 && !(pairs[k].along > 0.5)))) return {};
  }
  if (lengths.size() < least_holds) return {};
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  return *shortest >= 2 && *longest <= std::min(most, *shortest + 1) ? within : std::vector<std::uint8_t>{};
}

// Of all bytes.
std::uint64_t digest_of(const ImageView& frame) {
  const std::size_t bytes = std::size_t(frame.width) * (frame.depth == PixelDepth::u8 ? 1 : frame.depth == PixelDepth::u16 ? 2 : 4);
  std::uint64_t sum = 0x9E3779B97F4A7C15u;
  for (int r = 0; r < frame.height; ++r) {
    const std::byte* row = frame.row<std::byte>(r);
    for (std::size_t at = 0; at < bytes; at += sizeof sum) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + at, std::min(sizeof word, bytes - at));
      sum = (sum ^ word) * 0xD6E8FEB86659FD93u;
      sum ^= sum >> 32;
    }
  }
  return sum;
}

// Cosine between two fields of displacements.
double cosine(const VectorField& a, const VectorField& b) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t n = 0; n < std::min(a.status.size(), b.status.size()); ++n) {
    if (a.status[n] != VectorStatus::valid || b.status[n] != VectorStatus::valid) continue;
    for (std::size_t c = 0; c < 2; ++c) {
      const double x = double(a.displacement[n][c]), y = double(b.displacement[n][c]);
      ab += x * y, aa += x * x, bb += y * y;
    }
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 1;
}

// The regions of a group of pairs as masks, of each pair its own, `first` being the group's first frame. Between them the outlines go on by
// `own`, the mean vectors, or by what they moved by last. `changed`: something else than before is left out.
std::vector<std::vector<std::uint8_t>> masks_of_group(const Setting& setting, int first, const std::vector<Image>& frames, const VectorField* own,
                                                      MovingRegions& regions, bool* changed = nullptr) {
  std::vector<std::vector<std::uint8_t>> out;
  for (std::size_t n = 0; n + 1 < frames.size(); ++n) {
    const int k = first + int(n);
    VectorField here;
    if (own != nullptr) {
      here = *own, here.pair = {k, k + 1};
      if (regions.revise(here, frames[n].view(), frames[n + 1].view()) && changed != nullptr) *changed = true;
    } else {
      regions.look(k, frames[n].view(), frames[n + 1].view());
    }
    const MaskView mask = regions.mask();
    out.emplace_back(mask.data, mask.data + (mask.data != nullptr ? std::size_t(setting.width) * std::size_t(setting.height) : 0));
    if (own != nullptr) regions.carry(here);
    else regions.carry_on();
  }
  return out;
}

// Pairs whose correlations are averaged: each of a group has their mean displacement. Groups begin at multiples of
// their number, so that a run that is taken up again has the same.
std::vector<Remark> measure_means(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer,
                   int first_pair, int threads, Progress& progress, FrameLooks* looks) {
  const piv::PivOptions options = *c.piv;
  const piv::NodeLattice lattice = node_lattice(setting);
  piv::PairCorrelator correlator(options, lattice, setting.width, setting.height, threads);
  const int frames = int(source.frames().size());
  std::vector<Image> held;
  const int start = first_pair - first_pair % options.ensemble;
  MovingRegions regions(setting, options.window_px, options.follow_regions && !c.regions.empty());
  for (int k = 0; regions.any() && k < start; ++k) regions.keep(writer.pair(std::size_t(k)));
  for (int from = start; from + 1 < frames; from += options.ensemble) {
    if (progress.stop_requested()) throw Interrupted();
    const int to = std::min(from + options.ensemble, frames - 1);
    if (!held.empty()) held.erase(held.begin(), held.end() - 1);
    image::Mask mask;
    for (int k = held.empty() ? from : from + 1; k <= to; ++k) {
      held.push_back(source.read(k));
      look_at(held.back(), k, looks);
    }
    for (int k = from; k <= to && !setting.moving_masks.empty(); ++k) {
      image::Mask here = mask_of(setting, k, held[std::size_t(k - from)].view());
      mask = k == from ? std::move(here) : image::both(mask, here);
    }
    std::vector<Image> ready;
    for (const Image& frame : held)
      ready.push_back(prepared(setting, image::part_of(frame.view(), 0, 0, frame.width(), frame.height())));
    const auto mean_of = [&](const std::vector<std::vector<std::uint8_t>>& material) {
      std::vector<piv::FramePair> pairs;
      for (std::size_t k = 0; k + 1 < ready.size(); ++k) {
        const bool part = k < material.size() && !material[k].empty();
        pairs.push_back({ready[k].view(), ready[k + 1].view(), part ? MaskView{material[k].data(), setting.width, setting.height, setting.width} : MaskView{}});
      }
      return correlator.correlate_mean(pairs, setting.moving_masks.empty() ? setting.mask.view() : mask.view());
    };
    piv::PixelVectors pixels;
    regions.begin_group();
    if (regions.any()) {
      const auto own = [&] { return world_vectors(pixels, lattice, setting, {from, from + 1}); };
      MovingRegions ahead = regions, seen = regions;
      pixels = mean_of(masks_of_group(setting, from, ready, nullptr, ahead));
      seen.look(from, ready[0].view(), ready[1].view());
      VectorField field = own();
      bool changed = false;
      const auto masks = masks_of_group(setting, from, ready, &field, seen, &changed);
      if (changed) pixels = mean_of(masks), field = own();
      masks_of_group(setting, from, ready, &field, regions);
    } else {
      pixels = mean_of({});
    }
    for (int k = from; k < to; ++k) {
      progress.update("PIV", k + 1, frames - 1);
      const VectorField field = world_vectors(pixels, lattice, setting, {k, k + 1});
      regions.keep(field);
      if (k < first_pair) continue;
      writer.add_pair(field);
      if (writer.segment_full("piv")) writer.close_segment("piv", {});
    }
  }
  return regions.remarks();
}

// Exposures of a double-frame camera: nothing is known of the motion from one pair to the next.
void measure_twos(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer, int first_pair,
                  int threads, Progress& progress) {
  const int pairs = int(source.frames().size() / 2);
  for (int k = first_pair; k < pairs; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    writer.add_pair(measure_pair(c, setting, source, {2 * k, 2 * k + 1}, threads));
    if (writer.segment_full("piv")) writer.close_segment("piv", {});
    progress.update("PIV", k + 1, pairs);
  }
  writer.end_stage("piv", nullptr);
}

}  // namespace

StepQuality quality_of(const VectorField& field) {
  StepQuality q;
  std::size_t asked = 0, valid = 0;
  std::vector<double> scores, others, shifts;
  for (std::size_t n = 0; n < field.status.size(); ++n) {
    if (field.status[n] == VectorStatus::masked) continue;
    ++asked;
    const bool good = field.status[n] == VectorStatus::valid;
    if (std::isfinite(field.score[n])) (good ? scores : others).push_back(double(field.score[n]));
    if (!good) continue;
    ++valid;
    shifts.push_back(std::hypot(double(field.displacement[n][0]), double(field.displacement[n][1])) /
                     field.grid.spacing.x());
  }
  q.valid = asked > 0 ? double(valid) / double(asked) : 0;
  q.median_score = median(std::move(scores.empty() ? others : scores));  // air, of which there may be more than material, has a score of chance
  q.median_shift = median(std::move(shifts));
  return q;
}

std::vector<Remark> measure(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer, int threads,
             Progress& progress, FrameLooks* looks) {
  const io::StageState done = writer.stage("piv");
  if (done.complete) return {};
  const int frames = int(source.frames().size());
  piv::NodeLattice lattice = node_lattice(setting);
  const piv::PivOptions options = c.piv.value_or(piv::PivOptions{});
  const bool moves = !setting.cameras.empty();
  if (in_twos(c)) {
    measure_twos(c, setting, source, writer, int(done.items), threads, progress);
    return {};
  }
  if (options.ensemble > 1) {
    std::vector<Remark> remarks = measure_means(c, setting, source, writer, int(done.items), threads, progress, looks);
    writer.end_stage("piv", nullptr);
    return remarks;
  }
  piv::SequenceCorrelator correlator(options, lattice, setting.width, setting.height, threads);
  // Pairs are smoothed in groups: those of a group that was begun are measured again, with the same bits.
  const int first_pair = int(done.items);
  const int group = piv::SequenceCorrelator::group_for(options, lattice.pixel.size(), setting.width, setting.height);
  int from = first_pair - first_pair % group;
  std::vector<double> times;
  for (const Frame& frame : source.frames()) times.push_back(frame.time);
  std::optional<RowClock> rows;  // of each pair it asks those beside it, so that the group before is measured again too
  if (c.camera.row_time_s != 0) rows.emplace(c.camera.row_time_s, setting, source.frames());
  if (rows) from = std::max(0, from - group);
  MovingRegions regions(setting, options.window_px, options.follow_regions && !c.regions.empty(), c.camera.row_time_s, std::move(times));
  // Rows are brought to one time once the next pair is known: when a group begins, the last pair before it is not kept yet.
  const bool late = rows && from > 0;
  for (int k = 0; regions.any() && k < from - late; ++k) regions.keep(writer.pair(std::size_t(k)));
  regions.begin_group(late);
  if (regions.any() && late) regions.keep(writer.pair(std::size_t(from - 1)));
  const auto keep = [&](const VectorField& field) {
    if (field.pair[0] < first_pair) {
      if (regions.any()) regions.keep(writer.pair(std::size_t(field.pair[0])));  // a neighbour that is not measured again counts there
      return;
    }
    regions.keep(field);
    writer.add_pair(field);
    if (writer.segment_full("piv")) writer.close_segment("piv", {});
  };
  Image before;
  image::Mask mask_before;
  const bool moving = !setting.moving_masks.empty();
  if (first_pair + 1 < frames) before = source.read(from);
  if (!before.empty()) look_at(before, from, looks);
  if (moving && !before.empty()) mask_before = mask_of(setting, from, before.view());
  if (!before.empty()) before = prepared(setting, std::move(before));
  for (int k = from; first_pair + 1 < frames && k + 1 < frames; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    Image after = source.read(k + 1);
    look_at(after, k + 1, looks);
    const auto camera = moves ? camera_step(setting, {k, k + 1}, options.anchor) : piv::CameraStep{};
    image::Mask mask_after = moving ? mask_of(setting, k + 1, after.view()) : image::Mask();
    after = prepared(setting, std::move(after));
    const image::Mask mask = moving ? image::both(mask_before, mask_after) : image::Mask();
    const auto add = [&](const MaskView& material) {
      correlator.add(before.view(), after.view(), moving ? mask.view() : setting.mask.view(), moves ? &camera : nullptr, material);
    };
    regions.look(k, before.view(), after.view());
    add(regions.mask());
    if (regions.any()) {
      const piv::NodeLattice nodes = moves ? node_lattice(setting, {k, k + 1}, options.anchor) : lattice;
      const auto own = [&] { return world_vectors(correlator.last(), nodes, setting, {k, k + 1}); };
      if (regions.revise(own(), before.view(), after.view())) {
        correlator.drop_last();
        add(regions.mask());
      }
      regions.carry(own());
    }
    mask_before = std::move(mask_after);
    before = std::move(after);
    progress.update("PIV", k + 1, frames - 1);
    if (correlator.held() < group && k + 2 < frames) continue;
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
    regions.begin_group(rows.has_value());
  }
  if (rows)
    for (const VectorField& ready : rows->finish()) keep(ready);
  writer.end_stage("piv", nullptr);
  return regions.remarks();
}

VectorField measure_pair(const Case& c, const Setting& setting, image::FrameSource& source, std::array<int, 2> pair,
                         int threads, MaterialMasks* material) {
  const piv::PivOptions options = c.piv.value_or(piv::PivOptions{});
  const piv::NodeLattice lattice = node_lattice(setting, pair, options.anchor);
  piv::PairCorrelator correlator(options, lattice, setting.width, setting.height, threads);
  Image first = source.read(pair[0]), second = source.read(pair[1]);
  const image::Mask mask = setting.moving_masks.empty()
                               ? setting.mask
                               : image::both(mask_of(setting, pair[0], first.view()), mask_of(setting, pair[1], second.view()));
  first = prepared(setting, std::move(first));
  second = prepared(setting, std::move(second));
  const std::vector<std::uint8_t> of_first = material ? material->of(pair, first.view(), second.view()) : std::vector<std::uint8_t>{};
  const MaskView there = of_first.empty() ? MaskView{} : MaskView{of_first.data(), setting.width, setting.height, setting.width};
  VectorField field = world_vectors(correlator.correlate(first.view(), second.view(), mask.view(), there), lattice, setting, pair);
  if (c.camera.row_time_s == 0) return field;
  return RowClock(c.camera.row_time_s, setting, source.frames()).alone(field);
}

std::vector<std::uint8_t> step_flags(const std::vector<StepQuality>& pairs) {
  std::vector<double> valid, score;
  for (const StepQuality& q : pairs) {
    if (q.same) continue;
    valid.push_back(q.valid);
    score.push_back(q.median_score);
  }
  const std::vector<std::uint8_t> holds = held(pairs);
  const double usual_valid = median(valid), usual_score = median(score);
  constexpr double still = 0.01;  // spacings: less is no motion to compare
  constexpr double noisy_score = 0.999, same_exposure = 0.99999;
  std::vector<std::uint8_t> flags(pairs.size(), frame_ok);
  std::vector<double> scatters;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (const Expected e = expected_step(pairs, k, still); std::isfinite(e.scatter)) scatters.push_back(e.scatter);
  const double usual_scatter = median(std::move(scatters));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const StepQuality& q = pairs[k];
    if (q.same || (!holds.empty() && holds[k])) {
      flags[k] |= frame_repeated;
      continue;
    }
    if (q.lost() || q.valid < 0.5 * usual_valid || q.median_score < 0.6 * usual_score) {
      flags[k] |= frame_decorrelated;
      continue;
    }
    // Of two exposures the noise differs, however slow the test; where it does not, they are one.
    if (usual_score < noisy_score && q.median_score > same_exposure) {
      flags[k] |= frame_repeated;
      continue;
    }
    if (usual_score < noisy_score && compressed_anew(pairs, k)) {
      flags[k] |= frame_repeated;
      continue;
    }
    if (k == 0 || k + 1 == pairs.size()) continue;
    const double before = pairs[k - 1].median_shift, after = pairs[k + 1].median_shift, mean = (before + after) / 2;
    if (mean < still) continue;
    if (std::abs(after - before) > 0.25 * mean || !(q.along > 0.5)) {  // an unsteady test
      const Expected e = expected_step(pairs, k, still);
      if (std::log(q.median_shift) - e.log_shift > std::max(std::log(1.5), 4 * std::max(e.scatter, usual_scatter)))
        flags[k] |= frame_jump;
      continue;
    }
    const bool scored = usual_score > 0;  // imported vectors may have no scores
    if (q.median_shift < 0.05 * mean && (!scored || same_noise(q, unlikeness_about(pairs, k))))
      flags[k] |= frame_repeated;
    else if (std::abs(q.median_shift - mean) > 0.5 * mean)
      flags[k] |= frame_jump;
  }
  return flags;
}

FrameLook look_of(const ImageView& frame) {
  const double white = double(frame.white);
  FrameLook look = frame.depth == PixelDepth::u8    ? looked_at<std::uint8_t>(frame, 255)
                   : frame.depth == PixelDepth::u16 ? looked_at<std::uint16_t>(frame, white)
                                                    : looked_at<float>(frame, white);
  look.digest = digest_of(frame);
  return look;
}

std::vector<std::uint8_t> flash_flags(const std::vector<FrameLook>& looks) {
  constexpr std::size_t most = 3;  // frames in a row
  constexpr double least = 0.1, scatters = 6, mad_to_deviation = 1.48, more_saturated = 0.02;
  std::vector<std::uint8_t> flags(looks.size(), frame_ok);
  const auto ratio = [&](std::size_t a, std::size_t b) {
    return std::abs(std::log(std::max(looks[a].mean, 1e-6) / std::max(looks[b].mean, 1e-6)));
  };
  std::vector<double> steps;
  for (std::size_t k = 1; k < looks.size(); ++k) steps.push_back(ratio(k, k - 1));
  const double differs = std::max(least, scatters * mad_to_deviation * median(steps));
  const auto unlike = [&](std::size_t a, std::size_t b) {
    return ratio(a, b) > differs || looks[a].saturated > looks[b].saturated + more_saturated;
  };
  for (std::size_t k = 1; k + 1 < looks.size(); ++k) {
    if (!unlike(k, k - 1)) continue;
    for (std::size_t end = k + 1; end <= k + most && end < looks.size(); ++end) {
      if (!unlike(end - 1, end) || unlike(end, k - 1) || unlike(k - 1, end)) continue;
      for (std::size_t n = k; n < end; ++n) flags[n] = frame_flash;
      k = end - 1;
      break;
    }
  }
  return flags;
}

std::vector<FrameLook> all_looks(image::FrameSource& source, const FrameLooks& looks) {
  std::vector<FrameLook> all;
  for (std::size_t k = 0; k < looks.size(); ++k) all.push_back(looks[k] ? *looks[k] : look_of(source.read(int(k)).view()));
  return all;
}

std::vector<Frame> flagged_frames(std::vector<Frame> frames, const io::RecordWriter& writer,
                                  const std::vector<FrameLook>& looks) {
  std::vector<double> times;
  std::vector<std::size_t> seconds;  // frames
  std::vector<StepQuality> pairs;
  VectorField before, here;
  for (std::size_t k = 0, second = 0; second + 1 < frames.size(); ++k) {
    VectorField after = writer.pair(k);
    const auto first = std::size_t(after.pair[0]);
    second = std::size_t(after.pair[1]);
    times.push_back(frames[second].time - frames[first].time);
    seconds.push_back(second);
    pairs.push_back(quality_of(after));
    if (!looks.empty()) pairs[k].same = looks[first].digest == looks[second].digest;
    if (k >= 2) pairs[k - 1].along = cosine(before, after);
    before = std::move(here);
    here = std::move(after);
  }
  const double usual_time = median(times);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (times[k] != usual_time) pairs[k].median_shift *= usual_time / times[k];
  const std::vector<std::uint8_t> flags = step_flags(pairs), flashes = flash_flags(looks);
  for (std::size_t k = 0; k < flags.size(); ++k) frames[seconds[k]].flag |= flags[k];
  for (std::size_t k = 0; k < flashes.size(); ++k) frames[k].flag |= flashes[k];
  return frames;
}

}  // namespace pivnp::app

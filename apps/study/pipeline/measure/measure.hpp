// The PIV stage: frames through the correlator, vectors to the world, pair by pair into the record.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

class MaterialMasks;

/// Pairs are two exposures each (frames.pairs = "double"), else each frame with the next.
inline bool in_twos(const Case& c) { return c.frames && c.frames->pairs == image::FramePairs::twos; }
inline std::size_t pairs_among(const Case& c, std::size_t frames) { return in_twos(c) ? frames / 2 : frames - 1; }

/// What one pair's vectors say of the pair as a whole.
struct StepQuality {
  double valid = 0;         // share of the vectors asked for (not masked) that are valid
  double median_score = 0;  // of the valid; of all that have one where none is
  double median_shift = 0;  // of |displacement| over the valid, grid spacings
  double along = 1;         // cosine between the steps before and after, over the nodes valid in both; 1: not known
  bool same = false;        // its frames are equal to the last bit

  /// Less than a tenth is valid, and what scores there are are those of chance.
  bool lost() const { return valid == 0 || (valid < 0.1 && median_score < 0.5); }
};
StepQuality quality_of(const VectorField& field);

/// How bright a frame is as a whole, shares of white, of every fourth pixel of every fourth row; and a digest of all.
struct FrameLook {
  double mean = 0, saturated = 0;
  std::uint64_t digest = 0;
};
FrameLook look_of(const ImageView& frame);
using FrameLooks = std::vector<std::optional<FrameLook>>;

/// Flash: frames, at most three in a row, that are brighter or darker than those before and after them, which agree:
/// the mean by more than a tenth and six times the sequence's usual scatter, or by a fiftieth more saturated pixels.
std::vector<std::uint8_t> flash_flags(const std::vector<FrameLook>& looks);
/// All looks; reads the frames that were not looked at (of a run that was taken up again).
std::vector<FrameLook> all_looks(image::FrameSource& source, const FrameLooks& looks);

/// Measures every pair that `writer` does not hold yet; two frames and the fields of a group of pairs are in memory.
/// Regions of the case go along as masks (moving_regions.hpp). Returns remarks on them.
std::vector<Remark> measure(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer, int threads,
             Progress& progress, FrameLooks* looks = nullptr);

/// The vectors of one pair of frames, `pair` = (first, second), any distance apart. `material`: regions as masks of it; null: none.
VectorField measure_pair(const Case& c, const Setting& setting, image::FrameSource& source, std::array<int, 2> pair,
                         int threads, MaterialMasks* material = nullptr);

/// Flags of each pair, from the quality of all pairs in order.
/// Decorrelated: StepQuality::lost(), or less than half the usual share of vectors is valid, or their median score is
/// below 0.6 of the usual. Repeated: the frames are equal to the last bit; or they are one exposure compressed anew,
/// that is, they differ (1 - score) by less than a third of what the steps about them do, so that they share their
/// noise, and they hardly move where those steps, in one direction, do; of a recording that holds each frame several
/// times, by less than a third of what the steps between the holds do. Jump: the steps before and after agree (within a
/// quarter, and in direction), this one differs from their mean by more than half of it, as where a frame is missing;
/// or, where they do not agree, it is longer by half than two steps before and two after say (their logarithms, linear
/// in time), and by four times what is usual in the sequence.
std::vector<std::uint8_t> step_flags(const std::vector<StepQuality>& pairs);

/// The frames with their flags, a pair's at its second; steps are compared as speeds, by the times of the frames. `looks`: of all frames; empty
/// where there are none, as of imported vectors.
std::vector<Frame> flagged_frames(std::vector<Frame> frames, const io::RecordWriter& writer,
                                  const std::vector<FrameLook>& looks = {});

}  // namespace pivnp::app

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

/// What one pair's vectors say of the pair as a whole.
struct StepQuality {
  double valid = 0;         // share of the vectors asked for (not masked) that are valid
  double median_score = 0;  // of the valid; of all that have one where none is
  double median_shift = 0;  // of |displacement| over the valid, grid spacings
};
StepQuality quality_of(const VectorField& field);

/// How bright a frame is as a whole, shares of white; of every fourth pixel of every fourth row.
struct FrameLook {
  double mean = 0, saturated = 0;
};
FrameLook look_of(const ImageView& frame);
using FrameLooks = std::vector<std::optional<FrameLook>>;

/// Flash: frames, at most three in a row, that are brighter or darker than those before and after them, which agree:
/// the mean by more than a tenth and six times the sequence's usual scatter, or by a fiftieth more saturated pixels.
std::vector<std::uint8_t> flash_flags(const std::vector<FrameLook>& looks);
/// The same into `frames`; reads the frames that were not looked at (of a run that was taken up again).
void flag_flashes(image::FrameSource& source, const FrameLooks& looks, std::vector<Frame>& frames);

/// Measures every pair that `writer` does not hold yet; two frames and the fields of a group of pairs are in memory.
/// Regions of the case go along as masks (moving_regions.hpp). Returns remarks on them.
std::vector<std::string> measure(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer, int threads,
             Progress& progress, FrameLooks* looks = nullptr);

/// The vectors of one pair of frames, `pair` = (first, second), any distance apart. `material`: regions as masks of it; null: none.
VectorField measure_pair(const Case& c, const Setting& setting, image::FrameSource& source, std::array<int, 2> pair,
                         int threads, MaterialMasks* material = nullptr);

/// Flags of the step that ends at each frame but the first, from the quality of all pairs in order. Decorrelated: less
/// than half the usual share of vectors is valid, or their median score is below 0.6 of the usual. Jump: the steps
/// before and after agree (within a quarter), this one differs from their mean by more than half of it, as where a
/// frame is missing; or, where they do not agree, it differs by half from what two steps before and two after say
/// (their logarithms, linear in time), and by four times what is usual in the sequence. Repeated: such a step that
/// hardly moves; or, in slow and unsteady tests too, one whose frames agree to the last grey value (median score above
/// .99999) although others do not (usual score below .999); or one that moves by less than half of each of its
/// neighbours, and whose frames differ by less than a third of what two steps before and two after do: the same
/// exposure, compressed anew.
std::vector<std::uint8_t> step_flags(const std::vector<StepQuality>& pairs);

/// The frames with their flags.
std::vector<Frame> flagged_frames(std::vector<Frame> frames, const io::RecordWriter& writer);

}  // namespace pivnp::app

// Frames in: image sequences and video files, one grey channel each.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/core/record/frames.hpp"
#include "pivnp/core/record/remark.hpp"

namespace pivnp::image {

/// Where the times of frames come from: they are evenly spaced, or the container's time stamps say when each was taken.
enum class FrameTimes { even, stamps };
inline constexpr std::array frame_times_names{NamedValue{"even", FrameTimes::even},
                                              NamedValue{"stamps", FrameTimes::stamps}};
constexpr const auto& names_of(FrameTimes) { return frame_times_names; }

/// Which frames make a pair: each with the next, or two and two, the exposures of a double-frame camera.
enum class FramePairs { sequence, twos };
inline constexpr std::array frame_pairs_names{NamedValue{"sequence", FramePairs::sequence},
                                              NamedValue{"double", FramePairs::twos}};
constexpr const auto& names_of(FramePairs) { return frame_pairs_names; }

struct FrameOptions {
  std::string path = {};
  std::optional<double> rate_hz = {};
  FrameTimes times = FrameTimes::even;
  FramePairs pairs = FramePairs::sequence;
  std::optional<double> pair_time_s = {};
  int first = 0;
  std::optional<int> last = {};
  int stride = 1;
  double least_motion_px = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("path", self.path,
          OptionInfo{.text = "glob (frames/*.png), printf pattern (img_%04d.tif), folder or video, relative to the case file"});
    visit("rate_hz", self.rate_hz,
          OptionInfo{.unit = "Hz", .text = "frames per second; default: what a video states",
                     .min = 0, .above_min = true});
    visit("times", self.times,
          OptionInfo{.text = "even: by rate_hz; stamps: by the time stamps of a video of variable rate"});
    visit("pairs", self.pairs,
          OptionInfo{.text = "sequence: each frame with the next; double: two and two, the exposures of a double-frame "
                             "camera, whose pairs rate_hz then counts"});
    visit("pair_time_s", self.pair_time_s,
          OptionInfo{.unit = "s", .text = "double: time between the two exposures of a pair (with rate_hz)",
                     .min = 0, .above_min = true});
    visit("first", self.first, OptionInfo{.text = "first frame used, counted from 0", .min = 0});
    visit("last", self.last, OptionInfo{.text = "last frame used; default: all", .min = 0});
    visit("stride", self.stride, OptionInfo{.text = "use every n-th frame", .min = 1});
    visit(
        "least_motion_px", self.least_motion_px,
        OptionInfo{
            .unit = "px",
            .text =
                "skip frames until a tenth of the material has moved so far (0: none)",
            .min = 0,
            .max = 50});
  }
};

/// A sequence of frames of one size. Reading goes forward fastest; a video read backwards seeks.
/// Not thread-safe: one thread reads.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Frames after first, last and stride. `flag` is not filled in. Time starts at 0 at the first frame used, in s where
  /// a rate is known (rate_hz, else the container's), else in frames of the original sequence.
  virtual const std::vector<Frame>& frames() const = 0;
  virtual bool has_rate() const = 0;
  virtual int width() const = 0;
  virtual int height() const = 0;
  /// What the frames are read from: one file each in their order, one video, or nothing (frames made in memory).
  virtual std::vector<std::filesystem::path> files() const { return {}; }
  /// What is to be known of how the frames are read: their order, gaps, grey values that are lost.
  virtual std::vector<Remark> remarks() const { return {}; }
  /// Grey image of frame `index` (colour: ITU-R BT.601 luma). 16-bit files stay u16. Throws InputError naming the file
  /// if it is missing, truncated, unreadable, or differs in size or depth from the first.
  virtual Image read(int index) = 0;
};

/// Opens what `options.path` names, relative to `base`: a folder (all its images), a video file, one image, a printf
/// pattern with one %d or %0Nd in the file name, or a glob (* ? [..]). What exists under that very name wins over a
/// pattern's meaning, and brackets that match nothing as a glob are tried as they stand. In the order of
/// the numbers in the names, signs and decimals included (files/frame_order.hpp); names may hold spaces. A printf sequence starts at the least number found.
/// `first`, `last` and `stride` count original frames from 0. Only the first frame used is decoded here; a video is
/// run through once to count what can truly be read.
/// Images: 8 or 16 bit, grey or colour (alpha ignored), or floating point within 0..1. Pixels as stored: orientation
/// tags are not obeyed. A 16-bit image has white = 65535 whatever the camera's depth, but for PGM, which names its own.
/// Throws InputError: nothing matches, fewer than one frame after first/last/stride, `last` beyond the end, unreadable
/// first frame, a used frame missing from a printf sequence, a video that ends before its container's count, a video
/// of variable rate with neither rate_hz nor times = "stamps", stamps that do not increase, stamps asked of images.
std::unique_ptr<FrameSource> open_frames(const FrameOptions& options, const std::filesystem::path& base);

/// Reads the next frame in the background while the one before is worked on, as long as reading goes forward. Holds at
/// most one frame beside those handed out. What a background read throws is thrown by the read() that asks for the
/// frame.
std::unique_ptr<FrameSource> prefetched(std::unique_ptr<FrameSource> source);

}  // namespace pivnp::image

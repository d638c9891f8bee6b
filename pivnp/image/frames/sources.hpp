// The kinds of frame source behind open_frames().
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/image/files/frame_files.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::image {

inline const std::string frames_key = "frames";  // what messages about frames begin with

/// Original frame numbers chosen by first, last and stride out of `count`. Throws InputError if none is left.
std::vector<int> chosen_frames(const FrameOptions& options, std::int64_t count, const std::string& path);

/// Time of the frame used as number `index`, `steps` original frames after the first one used; without a rate (0) in frames.
double frame_time(const FrameOptions& options, double rate_hz, std::size_t index, double steps);

/// `base` is what names are relative to when the files lie in several folders.
std::unique_ptr<FrameSource> image_sequence(const FrameOptions& options, const FrameFiles& files,
                                            const std::filesystem::path& base);
/// What shows that a video's file was cut off ("truncated: ..."): the boxes of MP4 and MOV, the length of AVI's RIFF,
/// GIF's trailer. Other containers pass.
std::optional<std::string> video_defect(const std::filesystem::path& file);
std::unique_ptr<FrameSource> video_source(const FrameOptions& options, const std::filesystem::path& file);

}  // namespace pivnp::image

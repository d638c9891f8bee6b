#include "pivnp/image/frames/frames.hpp"

#include <cmath>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "pivnp/image/frames/sources.hpp"

namespace pivnp::image {

namespace fs = std::filesystem;

namespace {

const std::string path_key = "frames.path";

void check_twos(const FrameOptions& options) {
  const std::string found = "found together with frames.pairs = \"double\", whose pairs are fixed; expected ";
  if (options.stride != 1) throw InputError("frames.stride: " + found + "1");
  if (options.least_motion_px > 0) throw InputError("frames.least_motion_px: " + found + "0");
  if (options.times == FrameTimes::stamps) throw InputError("frames.times: " + found + "\"even\"");
  if (options.rate_hz.has_value() != options.pair_time_s.has_value())
    throw InputError(std::string(options.rate_hz ? "frames.pair_time_s" : "frames.rate_hz") +
                     ": missing; with frames.pairs = \"double\" expected both rate_hz, pairs a second, and pair_time_s, between a pair's exposures");
  if (options.rate_hz && !(*options.pair_time_s > 0 && *options.pair_time_s * *options.rate_hz < 1))
    throw InputError("frames.pair_time_s: found " + std::to_string(*options.pair_time_s) + " s, expected more than 0 and less than 1/rate_hz, the time between pairs");
}

void check_options(const FrameOptions& options) {
  if (options.path.empty())
    throw InputError(path_key + ": nothing given; expected a glob, a printf pattern, a folder or a video file");
  if (options.rate_hz && !(*options.rate_hz > 0 && std::isfinite(*options.rate_hz)))
    throw InputError("frames.rate_hz: found " + std::to_string(*options.rate_hz) + ", expected a number above 0");
  if (options.times == FrameTimes::stamps && options.rate_hz)
    throw InputError("frames.rate_hz: given together with frames.times = \"stamps\"; expected one of them");
  if (options.first < 0)
    throw InputError("frames.first: found " + std::to_string(options.first) + ", expected 0 or more");
  if (options.stride < 1)
    throw InputError("frames.stride: found " + std::to_string(options.stride) + ", expected 1 or more");
  if (options.pairs == FramePairs::twos) check_twos(options);
  else if (options.pair_time_s) throw InputError("frames.pair_time_s: given, but frames.pairs is not \"double\"");
  if (options.last && *options.last < options.first)
    throw InputError("frames.last: found " + std::to_string(*options.last) + ", expected frames.first (" +
                     std::to_string(options.first) + ") or more");
}

std::unique_ptr<FrameSource> open_file(const FrameOptions& options, const fs::path& file, const fs::path& base) {
  std::error_code error;
  if (!fs::is_regular_file(file, error))  // a pipe would wait for its writer
    throw InputError(path_key + ": '" + file.string() + "' is not a file");
  if (fs::file_size(file, error) == 0)
    throw InputError(path_key + ": '" + file.string() + "' is empty: the file has 0 bytes");
  if (looks_like_image(file)) return image_sequence(options, FrameFiles{{{0, file}}}, base);
  return video_source(options, file);
}

}  // namespace

std::vector<int> chosen_frames(const FrameOptions& options, std::int64_t count, const std::string& path) {
  const std::string has = "'" + path + "' has " + std::to_string(count) + (count == 1 ? " frame" : " frames") +
                          ", 0 to " + std::to_string(count - 1);
  if (count > std::numeric_limits<int>::max() / 2) throw InputError(path_key + ": " + has + ": too many");
  if (options.first >= count) throw InputError("frames.first: found " + std::to_string(options.first) + ", but " + has);
  if (options.last && *options.last >= count)
    throw InputError("frames.last: found " + std::to_string(*options.last) + ", but " + has);
  const int last = options.last.value_or(int(count) - 1);
  std::vector<int> out;
  for (std::int64_t k = options.first; k <= last; k += options.stride) out.push_back(int(k));
  if (options.pairs == FramePairs::twos && out.size() % 2 != 0)
    throw InputError("frames.pairs: found " + std::to_string(out.size()) + " frames in '" + path +
                     "', expected an even number, two exposures a pair (\"double\")");
  return out;
}

double frame_time(const FrameOptions& options, double rate_hz, std::size_t index, double steps) {
  if (!(rate_hz > 0)) return steps;
  if (options.pairs == FramePairs::sequence) return steps / rate_hz;
  const bool second = index % 2 != 0;
  return 0.5 * (steps - double(second)) / rate_hz + (second ? *options.pair_time_s : 0.0);
}

std::unique_ptr<FrameSource> open_frames(const FrameOptions& options, const fs::path& base) {
  check_options(options);
  const fs::path given(options.path);
  const fs::path path = (base / given).lexically_normal();
  std::error_code error;
  if (fs::is_directory(path, error)) return image_sequence(options, files_in_folder(path, path_key), base);
  if (fs::exists(path, error)) return open_file(options, path, base);
  if (const auto numbered = NumberedName::parse(path.filename().string(), path_key))
    return image_sequence(options, files_of_pattern(path.parent_path(), *numbered, path_key), base);
  const FrameFiles files = files_of_glob(base, options.path, path_key);
  if (files.files.size() == 1) return open_file(options, files.files.front().path, base);
  return image_sequence(options, files, base);
}

}  // namespace pivnp::image

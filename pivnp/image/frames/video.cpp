// Frames out of a video file.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "pivnp/image/frames/filter.hpp"
#include "pivnp/image/frames/sources.hpp"

namespace pivnp::image {

namespace fs = std::filesystem;

namespace {

struct Header {
  char bytes[4096] = {};
  std::size_t size = 0;

  explicit Header(const fs::path& file) {
    std::ifstream in = open_regular_file(file, frames_key + ": '" + file.string() + "'");
    in.read(bytes, sizeof bytes);
    size = std::size_t(in.gcount());
  }
  // FFmpeg draws text files as a terminal would; no video's beginning is without a zero byte.
  bool is_text() const { return std::memchr(bytes, 0, size) == nullptr; }
  // MP4, MOV and AVI list their frames; elsewhere the number is guessed from duration and rate.
  bool counts_frames() const {
    return size > 12 && (is_mp4() || std::memcmp(bytes, "RIFF", 4) == 0);
  }
  bool is_mp4() const { return size > 12 && std::memcmp(bytes + 4, "ftyp", 4) == 0; }
};

cv::VideoCapture opened(const fs::path& file) {
  silence_vendor_messages();
  cv::VideoCapture capture;
  try {
    if (!Header(file).is_text()) capture.open(fs::absolute(file).string(), cv::CAP_FFMPEG);
  } catch (const cv::Exception&) {
    capture.release();
  }
  if (!capture.isOpened())
    throw InputError(frames_key + ": '" + file.string() + "' cannot be opened as a video or an image (another kind of file, "
                     "or truncated)");
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);  // pixels as stored
  return capture;
}

// Bits of a grey value, or of a colour's, as far as the tag of FFmpeg's raw formats tells ("Y1", 0, 16 is grey of 16).
int stored_bits(const cv::VideoCapture& capture) {
  const auto tag = std::uint32_t(std::int64_t(capture.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT)));
  const char first = char(tag & 0xFF);
  const int last = int(tag >> 24);
  if (first == 'Y' || first == 'G') return last > 8 && last <= 16 ? last : 8;
  return (first == 'R' || first == 'B') && (last == 48 || last == 64) ? 16 : 8;
}

std::size_t different_values(const Image& image) {
  std::array<bool, 256> there{};
  for (int r = 0; r < image.height(); ++r)
    for (int c = 0; c < image.width(); ++c) there[image.view().row<std::uint8_t>(r)[c]] = true;
  return std::size_t(std::count(there.begin(), there.end(), true));
}

// What one pass through the file finds.
struct Survey {
  std::int64_t promised = 0;  // the container's claim, 0: none
  std::int64_t readable = 0;  // frames that came out, up to the limit asked for
  double rate_hz = 0;         // the container's claim, 0: none
  std::vector<double> stamps_s;
};

Survey surveyed(const fs::path& file, std::int64_t limit) {
  cv::VideoCapture capture = opened(file);
  Survey survey;
  const double promised = capture.get(cv::CAP_PROP_FRAME_COUNT), rate = capture.get(cv::CAP_PROP_FPS);
  if (promised > 0 && promised < 1e15) survey.promised = std::int64_t(promised);
  if (rate > 0 && std::isfinite(rate)) survey.rate_hz = rate;
  while (survey.readable < limit && capture.grab()) {
    survey.stamps_s.push_back(capture.get(cv::CAP_PROP_POS_MSEC) / 1000);
    ++survey.readable;
  }
  return survey;
}

// Stamps that the decoder handed out: of the frames that it still held at the file's end it gives none (0).
std::size_t stamped_frames(const Survey& survey) {
  std::size_t end = survey.stamps_s.size();
  while (end > 1 && survey.stamps_s[end - 1] == 0) --end;
  return end;
}

// Where the rate varies, frames of the container's rate up to the last stamp: the promise is a duration times that rate, and an AVI
// counts what it leaves out.
std::int64_t reached(const Survey& survey) {
  const std::size_t known = stamped_frames(survey);
  if (survey.rate_hz == 0 || known < 2) return survey.readable;
  const double frames = (survey.stamps_s[known - 1] - survey.stamps_s[0]) * survey.rate_hz;
  if (!(frames >= 0 && frames < 1e15)) return survey.readable;
  return std::max(survey.readable, std::int64_t(std::llround(frames)) + 1 + std::int64_t(survey.stamps_s.size() - known));
}

// Throws if the file ends before its container says so; the last frame that came out may then be damaged too.
void check_complete(const Survey& survey, const fs::path& file, std::int64_t limit) {
  if (survey.readable == 0) {
    const auto defect = video_defect(file);
    throw InputError(frames_key + ": '" + file.string() + "' is a video without a readable frame" + (defect ? ", " + *defect : ""));
  }
  if (survey.readable == limit) return;
  const Header header(file);
  const double slack = header.counts_frames() ? 0 : std::max(2.0, 0.1 * survey.rate_hz);  // where the promise is a guess
  const std::int64_t missing = survey.promised > 0 ? survey.promised - (header.is_mp4() ? survey.readable : reached(survey)) : 0;
  std::string remedy;
  if (survey.readable > 1)
    remedy = "; frames.last = " + std::to_string(survey.readable - 2) + " leaves out the damaged end";
  if (double(missing) <= slack) {
    if (const auto defect = video_defect(file))
      throw InputError(frames_key + ": '" + file.string() + "' is " + *defect + remedy);
    return;
  }
  throw InputError(frames_key + ": '" + file.string() + "' ends too early: its container promises " +
                   std::to_string(survey.promised) + " frames, only " + std::to_string(survey.readable) +
                   " can be read (truncated, or trimmed without re-encoding)" + remedy);
}

// Throws unless the time stamps of the frames before `end` increase from frame to frame.
void check_stamps(const Survey& survey, std::size_t end, const fs::path& file) {
  const std::string asked = "frames.times: found \"stamps\", but in '" + file.string() + "' ";
  const std::size_t known = stamped_frames(survey);
  for (std::size_t k = 1; k < std::min(end, known); ++k)
    if (!(survey.stamps_s[k] > survey.stamps_s[k - 1]))
      throw InputError(asked + "frame " + std::to_string(k) + " is stamped " + std::to_string(survey.stamps_s[k]) + " s and the one before it " +
                       std::to_string(survey.stamps_s[k - 1]) + " s; expected stamps that increase, or frames.rate_hz");
  if (known < end)
    throw InputError(asked + "the last " + std::to_string(end - known) + " of " + std::to_string(end) +
                     " frames come without a stamp, as the decoder held them back at the file's end; frames.last = " +
                     std::to_string(known - 1) + " leaves them out, or expected frames.rate_hz");
}

// Throws if the container's own time stamps are not those of its rate: frames were dropped, or the rate varies.
void check_rate(const Survey& survey, const fs::path& file) {
  const std::vector<double>& t = survey.stamps_s;
  const std::size_t end = stamped_frames(survey);
  if (survey.rate_hz == 0 || end < 3 || !std::is_sorted(t.begin(), t.begin() + std::ptrdiff_t(end))) return;
  const double step = (t[end - 1] - t[0]) / double(end - 1);
  if (!(step > 0)) return;
  const std::string remedy =
      "; frames.times = \"stamps\" takes the stamps, frames.rate_hz overrides them if the frames are evenly spaced all "
      "the same";
  if (std::abs(step * survey.rate_hz - 1) > 0.01 + 0.5 / double(end))
    throw InputError(frames_key + ": '" + file.string() + "' claims " + std::to_string(survey.rate_hz) +
                     " frames per second, its time stamps say " + std::to_string(1 / step) + remedy);
  for (std::size_t k = 0; k < end; ++k)
    if (std::abs(t[k] - t[0] - double(k) * step) > 0.5 * step + 0.0015)  // stamps may be rounded to 1 ms
      throw InputError(frames_key + ": '" + file.string() + "' has no constant frame rate: frame " + std::to_string(k) +
                       " is stamped " + std::to_string(t[k] - t[0]) + " s, expected " +
                       std::to_string(double(k) * step) + " s" + remedy);
}

// Goes through the file in order only: seeking by frame number is not exact in files that store differences between
// frames. Going back starts the file again, and where it goes back by one frame the frames before that are kept, as it
// will go on so.
class VideoSource final : public FrameSource {
 public:
  VideoSource(fs::path file, std::vector<int> numbers, std::vector<Frame> frames, bool has_rate)
      : file_(std::move(file)), numbers_(std::move(numbers)), frames_(std::move(frames)), has_rate_(has_rate) {
    const Image first = read(0);
    width_ = first.width();
    height_ = first.height();
    const int bits = stored_bits(capture_), turn = int(std::lround(capture_.get(cv::CAP_PROP_ORIENTATION_META)));
    if (bits > 8)
      remarks_.push_back({"The video holds grey values of " + std::to_string(bits) + " bits, but its decoder gives 8: " +
                         std::to_string(different_values(first)) + " different ones are left in the first frame. Export the "
                         "frames as 16-bit images (ffmpeg -i " + file_.filename().string() + " frame_%05d.png).",
                          RemarkWeight::doubt});
    if (turn % 360 != 0)
      remarks_.push_back({"The video asks players to turn it by " + std::to_string(turn) +
                         " degrees; the frames are taken as they are stored, not turned."});
  }

  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return has_rate_; }
  int width() const override { return width_; }
  int height() const override { return height_; }
  std::vector<fs::path> files() const override { return {file_}; }
  std::vector<Remark> remarks() const override { return remarks_; }

  Image read(int index) override {
    const int number = numbers_.at(std::size_t(index));
    if (const auto kept = kept_.find(number); kept != kept_.end()) {
      last_ = index;
      return part_of(kept->second.view(), 0, 0, width_, height_);
    }
    const bool backwards = index + 1 == last_;
    last_ = index;
    kept_.clear();
    if (backwards) keep_before(index);
    go_to(number, index);
    return decoded(index);
  }

 private:
  // Decodes the frames used before `index`, as many as fit the memory that is set aside for them, and keeps them.
  void keep_before(int index) {
    constexpr std::size_t memory = std::size_t(128) << 20;
    const int most = int(memory / (std::size_t(width_) * std::size_t(height_)));
    for (int k = std::max(0, index - most); k < index; ++k) {
      go_to(numbers_[std::size_t(k)], k);
      kept_.emplace(numbers_[std::size_t(k)], decoded(k));
    }
  }

  // The frame that the decoder has in its hands.
  Image decoded(int index) {
    const std::string& name = frames_[std::size_t(index)].name;
    const std::string place = frames_key + ": '" + (file_.parent_path() / name).string() + "'";
    cv::Mat colour;
    if (!capture_.retrieve(colour) || colour.empty()) throw InputError(place + " cannot be decoded");
    if (colour.depth() != CV_8U) throw InputError(place + " is not an 8-bit frame");
    if (width_ > 0 && (colour.cols != width_ || colour.rows != height_))
      throw InputError(place + " is " + describe(colour.cols, colour.rows, PixelDepth::u8) + ", but the first frame '" +
                       frames_.front().name + "' is " + describe(width_, height_, PixelDepth::u8));
    Image out(colour.cols, colour.rows, PixelDepth::u8, 255.0f);
    cv::Mat grey(colour.rows, colour.cols, CV_8U, out.row<unsigned char>(0));
    if (colour.channels() == 1) colour.copyTo(grey);
    else cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    return out;
  }

  // Leaves the decoder with original frame `number` in its hands.
  void go_to(int number, int index) {
    if (at_ < 0 || number < at_) {
      capture_ = opened(file_);
      at_ = -1;
    }
    for (; at_ < number; ++at_)
      if (!capture_.grab()) {
        const int failed = at_ + 1;
        at_ = -1;
        throw InputError(frames_key + ": '" + file_.string() + "' ends at frame " + std::to_string(failed) + " before '" +
                         frames_[std::size_t(index)].name + "'; was it changed while it was read?");
      }
  }

  fs::path file_;
  std::vector<int> numbers_;  // original frames
  std::vector<Frame> frames_;
  bool has_rate_;
  std::vector<Remark> remarks_;
  int width_ = 0, height_ = 0;
  cv::VideoCapture capture_;
  int at_ = -1;  // original frame that was grabbed last
  int last_ = -1;              // index read last
  std::map<int, Image> kept_;  // by original frame, while reading goes backwards
};

}  // namespace

std::unique_ptr<FrameSource> video_source(const FrameOptions& options, const fs::path& file) {
  // One more than needed, so that the frame used last is known not to be the torn end of the file.
  const std::int64_t limit =
      options.last ? std::int64_t(*options.last) + 2 : std::numeric_limits<std::int64_t>::max();
  const Survey survey = surveyed(file, limit);
  check_complete(survey, file, limit);
  const std::vector<int> numbers = chosen_frames(options, survey.readable, file.string());
  const bool stamped = options.times == FrameTimes::stamps;
  if (stamped)
    check_stamps(survey, std::size_t(numbers.back()) + 1, file);
  else if (!options.rate_hz)
    check_rate(survey, file);
  // A container's rate says nothing of the time between two exposures of a pair.
  const double rate = options.rate_hz.value_or(options.pairs == FramePairs::sequence ? survey.rate_hz : 0);
  std::vector<Frame> frames;
  for (const int number : numbers) {
    const double steps = number - options.first;
    const std::string name = file.filename().string() + "#" + std::to_string(number);
    const double stamp = survey.stamps_s[std::size_t(number)] - survey.stamps_s[std::size_t(options.first)];
    frames.push_back({name, stamped ? stamp : frame_time(options, rate, frames.size(), steps), frame_ok});
  }
  return std::make_unique<VideoSource>(file, numbers, std::move(frames), stamped || rate > 0);
}

}  // namespace pivnp::image

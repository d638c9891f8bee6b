#include "apps/cli/terminal_progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>

#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr double redraw_s = 0.1, line_every_s = 5.0;
constexpr int bar_cells = 24;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string bar(std::int64_t done, std::int64_t total) {
  const int full = int(std::clamp<std::int64_t>(done * bar_cells / total, 0, bar_cells));
  std::string text = "[";
  text.append(std::size_t(full), '#').append(std::size_t(bar_cells - full), '.');
  return text.append("] ");
}

std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

TerminalProgress::TerminalProgress(std::ostream& out, ProgressStyle style, std::function<bool()> stop,
                                   std::function<double()> clock)
    : out_(out), style_(style), stop_(std::move(stop)), clock_(clock ? std::move(clock) : steady_seconds) {}

TerminalProgress::~TerminalProgress() { end_line(); }

void TerminalProgress::begin(std::string_view stage, std::int64_t done, double now) {
  end_line();
  if (!ended_ && stage != stage_) interrupted_[stage_] = {first_, done_, began_};
  stage_ = stage;
  first_ = done;
  began_ = now;
  // One that goes on after a stage within it keeps its clock.
  if (const auto before = interrupted_.find(stage); before != interrupted_.end()) {
    if (done >= before->second.done) first_ = before->second.first, began_ = before->second.began;
    interrupted_.erase(before);
  }
  shown_ = -1e300;
  ended_ = false;
  if (style_ == ProgressStyle::lines) shown_ = now;
}

void TerminalProgress::update(std::string_view stage, std::int64_t done, std::int64_t total) {
  if (style_ == ProgressStyle::silent) return;
  const double now = clock_();
  if (stage != stage_ || done < done_ || (ended_ && done < total)) begin(stage, done, now);
  if (ended_) return;  // said again that it is done
  done_ = done;
  total_ = total;
  const bool end = total > 0 && done >= total;
  if (!end && now - shown_ < (style_ == ProgressStyle::bar ? redraw_s : line_every_s)) return;
  shown_ = now;
  if (style_ == ProgressStyle::bar) {
    std::string line = text(now);
    const std::size_t columns = terminal_columns();
    if (line.size() >= columns) line.resize(columns - 1);  // a wrapped line could not be drawn over
    out_ << "\r\x1b[K" << line << std::flush;
    line_open_ = true;
  } else {
    out_ << text(now) << std::endl;
  }
  if (end) {
    end_line();
    ended_ = true;
  }
}

std::string TerminalProgress::text(double now) const {
  std::string line = stage_ + " ";
  if (total_ <= 0) return line + std::to_string(done_);
  if (style_ == ProgressStyle::bar) line += bar(done_, total_);
  line += std::to_string(done_) + "/" + std::to_string(total_);
  const double seconds = now - began_;
  if (done_ >= total_) return line + ", done in " + duration_text(seconds);
  const double rate = double(done_ - first_) / seconds;
  if (!(seconds > 0) || !(rate > 0)) return line;
  return line + ", " + number(rate, 3) + "/s, " + duration_text(double(total_ - done_) / rate) + " left";
}

void TerminalProgress::end_line() {
  if (line_open_) out_ << std::endl;
  line_open_ = false;
}

std::string duration_text(double seconds) {
  if (seconds < 10) return number(std::round(std::max(0.0, seconds) * 10) / 10, 3) + " s";
  const auto whole = std::int64_t(std::lround(std::min(seconds, 1e9)));
  auto two = [](std::int64_t n) { return std::string(n < 10 ? "0" : "").append(std::to_string(n)); };
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + two(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + two(whole / 60 % 60) + " min";
}

}  // namespace pivnp::app

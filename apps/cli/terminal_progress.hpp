// Progress for people: one line with bar, rate and time left on a terminal, plain lines elsewhere.
#pragma once

#include <functional>
#include <map>
#include <iosfwd>
#include <string>

#include "pivnp/core/progress.hpp"

namespace pivnp::app {

enum class ProgressStyle {
  silent,
  bar,    // a terminal: one line, drawn over
  lines,  // a file or a pipe: a line every 5 s and at a stage's end
};

class TerminalProgress final : public Progress {
 public:
  /// `clock` counts seconds from any start; empty: the steady clock. `stop` tells whether the user asked to stop.
  TerminalProgress(std::ostream& out, ProgressStyle style, std::function<bool()> stop,
                   std::function<double()> clock = {});
  ~TerminalProgress() override;  // ends a line that was begun

  void update(std::string_view stage, std::int64_t done, std::int64_t total) override;
  bool stop_requested() const override { return stop_(); }

  /// Ends a line that was begun, so that other text can follow.
  void end_line();

 private:
  void begin(std::string_view stage, std::int64_t done, double now);
  std::string text(double now) const;

  std::ostream& out_;
  ProgressStyle style_;
  std::function<bool()> stop_;
  std::function<double()> clock_;
  std::string stage_;
  struct Interrupted {  // by a stage within it
    std::int64_t first, done;
    double began;
  };
  std::map<std::string, Interrupted, std::less<>> interrupted_;
  std::int64_t first_ = 0;  // done when the stage began: a resumed stage begins in the middle
  std::int64_t done_ = 0, total_ = 0;
  double began_ = 0, shown_ = 0;
  bool line_open_ = false, ended_ = true;
};

/// "45 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);

}  // namespace pivnp::app

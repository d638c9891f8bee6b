// How long work reports how far it is, and learns that it should stop.
#pragma once

#include <cstdint>
#include <string_view>

namespace pivnp {

class Progress {
 public:
  virtual ~Progress() = default;
  /// `done` of `total` units (pairs, steps, frames) of `stage` are finished. Called from one thread only.
  virtual void update(std::string_view stage, std::int64_t done, std::int64_t total) = 0;
  /// True once the user asked to stop. Engines check it between units and throw Interrupted.
  virtual bool stop_requested() const = 0;
};

/// Reports nothing, never stops: for tests and library use.
class SilentProgress final : public Progress {
 public:
  void update(std::string_view, std::int64_t, std::int64_t) override {}
  bool stop_requested() const override { return false; }
};

}  // namespace pivnp

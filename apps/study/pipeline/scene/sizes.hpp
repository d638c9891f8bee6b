// How large a case is, computed before anything of that size is allocated or begun.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/scene.hpp"

namespace pivnp::app {

/// Most of each that a case may come to. (Indices of nodes and particles have 32 bits; a step takes some 0.1 ms at
/// least.)
constexpr double most_nodes = 1 << 26, most_particles = 1 << 26, most_blobs = 1 << 26;
constexpr double most_steps = 1e9, most_states = 1e7;

/// Counts are numbers, not indices: they may be beyond what an index can hold.
struct CaseSize {
  double nodes = 0, particles = 0;         // of the measured grid; numerical particles
  double simulated_nodes = 0, points = 0;  // of the simulation
  double steps = 0, states = 0;            // about; states written
  bool steps_at_most = false;              // fewer where the run finds that pressure is better projected
  double memory_bytes = 0;                 // about
  double record_bytes = 0;                 // what the states take on the disk while the run goes on
};

/// Throws InputError "KEY: found VALUE, which makes COUNT WHAT, expected at most MOST" if there are more.
void require_at_most(double count, double most, const std::string& what, const std::string& key,
                     const std::string& value);

/// The key that a case gives the grid's spacing by, and its value as the case has it.
struct GivenSpacing {
  std::string key, value;
};
GivenSpacing given_spacing(const Case& c);

/// Before frames are drawn: their pixels, bytes and blobs.
void require_drawable(const SynthOptions& synth, const image::TextureOptions& texture);

/// Throws InputError, naming the key, where any count is beyond its most, or the memory beyond the machine's. `frames`:
/// how many there are; `end_s`: time of the last one.
CaseSize size_of(const Case& c, const Setting& setting, std::size_t frames, double end_s);

/// Throws InputError, naming the key, if the states do not fit on the disk of `folder` (which exists).
void require_room(const Case& c, const CaseSize& size, const std::filesystem::path& folder);

/// One sentence.
std::string text_of(const CaseSize& size);

}  // namespace pivnp::app

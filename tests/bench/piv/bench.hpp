// What the parts of the program piv_table share: its options, and the methods to be measured.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::bench {

/// A method with the options that differ from their defaults, as on the command line: "fft:window_px=16:passes=2".
struct Setting {
  std::string name;
  piv::PivOptions options;
};

struct BenchOptions {
  int side = 1024, spacing = 8, margin = 48, threads = 1, repeats = 3;
  std::vector<int> seeds = {101};
  std::vector<Setting> settings;
  std::vector<std::string> rows;  // parts of names, "^" before: their start, "$" behind: their end; empty: all
  image::TextureOptions texture;
  bool more = false;
  bool cpu_clock = false;  // the process's time instead of the wall's: one thread on a machine that has other work
  std::string csv;         // file; empty: none

  /// Other textures and blobs than the table's: a factor on what is asked.
  double slack() const;
  void print_head() const;
};

std::string machine();

/// The value of that name; throws InputError.
template <Choice E>
E choice(const std::string& place, const std::string& name) {
  if (const std::optional<E> value = value_named<E>(name)) return *value;
  std::string list;
  for (const std::string& known : choice_names<E>()) list += (list.empty() ? "" : ", ") + known;
  throw InputError(place + ": found '" + name + "', expected one of " + list);
}

/// Throws InputError.
Setting parse_setting(const std::string& text, const piv::PivOptions& base);

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Seconds of the clock that was asked for.
double now(const BenchOptions& options);

/// Each returns the program's exit code: 0, or 3 where something asked of method "default" was missed.
int table(const BenchOptions& options);
int map(const BenchOptions& options);
int outliers(const BenchOptions& options);
int real(const BenchOptions& options);
int speed(const BenchOptions& options);
int stages(const BenchOptions& options);
int subsets(const BenchOptions& options);

}  // namespace pivnp::bench

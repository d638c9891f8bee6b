// The options of a case as plain rows, made from their lists: for the reference, for hints and for the commented case.
#pragma once

#include <string>
#include <vector>

namespace pivnp::app {

struct KeyRow {
  std::string key;
  std::string type;  // "a whole number"
  std::string unit;
  std::string fallback;  // default as TOML; empty: none
  std::string allowed;   // range or choices; empty: any
  std::string text;
  std::string schema;    // JSON schema of its value, without braces
};

struct SectionRow {
  enum class Kind { always, optional, named };
  std::string path;  // "synth.mpm"
  Kind kind;
  std::string text;
  std::vector<KeyRow> keys;
};

/// All sections of a case in the order in which it is written.
std::vector<SectionRow> case_sections();

/// Names of the sections directly under `path` ("" : the top level).
std::vector<std::string> child_sections(const std::string& path);

/// The sections that know `key`, as "[piv]"; for hints.
std::vector<std::string> sections_with_key(const std::string& key);

}  // namespace pivnp::app

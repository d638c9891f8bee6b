// docs/case.md: made from the option lists, with a worked example that a test reads.
#include <algorithm>
#include <string_view>
#include <utility>

#include "apps/case/case.hpp"
#include "apps/case/listing.hpp"

namespace pivnp::app {

namespace {

constexpr const char* introduction = R"(# The case file

<!-- Generated from the option lists in the sources: cmake --build build/release --target case_reference -->

Every key that a case may have. A case is one [TOML](https://toml.io) file, or a folder with a `case.toml`. `pivnp init
FRAMES` writes one to begin with; `pivnp check CASE` validates it and draws its first frame with grid, masks and regions.

## A worked example

A sand slope behind a gate, measured, simulated and compared:

```toml
)";

constexpr const char* example = R"(name = "sand slope, 1 g"

[frames]
path = "frames/*.png"            # quoted; relative to this file
rate_hz = 50.0

[camera]
metres_per_pixel = 2.0e-4
origin_px = [0.0, 1079.0]        # the pixel of the world's (0, 0)

[grid]
spacing_px = 16

[region.sand]                    # where the sand is at the first frame
polygon_m = [[0.0, 0.0], [0.33, 0.0], [0.186, 0.25], [0.0, 0.25]]

[mask.label]                     # a label on the glass that does not move
polygon_px = [[1700, 20], [1880, 20], [1880, 90], [1700, 90]]

[piv]
window_px = 32

[np]
per_element = 4

[material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1545.0
young_pa = 30e6
poisson = 0.3
friction_deg = 43.0
dilatancy_deg = 10.0

[mpm]
per_element = 4

[boundary.base]
line_m = [[0.0, 0.0], [0.6, 0.0]]
type = "fixed"

[boundary.back]
line_m = [[0.0, 0.0], [0.0, 0.3]]
type = "roller"

[boundary.gate]
line_m = [[0.33, 0.0], [0.186, 0.25]]
type = "roller"
until_s = 0.001                  # withdrawn at once

[compare.limits]
displacement_rms_m = 0.005
)";

constexpr const char* rules = R"(```

## Rules

- Keys carry their unit. Whole numbers may stand where numbers are wanted, not the reverse; `nan` and `inf` are refused.
  An unknown key is an error that names its line and the nearest known name.
- The record keeps the case with every default filled in.
- World: x to the right, y upward. Pixels: (column, row), row downward, centres on whole numbers. Outlines must not
  cross themselves.
- Without `camera.metres_per_pixel` and targets lengths are in pixels (`_m` then means px); without a rate times are in
  frames.
- With `camera.length_unit = "mm"` (cm, km, um) every length (unit m or m/px) is in millimetres; other units, and files
  whose columns name theirs, stay. Record, limits and report are in metres.
- Histories and CSV files are linear between their rows, then constant (motions: at rest); changes (`_from_s`, `_until_s`)
  are linear.
- Paths are relative to the case file; `--frames PATH`, relative to the current folder, wins.
- Without `[mpm]` a case only measures. Without `[frames]` and `[synth]` it only simulates and needs `mpm.end_s`,
  `mpm.output_rate_hz` and `grid.spacing_m`.

In brackets: what a value may be, its unit, and the default. Of `[x.NAME]` there may be any number, NAME is yours.

## Top level

- `name` (string): title of the case; default: the name of its folder
)";

std::string in_signs(std::string range) {
  constexpr std::pair<std::string_view, std::string_view> signs[] = {
      {"more than", ">"}, {"at least", "≥"}, {"less than", "<"}, {"at most", "≤"}};
  for (const auto& [words, sign] : signs)
    if (const std::size_t at = range.find(words); at != std::string::npos) range.replace(at, words.size(), sign);
  return range;
}

// What a value may be: its choices, or range or type, and unit; then the default.
std::string value(const KeyRow& row) {
  const std::string fallback = row.fallback.empty() ? "" : "`" + row.fallback + "`";
  std::string text = in_signs(row.allowed);
  if (row.type == "true or false" && !fallback.empty()) return fallback;
  if (row.type == "a whole number" && !text.empty()) text.insert(0, "whole ");
  if (text.empty() || row.type.find('[') != std::string::npos || row.type.find("list") != std::string::npos) {
    text = row.type.substr(row.type.starts_with("a ") ? 2 : 0);
    if (const std::size_t form = text.find('['); form != std::string::npos) text.erase(0, form);
  }
  if (!row.unit.empty()) text.append(", ").append(row.unit);
  return fallback.empty() ? text : text.append("; ").append(fallback);
}

const char* presence(SectionRow::Kind kind) { return kind == SectionRow::Kind::optional ? "Optional. " : ""; }

std::string heading(const SectionRow& section) {
  return section.path + (section.kind == SectionRow::Kind::named ? ".NAME" : "");
}

// The section before this one that has the same keys.
const SectionRow* mirrored(const std::vector<SectionRow>& sections, const SectionRow& section) {
  for (const SectionRow& other : sections) {
    if (&other == &section) break;
    if (std::equal(other.keys.begin(), other.keys.end(), section.keys.begin(), section.keys.end(),
                   [](const KeyRow& a, const KeyRow& b) { return a.key == b.key && a.text == b.text; }))
      return &other;
  }
  return nullptr;
}

}  // namespace

std::string case_reference() {
  std::string text = std::string(introduction) + example + rules;
  const std::vector<SectionRow> sections = case_sections();
  for (const SectionRow& section : sections) {
    text += "\n## [" + heading(section) + "]\n\n" + presence(section.kind) + section.text + "\n\n";
    if (const SectionRow* other = mirrored(sections, section)) {
      text += "Keys: those of [" + heading(*other) + "].\n";
      continue;
    }
    for (const KeyRow& row : section.keys)
      text.append("- `").append(row.key).append("` (").append(value(row)).append("): ").append(row.text).append("\n");
  }
  return text;
}

}  // namespace pivnp::app

// docs/case.md: made from the option lists, with a worked example that a test reads.
#include "apps/case/case.hpp"
#include "apps/case/listing.hpp"

namespace pivnp::app {

namespace {

constexpr const char* introduction = R"(# The case file

<!-- Generated from the option lists in the sources: cmake --build build/release --target case_reference -->

A case is one [TOML](https://toml.io) file. `pivnp check CASE` validates it and draws its first frame with grid, masks
and regions; `pivnp init FRAMES` writes a commented one to begin with. CASE is a file, or a folder with a `case.toml`.

## A worked example

A sand slope behind a gate, filmed at 50 frames a second, measured, simulated and compared:

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

- Keys carry their unit. A whole number is accepted where a number is wanted, not the reverse; `nan` and `inf` are
  refused. An unknown section or key is an error that names its line and the nearest known name.
- What is left out is chosen; the record keeps the case with every default filled in.
- The world has x to the right and y upward. Pixels are (column, row), row downward, pixel centres on whole numbers.
- Without `camera.metres_per_pixel` and without targets the world is measured in pixels: every `_m` then means px, with
  y upward from the origin.
- `camera.length_unit = "mm"` (cm, km, um): every length (unit m or m/px below) is given in millimetres. Other keys keep
  their units (m/s, m/s^2, kg/m^3, Pa/m), and so do files whose columns name theirs. The case is read into metres; record,
  limits and report are in metres. Any other name is a length of the scene.
- Without a known rate times are counted in frames.
- Points are pairs of numbers: `[[x, y], [x, y], ...]`. Outlines must not cross themselves; either sense will do.
- Relative paths are relative to the case file; `--frames PATH` on the command line, relative to the current folder,
  wins over `frames.path`.
- A region is made of the material it names, or of the one that bears its own name.
- Without `[mpm]` a case measures only. Without `[frames]` and `[synth]` it simulates only: then `mpm.end_s`,
  `mpm.output_rate_hz` and `grid.spacing_m` must be given.
- `compare.limits` are checked at the end of a run: one that is exceeded gives exit code 3.

## Top level

| key | type | default | meaning |
|---|---|---|---|
| `name` | a string | the name of the case's folder | title of the case |
)";

std::string cell(const std::string& text) {  // a | would end the cell
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

std::string code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

const char* presence(SectionRow::Kind kind) {
  if (kind == SectionRow::Kind::optional) return "Optional section. ";
  if (kind == SectionRow::Kind::named) return "Any number of sections, each with a NAME of your choice. ";
  return "";
}

}  // namespace

std::string case_reference() {
  std::string text = std::string(introduction) + example + rules;
  for (const SectionRow& section : case_sections()) {
    const bool named = section.kind == SectionRow::Kind::named;
    text +=
        "\n## [" + section.path + (named ? ".NAME]" : "]") + "\n\n" + presence(section.kind) + section.text + "\n\n";
    text += "| key | type | unit | default | allowed | meaning |\n|---|---|---|---|---|---|\n";
    for (const KeyRow& row : section.keys)
      text += "| `" + row.key + "` | " + row.type + " | " + row.unit + " | " + code(cell(row.fallback)) + " | " +
              cell(row.allowed) + " | " + cell(row.text) + " |\n";
  }
  return text;
}

}  // namespace pivnp::app

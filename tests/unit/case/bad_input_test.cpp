// Bad input: each message is one line that names file, line and key, what was found and what was expected. The words
// are the contract here, so they are held to the letter.
#include <filesystem>
#include <fstream>
#include <string>

#include "mpm/material/options.hpp"
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

TEST(BadInput, UnknownKeyNamesTheNearest) {
  EXPECT_EQ(refusal("[frames]\npath = 'a'\n\n[piv]\nwindow = 32\n"),
            "c.toml:5: unknown key 'piv.window'; did you mean 'window_px'?");
  EXPECT_EQ(refusal("[compare.limits]\ndisplacment_rms_m = 1\n"),
            "c.toml:2: unknown key 'compare.limits.displacment_rms_m'; did you mean 'displacement_rms_m'?");
  EXPECT_EQ(refusal("nmae = 'x'\n"), "c.toml:1: unknown key 'nmae'; did you mean 'name'?");
  EXPECT_EQ(refusal("[region.sand]\npolygon = [[0,0],[1,0],[1,1]]\n"),
            "c.toml:2: unknown key 'region.sand.polygon'; did you mean 'polygon_m'?");
}

TEST(BadInput, UnknownKeyFarFromAllListsTheKnownOnes) {
  EXPECT_EQ(refusal("[output]\ncompression_level = 3\n"),
            "c.toml:2: unknown key 'output.compression_level'; known: fields");
}

TEST(BadInput, KeyInTheWrongSectionIsSentToItsOwn) {
  EXPECT_EQ(refusal("young_pa = 3e6\n"),
            "c.toml:1: unknown key 'young_pa'; it belongs to [material.NAME] or [synth.material.NAME]");
  EXPECT_EQ(refusal("[mpm]\nwindow_px = 32\n"), "c.toml:2: unknown key 'mpm.window_px'; it belongs to [piv]");
}

TEST(BadInput, AllUnknownKeysOfASectionAreNamed) {
  EXPECT_EQ(refusal("[piv]\nwindow = 32\nzzzzzz = 1\nmethod = 'fft'\nyoung_pa = 2\n"),
            "c.toml:2: unknown key 'piv.window'; did you mean 'window_px'?; line 3: unknown key 'piv.zzzzzz'; line 5: unknown "
            "key 'piv.young_pa'; it belongs to [material.NAME] or [synth.material.NAME]");
  std::string many = "[output]\n";
  for (int k = 0; k < 1000; ++k) many += "unknown_" + std::to_string(k) + " = 1\n";
  const std::string line = refusal(many);
  EXPECT_NE(line.find("unknown_9'"), line.npos);
  EXPECT_NE(line.find("; and 990 more"), line.npos);
  EXPECT_LT(line.size(), 1000u);
}

TEST(BadInput, AllErrorsOfACaseAreToldAtOnce) {
  EXPECT_EQ(refusal("[frames]\npath = 'a'\nrate_hz = -2\n[piv]\nwindw_px = 24\nmethod = 3\n[region.a]\npolygon_m = [[0, 0], [1]]\n"),
            "c.toml:3: frames.rate_hz: found -2, expected more than 0 (Hz); line 5: unknown key 'piv.windw_px'; did you mean 'window_px'?; "
            "line 6: piv.method: found 3, expected a string; line 8: region.a.polygon_m: found a list of 1, expected a list of points [[x, y], ...] (m)");
  // What only the whole case shows.
  const std::string line = refusal("[frames]\npath = 'a'\nfirst = 5\nlast = 3\n[grid]\nspacing_px = 4\nspacing_m = 1e-3\n[output]\nfields = ['strain_dve']\n");
  EXPECT_EQ(line.rfind("c.toml:4: frames.last: found 3", 0), 0u) << line;
  for (const char* part : {"; line 7: grid.spacing_m", "; line 9: output.fields"}) EXPECT_NE(line.find(part), line.npos) << part << line;
}

TEST(BadInput, UnknownSections) {
  EXPECT_EQ(refusal("[pivv]\nwindow_px = 32\n"), "c.toml:1: unknown section [pivv]; did you mean 'piv'?");
  EXPECT_EQ(refusal("[synth.textures]\nbits = 8\n"),
            "c.toml:1: unknown section [synth.textures]; did you mean 'texture'?");
  EXPECT_EQ(refusal("[np.fine]\nx = 1\n").rfind("c.toml:1: unknown section [np.fine]; known: ", 0), 0u);
}

TEST(BadInput, LinesOfTheReport) {
  const std::string frames = "[frames]\npath = 'a'\n";
  EXPECT_EQ(refusal(frames + "[report.line.crest]\nfrom_m = [0, 1]\nto_m = [1, 1]\n"), "");
  EXPECT_EQ(refusal(frames + "[report.line.crest]\nfrom_m = [0, 1]\n"), "c.toml:3: [report.line.crest]: to_m: missing, expected [x, y]");
  EXPECT_EQ(refusal(frames + "[report.line.crest]\nfrom_m = [0, 1]\nto_m = [0, 1]\n"),
            "c.toml:5: report.line.crest.to_m: found from_m again, expected another point");
  EXPECT_EQ(refusal(frames + "[report.line.\"a/b\"]\nfrom_m = [0, 1]\nto_m = [1, 1]\n").rfind("c.toml:3: [report.line.", 0), 0u);
  EXPECT_EQ(refusal(frames + "[report.line.crest]\nfrom_m = [0, 1]\nto_m = [1, 1]\nfield = 'strain_dve'\n").rfind("c.toml:6: report.line.crest.field: ", 0), 0u);
}

TEST(BadInput, WaterGoesWithPores) {
  const std::string soil = "[mpm]\nend_s = 1\noutput_rate_hz = 1\n[grid]\nspacing_m = 0.1\n[region.a]\npolygon_m = [[0,0],[1,0],[1,1]]\n"
                           "[material.a]\nmodel = 'linear_elastic'\nyoung_pa = 1e6\n", given = ": given without [water], expected both or neither";
  const std::string wet = soil + "porosity = 0.3\npermeability_m_s = 1e-5\n", dry = soil + "density_kg_m3 = 1800\n";
  EXPECT_EQ(refusal(wet + "[water]\nlevel_m = 1.0\n"), "");
  EXPECT_EQ(refusal(wet), "c.toml:11: material.a.porosity" + given);
  EXPECT_EQ(refusal(dry + "[boundary.b]\nline_m = [[0,0],[1,0]]\nflux_m_s = 1\n"), "c.toml:14: boundary.b.flux_m_s" + given);
  EXPECT_EQ(refusal(soil + "porosity = 1.3\n[water]\n"), "c.toml:11: material.a.porosity: found 1.3, expected more than 0 and less than 1");
  EXPECT_EQ(refusal(soil + "porosity = 1.0\n[water]\n"), "c.toml:11: material.a.porosity: found 1.0, expected more than 0 and less than 1");
  EXPECT_EQ(refusal(wet + "grain_density_kg_m3 = 500\n[water]\n"),
            "c.toml:13: material.a.grain_density_kg_m3: found 500, expected more than water.density_kg_m3, 1000 (lighter grains float)");
  EXPECT_EQ(refusal("[mpm]\nend_s = 1\n[material.a]\nmodel = 'water'\nbulk_pa = 1e6\nyoung_pa = 1e6\ndensity_kg_m3 = 1000\n"),
            "c.toml:6: material.a.young_pa: given with model \"water\", expected none: its stiffness is that of its other keys");
  EXPECT_EQ(refusal(soil + "porosity = 0.3\n[water]\n"),
            "c.toml:8: material.a.permeability_m_s: missing beside porosity; expected 0 or more (m/s), or drained = true");
  EXPECT_EQ(refusal(wet + "density_kg_m3 = 1800\n[water]\n"),
            "c.toml:13: material.a.density_kg_m3: found 1800, expected none beside porosity: the density follows from grain_density_kg_m3 and the water");
  EXPECT_EQ(refusal("[mpm]\npressure = 'implicit'\n"), "c.toml:2: mpm.pressure: found \"implicit\", expected one of explicit, projected; did you mean 'explicit'?");
}

TEST(BadInput, SectionsThatAreNone) {
  EXPECT_EQ(refusal("piv = 3\n"), "c.toml:1: piv: found 3, expected a section [piv]");
  EXPECT_EQ(
      refusal("[region]\npolygon_m = [[0,0],[1,0],[1,1]]\n"),
      "c.toml:2: region.polygon_m: found a list of 3, expected a section [region.NAME] with a name of your choice");
  EXPECT_EQ(refusal("[[mask]]\nimage = 'x'\n"),
            "c.toml:1: mask: found a list of 1, expected a section [mask.NAME] with a name of your choice");
  EXPECT_EQ(refusal("[region.\"\"]\nmaterial = 'x'\n"), "c.toml:1: [region.\"\"]: the name is empty");
}

TEST(BadInput, WrongTypesSayFoundAndExpected) {
  EXPECT_EQ(refusal("[piv]\nwindow_px = \"32\"\n"),
            "c.toml:2: piv.window_px: found a string \"32\", expected a whole number (px)");
  EXPECT_EQ(refusal("[piv]\nwindow_px = 32.0\n"), "c.toml:2: piv.window_px: found 32.0, expected a whole number (px)");
  EXPECT_EQ(refusal("[piv]\nreplace = 1\n"), "c.toml:2: piv.replace: found 1, expected true or false");
  EXPECT_EQ(refusal("[frames]\npath = 3\n"), "c.toml:2: frames.path: found 3, expected a string");
  EXPECT_EQ(refusal("[frames]\npath = ['a']\n"), "c.toml:2: frames.path: found a list of 1, expected a string");
  EXPECT_EQ(refusal("[frames]\nrate_hz = true\n"), "c.toml:2: frames.rate_hz: found true, expected a number (Hz)");
  EXPECT_EQ(refusal("[frames]\nrate_hz = 07:32:00\n"),
            "c.toml:2: frames.rate_hz: found a date or time, expected a number (Hz)");
  EXPECT_EQ(refusal("[frames.rate_hz]\n"), "c.toml:1: frames.rate_hz: found a section, expected a number (Hz)");
  EXPECT_EQ(refusal("[camera]\norigin_px = [1, 2, 3]\n"),
            "c.toml:2: camera.origin_px: found a list of 3, expected two numbers [x, y] (px)");
  EXPECT_EQ(refusal("[camera]\norigin_px = 1\n"),
            "c.toml:2: camera.origin_px: found 1, expected two numbers [x, y] (px)");
  EXPECT_EQ(refusal("[region.a]\npolygon_m = [1, 2]\n"),
            "c.toml:2: region.a.polygon_m: found 1, expected a list of points [[x, y], ...] (m)");
  EXPECT_EQ(refusal("[report]\ntimes_s = [0.1, 'end']\n"),
            "c.toml:2: report.times_s: found a string \"end\", expected a list of numbers (s)");
  EXPECT_EQ(refusal("[output]\nfields = ['strain_dev', 3]\n"),
            "c.toml:2: output.fields: found 3, expected a list of strings");
}

TEST(BadInput, InsideALongListTheLineIsTheItems) {
  EXPECT_EQ(refusal("[region.a]\npolygon_m = [\n  [0, 0],\n  [1, 0],\n  [1, \"1\"],\n]\n"),
            "c.toml:5: region.a.polygon_m: found a string \"1\", expected a list of points [[x, y], ...] (m)");
}

TEST(BadInput, OutOfRange) {
  EXPECT_EQ(refusal("[piv]\nwindow_px = 4\n"), "c.toml:2: piv.window_px: found 4, expected 8 to 256 (px)");
  EXPECT_EQ(refusal("[piv]\nwindow_px = 99999999999\n"),
            "c.toml:2: piv.window_px: found 99999999999, expected 8 to 256 (px)");
  EXPECT_EQ(refusal("[frames]\nfirst = -1\n"), "c.toml:2: frames.first: found -1, expected at least 0");
  EXPECT_EQ(refusal("[frames]\nfirst = 4000000000\n"),
            "c.toml:2: frames.first: found 4000000000, expected at most 2147483647");
  EXPECT_EQ(refusal("[frames]\nrate_hz = 0\n"), "c.toml:2: frames.rate_hz: found 0, expected more than 0 (Hz)");
  EXPECT_EQ(refusal("[mpm]\ncourant = 1.5\n"), "c.toml:2: mpm.courant: found 1.5, expected more than 0 and at most 1");
}

TEST(BadInput, NegativeConstants) {
  EXPECT_EQ(refusal("[material.a]\ndensity_kg_m3 = -1500.0\n"),
            "c.toml:2: material.a.density_kg_m3: found -1500.0, expected more than 0 (kg/m^3)");
  EXPECT_EQ(refusal("[material.a]\nyoung_pa = -1\n"),
            "c.toml:2: material.a.young_pa: found -1, expected more than 0 (Pa)");
  EXPECT_EQ(refusal("[material.a]\ncohesion_pa = -1\n"),
            "c.toml:2: material.a.cohesion_pa: found -1, expected at least 0 (Pa)");
}

TEST(BadInput, NanAndInfinityAreRefused) {
  EXPECT_EQ(refusal("[frames]\nrate_hz = nan\n"), "c.toml:2: frames.rate_hz: found nan, expected a finite number (Hz)");
  EXPECT_EQ(refusal("[frames]\nrate_hz = inf\n"), "c.toml:2: frames.rate_hz: found inf, expected a finite number (Hz)");
  EXPECT_EQ(refusal("[camera]\norigin_px = [0, -inf]\n"),
            "c.toml:2: camera.origin_px: found -inf, expected a finite number (px)");
}

TEST(BadInput, UnknownChoiceNamesTheNearest) {
  EXPECT_EQ(refusal("[np]\nseeding = 'evem'\n"),
            "c.toml:2: np.seeding: found \"evem\", expected one of even, gauss; did you mean 'even'?");
  std::string laws;
  for (const std::string& name : mpm::material_model_names()) laws += (laws.empty() ? "" : ", ") + name;
  EXPECT_EQ(refusal("[material.a]\nmodel = 'hypoplastic'\n"),
            "c.toml:2: material.a.model: found \"hypoplastic\", expected one of " + laws);
}

TEST(BadInput, SyntaxErrorsAndDuplicatesNameTheLine) {
  EXPECT_EQ(refusal("name = 'x'\n[piv]\nwindow_px = \n").rfind("c.toml:3: ", 0), 0u);
  EXPECT_EQ(refusal("[piv]\nwindow_px = 32\nwindow_px = 64\n").rfind("c.toml:3: ", 0), 0u);
  EXPECT_EQ(refusal("[piv]\nwindow_px = 32\n[np]\n[piv]\n").rfind("c.toml:4: ", 0), 0u);
  EXPECT_EQ(refusal("name = \"a\xff\"\n").rfind("c.toml:1: ", 0), 0u);
  EXPECT_EQ(refusal("name = \"unclosed\n[piv]\n").rfind("c.toml:1: ", 0), 0u);
}

TEST(BadInput, DeepKeysAndLists) {
  const auto repeated = [](const std::string& part, int count) {
    std::string text;
    for (int k = 0; k < count; ++k) text += part;
    return text;
  };
  for (const std::string part : {"a.", "a . ", "\"a\".", "'#'."})
    for (const std::string before : {"name = 'x'\n", "name = '''\n'a\n'''\n",
                                     R"(name = "\"" # ')"
                                     "\n",
                                     "x = {", "#\n["}) {
      const std::string said = refusal(before + repeated(part, 20000) + "b = 1\n");
      EXPECT_EQ(said.rfind("c.toml:", 0), 0u) << part << before;
      EXPECT_LT(said.size(), 300u);
    }
  EXPECT_EQ(refusal("x = " + repeated("[", 20000) + repeated("]", 20000) + "\n").rfind("c.toml:1: ", 0), 0u);
  // Elsewhere dots and brackets are what they are.
  const std::string dots = repeated("a.[", 500);
  for (const std::string& text :
       {"# " + dots, "name = \"" + dots + "\"", "name = '" + dots + "'", "name = '''\n" + dots + "'''"})
    EXPECT_EQ(refusal(text + "\n" + changed("name = \"slope\"", "")), "") << text;
}

TEST(BadInput, WhatDoesNotPrintIsNoName) {
  EXPECT_EQ(refusal("name = \"a\\u001b[2J\"\n"), "c.toml:1: name: found a string \"a\\u001b[2J\", expected text without control characters");
  const std::string unit = "[camera]\nmetres_per_pixel = 0.01\nlength_unit = \"m";
  EXPECT_EQ(refusal(unit + "\\u0000\"\n").rfind("c.toml:3: camera.length_unit: found a string \"m", 0), 0u);
  for (const char* turned : {"\\u202e", "\\u2066", "\\u2028", "\\u009b", "\\u007f", "\\n"})
    EXPECT_NE(refusal(unit + turned + "\"\n"), "") << turned;
  EXPECT_EQ(refusal(unit + "\u00b5\u2026\"\n"), "");
  EXPECT_EQ(refusal("[region.\"sa\\u0007nd\"]\npolygon_m = [[0,0],[1,0],[1,1]]\n"),
            "c.toml:1: [region.\"sa\\u0007nd\"]: the name holds control characters, expected one that prints");
}

// Variances are floats, those of hundredths of a pixel too.
TEST(BadInput, ScalesThatNoFloatHolds) {
  const auto scaled = [](const char* scale) { return refusal(std::string("[camera]\nlength_unit = 'ft'\nmetres_per_pixel = ") + scale + "\n"); };
  EXPECT_EQ(scaled("3e-30"), "c.toml:3: camera.metres_per_pixel: found 3e-30, expected a number from 1e-12 to 1e+12");
  EXPECT_NE(scaled("3e30"), "");
  EXPECT_EQ(scaled("3e-10"), "");
}

TEST(BadInput, FilesThatAreNone) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "pivnp case test";
  std::filesystem::create_directories(folder / "empty");
  auto message = [](const std::filesystem::path& path) -> std::string {
    try {
      read_case(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(folder / "nowhere.toml"), (folder / "nowhere.toml").string() + ": no such file");
  EXPECT_EQ(message(folder / "empty"), (folder / "empty").string() + ": the folder has no case.toml");
  EXPECT_EQ(message("/dev/null"), "/dev/null: not a file");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace pivnp::app

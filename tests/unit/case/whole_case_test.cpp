// What only the whole case shows: contradictions, outlines, missing materials, stages without what they need.
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

TEST(WholeCase, TheCaseThatTheTestsChangeIsSound) { EXPECT_EQ(refusal(whole_case), ""); }

TEST(WholeCase, CrossingPolygonsNameLineAndKey) {
  EXPECT_EQ(
      refusal("[region.sand]\npolygon_m = [[0, 0], [1, 1], [1, 0], [0, 1]]\n"),
      "c.toml:2: region.sand.polygon_m: the polygon crosses or touches itself; list its vertices in order around it");
  EXPECT_EQ(
      refusal("[mask.a]\n\npolygon_px = [[0, 0], [1, 1], [1, 0], [0, 1]]\n").rfind("c.toml:3: mask.a.polygon_px: ", 0),
      0u);
  EXPECT_EQ(refusal("[region.sand]\npolygon_px = [[0, 0], [1, 1]]\n"),
            "c.toml:2: region.sand.polygon_px: a polygon needs at least 3 vertices, found 2");
  EXPECT_EQ(
      refusal("[body.a]\npolygon_m = [[0, 0], [1, 1], [1, 0], [0, 1]]\n").rfind("c.toml:2: body.a.polygon_m: ", 0), 0u);
  EXPECT_EQ(refusal("[boundary.a]\npolygon_m = [[0, 0], [1, 1], [1, 0], [0, 1]]\n")
                .rfind("c.toml:2: boundary.a.polygon_m: ", 0),
            0u);
  EXPECT_EQ(refusal("[compare]\nreference_m = [[0, 0], [1, 1], [1, 0], [0, 1]]\n")
                .rfind("c.toml:2: compare.reference_m: ", 0),
            0u);
}

TEST(WholeCase, TwoWaysToSayOneThing) {
  EXPECT_EQ(refusal("[grid]\nspacing_px = 16\nspacing_m = 0.1\n"),
            "c.toml:3: grid.spacing_m: given together with grid.spacing_px; expected one of them");
  EXPECT_EQ(refusal("[grid]\narea_px = [[0,0],[1,1]]\narea_m = [[0,0],[1,1]]\n"),
            "c.toml:3: grid.area_m: given together with grid.area_px; expected one of them");
  EXPECT_EQ(refusal("[region.a]\npolygon_m = [[0,0],[1,0],[1,1]]\npolygon_px = [[0,0],[1,0],[1,1]]\n"),
            "c.toml:3: region.a.polygon_px: given together with polygon_m; expected one of them");
  EXPECT_EQ(
      refusal("[camera]\nmetres_per_pixel = 1\npoints_px = [[0,0],[1,0],[1,1],[0,1]]\npoints_m = "
              "[[0,0],[1,0],[1,1],[0,1]]\n"),
      "c.toml:2: camera.metres_per_pixel: given together with targets (points_px, points_m); expected one of them");
}

TEST(WholeCase, ShapesThatAreNone) {
  EXPECT_EQ(refusal("name = 'x'\n[region.a]\nmaterial = 'b'\n"),
            "c.toml:2: [region.a]: no shape is given; expected one of polygon_m, polygon_px");
  EXPECT_EQ(refusal("[mask.a]\ninvert = true\n"),
            "c.toml:1: [mask.a]: no shape is given; expected one of polygon_px, polygon_m, circle_px, image, images, glare, air");
  EXPECT_EQ(refusal("[mask.a]\ncircle_px = [1, 2]\n"),
            "c.toml:2: mask.a.circle_px: found 2 numbers, expected 3: centre and radius");
  EXPECT_EQ(refusal("[body.a]\ncircle_m = [1, 2, -1]\n"),
            "c.toml:2: body.a.circle_m: found radius -1.0, expected more than 0");
  EXPECT_EQ(refusal("[boundary.a]\nline_m = [[0, 0]]\n"),
            "c.toml:2: boundary.a.line_m: found 1 points, expected the line's two ends");
  EXPECT_EQ(refusal("[boundary.a]\nline_m = [[1, 0], [1, 0]]\n"),
            "c.toml:2: boundary.a.line_m: the line's two ends are the same point");
  EXPECT_EQ(refusal("[boundary.a]\nline_m = [[0, 0], [1, 0]]\nnormal = [0, 0]\n"),
            "c.toml:3: boundary.a.normal: found [0.0, 0.0], expected a direction");
  EXPECT_EQ(refusal("[grid]\narea_m = [[0, 0], [1, 0]]\n"), "c.toml:2: grid.area_m: the two corners span no area");
  EXPECT_EQ(refusal("[grid]\narea_m = [[0, 0], [1, 0], [1, 1]]\n"),
            "c.toml:2: grid.area_m: found 3 points, expected two opposite corners");
}

TEST(WholeCase, Targets) {
  EXPECT_EQ(refusal("[camera]\npoints_px = [[0,0],[1,0],[1,1],[0,1]]\n"),
            "c.toml:1: camera.points_m: found 0 targets, expected as many as camera.points_px, 4");
  EXPECT_EQ(refusal("[camera]\npoints_px = [[0,0],[1,0]]\npoints_m = [[0,0],[1,0]]\n"),
            "c.toml:2: camera.points_px: found 2 targets, expected at least 4");
}

TEST(WholeCase, MaterialsOfRegions) {
  EXPECT_EQ(refusal(changed("[material.sand]", "[material.snad]")),
            "c.toml:6: region.sand: there is no [material.sand]; did you mean 'snad'?");
  EXPECT_EQ(refusal(changed("[region.sand]\n", "[region.sand]\nmaterial = \"sandy\"\n")),
            "c.toml:7: region.sand.material: there is no [material.sandy]; did you mean 'sand'?");
  EXPECT_EQ(refusal("[frames]\npath = 'a'\n[region.a]\npolygon_m = [[0,0],[1,0],[1,1]]\n[mpm]\n"),
            "c.toml:5: [mpm]: no material is given; expected a [material.NAME]");
  EXPECT_EQ(refusal("[frames]\npath = 'a'\n[mpm]\n"),
            "c.toml:3: [mpm]: there is nothing to simulate; expected a [region.NAME]");
}

TEST(WholeCase, RegionsOfContacts) {
  const std::string with = whole_case + "[contact.face]\nfriction = 0.3\n";
  EXPECT_EQ(refusal(with), "c.toml:14: contact.face.regions: missing; expected the names of one or more regions");
  EXPECT_EQ(refusal(with + "regions = [\"sadn\"]\n"),
            "c.toml:16: contact.face.regions: there is no [region.sadn]; did you mean 'sand'?");
  EXPECT_EQ(refusal(with + "regions = [\"sand\"]\nagainst = [\"glass plate\"]\n"),
            "c.toml:17: contact.face.against: there is no [region.glass plate]; known: sand");
  EXPECT_EQ(refusal(with + "regions = \"sand\"\n"),
            "c.toml:16: contact.face.regions: found a string \"sand\", expected a list of strings");
}

// The laws' rules with the place of the key, or of the section where it is missing.
TEST(WholeCase, MaterialConstants) {
  const auto fault = [](const std::string& from, const std::string& to) {
    const std::string text = refusal(changed(from, to));
    return text.substr(0, text.find(": ", text.find(": ") + 2));
  };
  EXPECT_EQ(fault("density_kg_m3 = 1545\n", ""), "c.toml:8: material.sand.density_kg_m3");
  EXPECT_EQ(fault("young_pa = 30e6\n", ""), "c.toml:8: material.sand.young_pa");
  EXPECT_EQ(fault("friction_deg = 43\n", ""), "c.toml:8: material.sand.friction_deg");
  EXPECT_EQ(fault("friction_deg = 43", "model = \"von_mises\""), "c.toml:8: material.sand.shear_strength_pa");
  EXPECT_EQ(fault("friction_deg = 43", "model = \"linear_elastic\""), "");
  EXPECT_EQ(fault("friction_deg = 43", "cohesion_pa = 1e3"), "");
  EXPECT_EQ(fault("friction_deg = 43", "friction_deg = 30\ndilatancy_deg = 31"), "c.toml:12: material.sand.dilatancy_deg");
  EXPECT_EQ(fault("friction_deg = 43", "friction_deg = 30\nfriction_residual_deg = 31\nsoftening_shape = 5"),
            "c.toml:12: material.sand.friction_residual_deg");
  EXPECT_EQ(fault("friction_deg = 43", "model = \"linear_elastic\"\nreduction_factor = 2.0"),
            "c.toml:12: material.sand.reduction_factor");
  EXPECT_EQ(fault("friction_deg = 43", "friction_deg = 43\ndensity_end_kg_m3 = 2000"), "c.toml:8: material.sand.density_until_s");
}

TEST(WholeCase, StagesWithoutFrames) {
  EXPECT_EQ(refusal("[np]\nper_element = 4\n"),
            "c.toml:1: [np]: there are no frames to measure; expected [frames], [vectors] or [synth]");
  EXPECT_EQ(refusal("[piv]\n"), "c.toml:1: [piv]: there are no frames to measure; expected [frames] or [synth]");
  EXPECT_EQ(refusal(changed("[frames]\npath = \"frames/*.png\"\n", "")),
            "c.toml:10: mpm.end_s: missing; without frames the end of the simulation must be given (s)");
  const std::string with_end =
      changed("[frames]\npath = \"frames/*.png\"\n", "") + "end_s = 1.0\noutput_rate_hz = 10\n";
  EXPECT_EQ(refusal(with_end), "c.toml:10: [mpm]: without frames the grid must be given; expected grid.spacing_m");
  EXPECT_EQ(refusal(with_end + "[grid]\nspacing_m = 0.01\n"), "");
}

TEST(WholeCase, NumbersThatDoNotFitTogether) {
  EXPECT_EQ(refusal("[frames]\npath = 'a'\nfirst = 5\nlast = 3\n"),
            "c.toml:4: frames.last: found 3, expected at least frames.first, 5");
  EXPECT_EQ(refusal("[frames]\n[piv]\nwindow_px = 32\nfirst_window_px = 16\n"),
            "c.toml:4: piv.first_window_px: found 16, expected 0 or at least piv.window_px, 32 (px)");
  EXPECT_EQ(refusal("[frames]\n[np]\nper_element = 5\n"),
            "c.toml:3: np.per_element: found 5, expected a square: 1, 4, 9, 16 ...");
  EXPECT_EQ(refusal("[body.a]\ncircle_m = [0, 0, 1]\nfrom_s = 2\nuntil_s = 1\n"),
            "c.toml:4: body.a.until_s: found 1.0, expected more than from_s, 2.0 (s)");
  EXPECT_EQ(refusal("[boundary.a]\nline_m = [[0, 0], [1, 0]]\nfriction = 0.5\n"),
            "c.toml:3: boundary.a.friction: given, but the type is \"fixed\"; expected type = \"frictional\"");
  EXPECT_EQ(refusal("[output]\nfields = [\"strain_devi\"]\n"),
            "c.toml:2: output.fields: unknown field \"strain_devi\"; did you mean 'strain_dev'?");
}

TEST(WholeCase, SyntheticFrames) {
  EXPECT_EQ(refusal("[synth]\nmotion = 'affine'\ngradient_per_frame = [1, 2, 3]\n"),
            "c.toml:3: synth.gradient_per_frame: found 3 numbers, expected 4: xx xy yx yy");
  EXPECT_EQ(refusal("[synth]\nshift_px_per_frame = [1, 2]\n"),
            "c.toml:1: [synth]: an affine motion is described, but motion is \"none\"; expected motion = \"affine\"");
  EXPECT_EQ(refusal("[synth]\nmotion = 'mpm'\n"),
            "c.toml:2: synth.motion: \"mpm\" needs the simulation that carries the texture; expected [synth.mpm]");
  EXPECT_EQ(refusal("[synth]\nmotion = 'mpm'\n[synth.mpm]\n[region.a]\npolygon_m = [[0,0],[1,0],[1,1]]\n"),
            "c.toml:3: [synth.mpm]: no material is given; expected a [synth.material.NAME]");
  EXPECT_EQ(refusal("[synth.mpm]\n"),
            "c.toml:1: [synth.mpm]: given, but synth.motion is \"none\"; expected motion = \"mpm\"");
  EXPECT_EQ(refusal("[synth.texture]\npeak_min = 0.5\npeak_max = 0.4\n"),
            "c.toml:3: synth.texture.peak_max: found 0.4, expected at least peak_min, 0.5");
  EXPECT_EQ(refusal("[synth.texture]\nbits = 10\n"), "c.toml:2: synth.texture.bits: found 10, expected 8, 12 or 16");
}

TEST(WholeCase, VerifyNeedsThresholdsAndTruth) {
  EXPECT_EQ(refusal("[synth]\n[verify]\nlost_share = 0.1\n"),
            "c.toml:2: [verify]: no threshold is given; expected displacement_rms_px, strain_error or nodal_error");
  EXPECT_EQ(refusal("[verify]\nstrain_error = 0.1\n"),
            "c.toml:1: [verify]: the truth is not known without synthetic frames; expected [synth]");
}

}  // namespace
}  // namespace pivnp::app

// Numbers and names as printed.
#include "apps/report/words.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pivnp/core/particles/fields.hpp"

namespace pivnp::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Words, UncertaintyHasTwoDigitsAndSetsTheValues) {
  EXPECT_EQ(value_with_uncertainty(0.0123456, 0.00056), "0.01235 ± 0.00056");
  EXPECT_EQ(value_with_uncertainty(12.3456, 1.04), "12.3 ± 1.0");
  EXPECT_EQ(value_with_uncertainty(-1.8349, 0.62), "−1.83 ± 0.62");
  EXPECT_EQ(value_with_uncertainty(0.0, 0.00996), "0.000 ± 0.010");  // 0.00996 rounds up to 0.010
  EXPECT_EQ(value_with_uncertainty(1.234e-6, 5.6e-8), "(1.234 ± 0.056) × 10⁻⁶");
  EXPECT_EQ(value_with_uncertainty(3.0e-9, 4.0e-7), "(0.0 ± 4.0) × 10⁻⁷");
  EXPECT_EQ(value_with_uncertainty(2.5, nan), "2.50");
  EXPECT_EQ(value_with_uncertainty(2.5, 0), "2.50");
  EXPECT_EQ(value_with_uncertainty(nan, 1), "n/a");
  EXPECT_EQ(value_with_uncertainty(std::numeric_limits<double>::infinity(), nan), "n/a");
}

TEST(Words, Numbers) {
  EXPECT_EQ(number(0.5), "0.500");
  EXPECT_EQ(number(0), "0");
  EXPECT_EQ(number(99.96, 3), "100");
  EXPECT_EQ(number(1.5e-7, 2), "1.5 × 10⁻⁷");
  EXPECT_EQ(number(-30e6, 2), "−3.0 × 10⁷");
  EXPECT_EQ(plain(0.5), "0.5");
  EXPECT_EQ(plain(120), "120");
  EXPECT_EQ(plain(-0.020004), "−0.02");
  EXPECT_EQ(plain(2e-7), "2 × 10⁻⁷");
  EXPECT_EQ(percent(1), "100 %");
  EXPECT_EQ(percent(0.99999), "> 99.9 %");
  EXPECT_EQ(percent(0.0001), "< 0.1 %");
  EXPECT_EQ(percent(0.423), "42.3 %");
  EXPECT_EQ(percent(nan), "n/a");
  EXPECT_EQ(count(1, "particle"), "1 particle");
  EXPECT_EQ(count(1234567, "particle"), "1\u202f234\u202f567 particles");
}

TEST(Words, Names) {
  EXPECT_EQ(metric_words("displacement_rms"), "Displacement, RMS");
  EXPECT_EQ(metric_words("strain_dev_p95"), "Deviatoric strain, 95th percentile");
  EXPECT_EQ(metric_words("displacement_bias_x_final"), "Displacement, mean difference in x, at the end");
  EXPECT_EQ(metric_words("displacement_rms_final_over_u"), "Displacement, RMS, at the end, in units of its uncertainty");
  EXPECT_EQ(metric_words("u_val_final"), "Uncertainty of a difference, u_val, at the end");
  EXPECT_EQ(metric_words("outline_iou"), "Outlines, share in common (IoU)");
  EXPECT_EQ(metric_words("outline_hausdorff_95"), "Outlines, Hausdorff distance (95 %)");
  EXPECT_EQ(metric_words("run_out_x_second"), "Run-out, simulated");
  EXPECT_EQ(metric_words("area_metric_strain_dev"), "Area metric of the deviatoric strain");
  EXPECT_EQ(metric_words("decomposition_displacement_x_outside"),
            "Decomposition of the displacement x, share of coefficients outside the band");
  EXPECT_EQ(metric_words("levelled_strain_dev_path_rms"), "Deviatoric strain along the path, RMS, levelled");
  EXPECT_EQ(metric_words("point_1_onset_difference"), "Point 1, onset, simulated − measured");
  EXPECT_EQ(metric_words("history_rms"), "History, RMS");
  EXPECT_EQ(metric_words("fixed_zone_shift_first_x"), "Fixed zone, shift x, measured");
  EXPECT_EQ(metric_words("onset"), "Onset");
  EXPECT_EQ(metric_words("something_new"), "Something new");
  EXPECT_EQ(metric_words(""), "");
  EXPECT_EQ(field_words("strain_dev"), "deviatoric strain");
  motion_fields().add({.name = "heat", .form = FieldForm::vector, .label = "flow of heat"});
  EXPECT_EQ(field_words("heat_x"), "flow of heat x");
  motion_fields().remove_last();
}

TEST(Words, UnitsSuitTheirNumbers) {
  EXPECT_EQ(display_unit("m", 0.02).name, "mm");
  EXPECT_EQ(display_unit("m", 20).name, "m");
  EXPECT_EQ(display_unit("m", 0).name, "m");
  EXPECT_EQ(display_unit("px", 0.02).name, "px");
  EXPECT_DOUBLE_EQ(display_unit("m", 1e-5).factor, 1e6);
}

TEST(Words, HtmlIsEscapedAndClean) {
  EXPECT_EQ(escape_html("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
  EXPECT_EQ(escape_html("\x01x\ty\n"), "x\ty\n");
  EXPECT_EQ(clean_utf8("ü€😀"), "ü€😀");
  EXPECT_EQ(clean_utf8("\xc3"), "\ufffd");                      // cut off
  EXPECT_EQ(clean_utf8("\xc0\xaf"), "\ufffd\ufffd");            // overlong
  EXPECT_EQ(clean_utf8("\xed\xa0\x80"), "\ufffd\ufffd\ufffd");  // a surrogate
}

}  // namespace
}  // namespace pivnp::report

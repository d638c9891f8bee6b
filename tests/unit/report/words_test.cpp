// Names as printed, and text made safe.
#include "apps/report/words/words.hpp"

#include <gtest/gtest.h>

#include "apps/report/document/text.hpp"

#include "pivnp/core/particles/fields.hpp"
#include "tests/support/added.hpp"

namespace pivnp::report {
namespace {

TEST(Words, Names) {
  const DataSetNames names = data_set_names({});
  EXPECT_EQ(capitalised(metric_words("displacement_rms", names)), "Displacement difference, RMS");
  EXPECT_EQ(capitalised(metric_words("strain_dev_p95", names)), "Deviatoric strain, difference, 95th percentile");
  EXPECT_EQ(capitalised(metric_words("displacement_bias_x_final", names)), "Displacement difference, mean in x, at the end");
  EXPECT_EQ(capitalised(metric_words("displacement_rms_final_over_u", names)), "Displacement difference, RMS, at the end, in units of its uncertainty");
  EXPECT_EQ(capitalised(metric_words("u_val_final", names)), "Uncertainty of a difference, u_val, at the end");
  EXPECT_EQ(capitalised(metric_words("outline_iou", names)), "Outlines, share in common (IoU)");
  EXPECT_EQ(capitalised(metric_words("outline_hausdorff_95", names)), "Outlines, Hausdorff distance (95 %)");
  EXPECT_EQ(capitalised(metric_words("run_out_x_second", names)), "Run-out, simulated");
  EXPECT_EQ(capitalised(metric_words("area_metric_strain_dev", names)), "Area metric of the deviatoric strain");
  EXPECT_EQ(capitalised(metric_words("decomposition_displacement_x_outside", names)),
            "Decomposition of the displacement x, share of coefficients outside the band");
  EXPECT_EQ(capitalised(metric_words("levelled_strain_dev_path_rms", names)), "Deviatoric strain along the path, difference, RMS, levelled");
  EXPECT_EQ(capitalised(metric_words("point_1_onset_difference", names)), "Point 1, onset, simulated − measured");
  EXPECT_EQ(capitalised(metric_words("history_rms", names)), "History, RMS");
  EXPECT_EQ(capitalised(metric_words("fixed_zone_shift_first_x", names)), "Fixed zone, shift x, measured");
  EXPECT_EQ(capitalised(metric_words("onset", names)), "Onset");
  EXPECT_EQ(capitalised(metric_words("something_new", names)), "Something new");
  EXPECT_EQ(capitalised(metric_words("", names)), "");
  const DataSetNames alike{true, "first", "second", "the first", "the second"};
  EXPECT_EQ(metric_words("run_out_x_second", alike), "run-out, second");
  EXPECT_EQ(metric_words("point_1_onset_difference", alike), "point 1, onset, second − first");
  EXPECT_EQ(field_words("strain_dev"), "deviatoric strain");
  const test::Added heat(motion_fields(), {.name = "heat", .form = FieldForm::vector, .label = "flow of heat"});
  EXPECT_EQ(field_words("heat_x"), "flow of heat x");
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

// JUnit XML: well-formed whatever a case is called, with the counts that its readers add up.
#include "apps/cli/junit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/cli/xml.hpp"

namespace pivnp::app {
namespace {

TEST(Junit, TextsAreEscaped) {
  EXPECT_EQ(xml_escaped("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
  EXPECT_EQ(xml_escaped("é µ 😀"), "é µ 😀");
  EXPECT_EQ(xml_escaped("\x01 \x7f\xff \xc3(\xed\xa0\x80"), "? \x7f? ?(???")
      << "control characters, broken UTF-8, a surrogate";
  EXPECT_EQ(xml_escaped("a\nb\tc"), "a&#10;b&#9;c");
  EXPECT_EQ(xml_escaped("cut \xe2\x82"), "cut ??");
}

std::vector<VerifyResult> results() {
  return {{"shear & \"co\" <1>",
           false,
           1.5,
           {{"images: RMS (px)", 0.1, 0.05, true},
            {"strain <", 1e-4, 2e-4, false},
            {"nan", 1, std::numeric_limits<double>::quiet_NaN(), false}},
           ""},
          {"lost", false, 0.25, {}, "c.toml:3: unknown key 'a'; did you mean \"b\"?"},
          {"good", true, 2, {{"images", 1, 0.5, true}}, ""}};
}

TEST(Junit, CountsSuitesCasesAndVerdicts) {
  const std::string xml = junit_xml(results());
  const Xml read = read_xml(xml);
  ASSERT_EQ(read.error, "") << xml;
  EXPECT_EQ(read.count("testsuite"), 3);
  EXPECT_EQ(read.count("testcase"), 5);
  EXPECT_EQ(read.count("failure"), 2);
  EXPECT_EQ(read.count("error"), 1);
  EXPECT_NE(xml.find("<testsuites name=\"pivnp verify\" tests=\"5\" failures=\"2\" errors=\"1\" time=\"3.750\">"),
            std::string::npos)
      << xml;
  EXPECT_NE(xml.find("message=\"exceeded: reached 0.0002, limit 0.0001\""), std::string::npos) << xml;
}

TEST(Junit, AnyBytesStayWellFormed) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE("seed 11, trial " + std::to_string(trial));
    auto bytes = [&] {
      std::string text;
      for (std::size_t k = random() % 20; k > 0; --k) text += char(random() % 256);
      return text;
    };
    VerifyResult result{bytes(), false, 0, {{bytes(), 1, 2, false}}, bytes()};
    const std::string xml = junit_xml({result});
    ASSERT_EQ(read_xml(xml).error, "") << xml;
  }
}

TEST(Junit, TheCheckerItselfFindsFaults) {
  for (const char* bad : {"<a><b></a></b>", "<a b=c/>", "<a>&x;</a>", "<a>", "<a/><b/>", "<a b=\"<\"/>", "<a>\x01</a>",
                          "text", "<a>\xff</a>"})
    EXPECT_NE(read_xml(bad).error, "") << bad;
  EXPECT_EQ(read_xml("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a b=\"c\"><d/>e&amp;&#10;</a>\n").error, "");
}

TEST(VerifyTable, SaysWhatWasReachedAndWhatWasAllowed) {
  const std::string table = verify_table(results());
  EXPECT_NE(table.find("FAILED  shear"), std::string::npos) << table;
  EXPECT_NE(table.find("  EXCEEDED  strain <          reached 0.0002     limit 0.0001\n"), std::string::npos) << table;
  EXPECT_NE(table.find("  could not be evaluated: c.toml:3: unknown key"), std::string::npos) << table;
  EXPECT_NE(table.find("passed  good"), std::string::npos) << table;
}

}  // namespace
}  // namespace pivnp::app

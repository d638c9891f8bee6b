// `pivnp verify`: what it finds, what it writes, how it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "pivnp/core/error.hpp"
#include "tests/unit/cli/fake_study.hpp"
#include "tests/unit/cli/xml.hpp"

namespace pivnp::app {
namespace {

using testing::HasSubstr;

class VerifyCommand : public testing::Test {
 protected:
  void SetUp() override {
    fake_study() = {};
    folder.write("data/b/case.toml", "[synth]\n[verify]\nstrain_error = 0.1\n");
    folder.write("data/a/case.toml", "[synth]\n[verify]\ndisplacement_rms_px = 0.1\n");
    folder.write("data/measured/case.toml", "[frames]\npath = 'x'\n");
    folder.write("data/b/other.toml", "this is not read");
  }
  Ran verify(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"verify", (folder.path / "data").string(), "--out", out.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  static VerifyResult result(const std::string& name, bool passed, const std::string& failure = "") {
    return {name, passed && failure.empty(), 0.5, {{"strain", 0.1, passed ? 0.05 : 0.2, passed}}, failure};
  }
  static std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  Folder folder;
  std::filesystem::path out = folder.path / "out";
};

TEST_F(VerifyCommand, RunsTheCasesWithThresholdsInOrder) {
  fake_study().verdicts = {result("a", true), result("b", true)};
  const Ran ran = verify();
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(fake_study().calls.size(), 2u);
  EXPECT_EQ(fake_study().settings.out, out / "b");
  EXPECT_THAT(ran.out, HasSubstr("passed  a"));
  EXPECT_THAT(ran.out, HasSubstr("2 of 2 cases passed\n"));
  const Xml xml = read_xml(text_of(out / "verify.xml"));
  EXPECT_EQ(xml.error, "");
  EXPECT_EQ(xml.count("testsuite"), 2);
}

TEST_F(VerifyCommand, AMissedThresholdEndsWithThree) {
  fake_study().verdicts = {result("a", false), result("b", true)};
  const std::filesystem::path junit = folder.path / "deep" / "j.xml";
  const Ran ran = verify({"--junit", junit.string()});
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(fake_study().calls.size(), 2u) << "the others are evaluated all the same";
  EXPECT_THAT(ran.out, HasSubstr("EXCEEDED"));
  EXPECT_THAT(ran.out, HasSubstr("1 of 2 cases passed\n"));
  EXPECT_EQ(read_xml(text_of(junit)).count("failure"), 1);
  EXPECT_FALSE(std::filesystem::exists(out / "verify.xml"));
}

TEST_F(VerifyCommand, ACaseThatCouldNotBeJudgedIsAFailure) {
  fake_study().verdicts = {result("a", false), result("b", true, "out of memory")};
  const Ran ran = verify();
  EXPECT_EQ(ran.code, 1);
  EXPECT_THAT(ran.out, HasSubstr("could not be evaluated: out of memory"));
  EXPECT_EQ(read_xml(text_of(out / "verify.xml")).count("error"), 1);
}

TEST_F(VerifyCommand, InterruptedInTheMiddle) {
  fake_study().verdicts = {result("a", true), result("b", true)};
  fake_study().work = [](Progress&) {
    if (fake_study().calls.size() == 2) throw Interrupted();
  };
  EXPECT_EQ(verify().code, 130);
}

TEST_F(VerifyCommand, NothingToVerifyAndBrokenCasesEndWithTwoBeforeAnythingRuns) {
  const std::string none = (folder.path / "data" / "measured").string();
  Ran ran = run_program({"verify", none});
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "pivnp: error: nothing to verify: no case with a threshold in [verify] under " + none + "\n");
  ran = run_program({"verify", (folder.path / "nowhere").string()});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("nowhere: no such file or folder\n"));
  folder.write("data/z/case.toml", "[piv]\nwindow = 3\n");
  ran = verify();
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("z/case.toml:2: unknown key"));
  EXPECT_TRUE(fake_study().calls.empty());
}

TEST_F(VerifyCommand, CasesOfOneNameDoNotShareAFolder) {
  folder.write("data/deep/a/case.toml", "[synth]\n[verify]\nstrain_error = 0.1\n");
  fake_study().verdicts = {result("a", true), result("b", true), result("a", true)};
  std::vector<std::filesystem::path> folders;
  fake_study().work = [&](Progress&) { folders.push_back(fake_study().settings.out); };
  EXPECT_EQ(verify().code, 0);
  EXPECT_EQ(folders, (std::vector<std::filesystem::path>{out / "a", out / "b", out / "a_2"}));
}

}  // namespace
}  // namespace pivnp::app

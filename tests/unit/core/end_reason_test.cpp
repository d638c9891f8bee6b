// Reasons for which particles end: one list, which the format's page follows.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "pivnp/core/particles/end_reason.hpp"

namespace pivnp {
namespace {

std::string page(const std::string& name) {
  std::ifstream in(std::string(PIVNP_SOURCE_DIR) + "/docs/" + name);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(EndReasons, HaveNumbersNamesAndWordsOfTheirOwn) {
  std::set<int> numbers;
  std::set<std::string_view> texts;
  for (const EndReasonRow& row : end_reasons()) {
    EXPECT_TRUE(numbers.insert(int(row.value)).second) << row.name;
    EXPECT_TRUE(texts.insert(row.words).second) << row.name;
    EXPECT_EQ(words(row.value), row.words);
  }
  EXPECT_EQ(numbers, (std::set<int>{0, 1, 2, 3, 4, 5}));  // numbers that records hold never change
}

TEST(EndReasons, AreListedOnTheFormatsPage) {
  const std::string format = page("format.md");
  for (const EndReasonRow& row : end_reasons()) {
    const std::string number = std::to_string(int(row.value)), name(row.name);
    EXPECT_NE(format.find("| " + number + " " + name + " |"), std::string::npos) << name;
  }
}

TEST(EndReasons, ANumberOfALaterVersionIsNamed) {
  EXPECT_EQ(find(EndReason(250)), nullptr);
  const std::string text = words(EndReason(250));
  EXPECT_NE(text.find("250"), std::string::npos);
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace pivnp

// A program whose study is a fake one, and what all its errors look like.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "apps/cli/signals.hpp"
#include "tests/support/added.hpp"
#include "tests/unit/cli/fake_study.hpp"

namespace pivnp::app {

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    fake_study() = {};
    clear_stop_signal();
  }
  Folder folder;
  const std::string measured = folder.write("slope/case.toml", "[frames]\npath = 'img_*.png'\n").string();
};

// One line that begins as all errors do; the text may be followed by a hint.
inline void expect_error(const Ran& ran, int code, const std::string& text) {
  EXPECT_EQ(ran.code, code);
  EXPECT_THAT(ran.err, testing::StartsWith("pivnp: error: " + text));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_EQ(ran.out, "");
}

}  // namespace pivnp::app

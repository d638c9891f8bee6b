// One row of docs/verification.md: a test that reaches a figure says so here.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace pivnp::test {

/// Adds a row where `scripts/test --full` collects them (PIVNP_VERIFICATION_DIR), and prints it. `criterion` states
/// what is demanded, with the published value where there is one; `reached` is the figure.
inline void verification_row(const std::string& subject, const std::string& criterion, const std::string& reached) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string test = std::string(info->test_suite_name()) + "." + info->name();
  std::printf("[ figure   ] %s: %s: %s\n", subject.c_str(), criterion.c_str(), reached.c_str());
  const char* folder = std::getenv("PIVNP_VERIFICATION_DIR");
  if (folder == nullptr || *folder == '\0') return;
  std::string file = test;
  for (char& c : file)
    if (c == '/' || c == ' ') c = '_';
  std::ofstream out(std::string(folder) + "/" + file + ".tsv", std::ios::app);
  out << subject << '\t' << criterion << '\t' << reached << '\t' << test << '\n';
}

}  // namespace pivnp::test

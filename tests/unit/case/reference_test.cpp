// The reference lists every key, and the file in docs/ is the generated one.
#include <fstream>
#include <sstream>

#include "apps/case/listing.hpp"
#include "apps/case/sections.hpp"
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

// Counts keys from the option lists themselves, not from the rows the reference is made of.
struct CountKeys {
  const std::string& text;
  int& missing;
  int& keys;

  template <class T>
  void look(const std::string& heading, const T& options) {
    const std::size_t begin = text.find("\n## [" + heading + "]\n");
    if (begin == std::string::npos) {
      ++missing;
      ADD_FAILURE() << "no heading for " << heading;
      return;
    }
    std::string section = text.substr(begin + 1, text.find("\n## ", begin + 1) - begin);
    if (const std::size_t same = section.find("Keys: those of ["); same != std::string::npos) {
      const std::string other = section.substr(same + 16, section.find(']', same) - same - 16);
      const std::size_t there = text.find("\n## [" + other + "]\n");
      ASSERT_LT(there, begin) << heading << " mirrors " << other;
      section = text.substr(there + 1, text.find("\n## ", there + 1) - there);
    }
    T::fields(options, [&](std::string_view name, const auto&, const OptionInfo& info) {
      ++keys;
      const std::size_t row = section.find("\n- `" + std::string(name) + "` (");
      EXPECT_NE(row, std::string::npos) << heading << "." << name;
      if (row == std::string::npos) return;
      EXPECT_NE(section.substr(row, section.find('\n', row + 1) - row).find(info.text), std::string::npos) << name;
    });
  }
  template <class T>
  void always(const char* path, const T& options, const char*) {
    look(path, options);
  }
  template <class T>
  void optional(const char* path, const std::optional<T>&, const char*) {
    const T defaults{};
    look(path, defaults);
  }
  template <class T>
  void named(const char* path, const Named<T>&, const char*) {
    const T defaults{};
    look(std::string(path) + ".NAME", defaults);
  }
};

TEST(Reference, ListsEveryKeyOfEverySection) {
  const std::string text = case_reference();
  int missing = 0, keys = 0;
  const Case defaults;
  for_each_section(defaults, CountKeys{text, missing, keys});
  EXPECT_EQ(missing, 0);
  EXPECT_GT(keys, 90);
}

TEST(Reference, TheCommittedFileIsTheGeneratedOne) {
  std::ifstream file(PIVNP_SOURCE_DIR "/docs/case.md", std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_TRUE(text == case_reference()) << "write it anew: cmake --build build/release --target case_reference";
}

TEST(Reference, TheCommittedSchemaIsTheGeneratedOne) {
  std::ifstream file(PIVNP_SOURCE_DIR "/docs/case.schema.json", std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_TRUE(text == case_schema()) << "write it anew: cmake --build build/release --target case_reference";
}

TEST(Reference, ItsExampleReads) {
  const std::string text = case_reference();
  const std::size_t begin = text.find("```toml\n") + 8;
  const std::string example = text.substr(begin, text.find("```", begin) - begin);
  EXPECT_EQ(refusal(example), "");
  EXPECT_EQ(parse_case(example, "c.toml", ".").boundaries.size(), 3u);
}

}  // namespace
}  // namespace pivnp::app

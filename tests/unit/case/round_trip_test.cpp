// A case that is written reads back to the same options, to the bit.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <random>

#include "apps/case/fields.hpp"
#include "apps/case/sections.hpp"
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

// Any admissible value of an option, drawn over its range: many magnitudes, awkward texts.
class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}

  void operator()(std::string_view, bool& value, const OptionInfo&) { value = coin(); }
  void operator()(std::string_view, int& value, const OptionInfo& info) {
    const double low = std::max(info.min, -1e6), high = std::min(info.max, 1e6);
    value = int(std::lround(low + (high - low) * unit_(random_)));
  }
  void operator()(std::string_view, double& value, const OptionInfo& info) { value = number(info); }
  void operator()(std::string_view, std::string& value, const OptionInfo& info) {
    if (const std::vector<std::string> choices = choices_of(info); !choices.empty()) {
      value = choices[random_() % choices.size()];
      return;
    }
    static const std::string letters[] = {"a", " ", "\"", "\\", "#", "é", "µ", "'", "]", "="};
    value.clear();
    for (std::size_t k = random_() % 8; k > 0; --k) value += letters[random_() % std::size(letters)];
  }
  void operator()(std::string_view, Pair& value, const OptionInfo& info) { value = {number(info), number(info)}; }
  void operator()(std::string_view, Points& value, const OptionInfo& info) {
    value.resize(random_() % 5);
    for (Pair& p : value) p = {number(info), number(info)};
  }
  void operator()(std::string_view, std::vector<double>& value, const OptionInfo& info) {
    value.resize(random_() % 5);
    for (double& v : value) v = number(info);
  }
  void operator()(std::string_view name, std::vector<std::string>& value, const OptionInfo& info) {
    value.resize(random_() % 4);
    for (std::string& v : value) (*this)(name, v, info);
  }
  template <Choice E>
  void operator()(std::string_view, E& value, const OptionInfo&) {
    const auto& names = names_of(E{});
    value = std::next(names.begin(), std::ptrdiff_t(random_() % names.size()))->value;
  }
  template <class T>
  void operator()(std::string_view name, std::optional<T>& value, const OptionInfo& info) {
    value.reset();
    if (coin()) (*this)(name, value.emplace(), info);
  }

 private:
  bool coin() { return random_() % 2 == 0; }
  double number(const OptionInfo& info) {
    for (;;) {
      double v = std::pow(10.0, 40 * unit_(random_) - 20) * (coin() ? 1 : -1);
      if (random_() % 8 == 0) v = std::round(10 * unit_(random_));
      if (std::isfinite(info.min) && std::isfinite(info.max)) v = info.min + (info.max - info.min) * unit_(random_);
      if (in_range(info, v)) return v;
    }
  }
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

template <class T>
std::vector<std::string> values_of(const T& options) {
  std::vector<std::string> values;
  T::fields(options, [&](std::string_view name, const auto& value, const OptionInfo&) {
    values.push_back(std::string(name) + " " + toml_text(value));
  });
  return values;
}

struct RandomSections {
  unsigned seed;

  template <class T>
  void check(const std::string& path) {
    SCOPED_TRACE(path + ", seed " + std::to_string(seed));
    T options;
    Draw draw(seed);
    T::fields(options, draw);
    const std::string text = write_fields(options);
    T back;
    Notes notes;
    Findings found{notes};
    read_fields("c.toml", path, parse_document(text, "c.toml"), {}, back, found);
    ASSERT_NO_THROW(found.faults.raise("c.toml")) << text;
    EXPECT_EQ(values_of(back), values_of(options)) << text;
  }
  template <class T>
  void always(const char* path, const T&, const char*) {
    check<T>(path);
  }
  template <class T>
  void optional(const char* path, const std::optional<T>&, const char*) {
    check<T>(path);
  }
  template <class T>
  void named(const char* path, const Named<T>&, const char*) {
    check<T>(path);
  }
};

TEST(RoundTrip, RandomOptionsOfEverySection) {
  const Case defaults;
  for (unsigned seed = 1; seed <= 100; ++seed) for_each_section(defaults, RandomSections{seed});
}

TEST(RoundTrip, NumbersKeepTheirBits) {
  std::mt19937_64 random(5);
  for (int k = 0; k < 2000; ++k) {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    const Node node = parse_document("x = " + toml_text(value), "c.toml");
    ASSERT_EQ(node.find("x")->value.kind, Node::Kind::number) << toml_text(value);
    EXPECT_EQ(node.find("x")->value.number, value) << "seed 5, draw " << k;
  }
}

void expect_fixed_point(const std::string& text) {
  const Case first = parse_case(text, "c.toml", ".");
  const std::string written = write_case(first);
  const Case second = parse_case(written, "written.toml", ".");
  EXPECT_EQ(write_case(second), written);
  EXPECT_EQ(second.name, first.name);
  EXPECT_EQ(second.regions.size(), first.regions.size());
  EXPECT_EQ(second.synth.has_value(), first.synth.has_value());
  EXPECT_EQ(second.mpm.has_value(), first.mpm.has_value());
}

TEST(RoundTrip, WholeCases) {
  expect_fixed_point("");
  expect_fixed_point(whole_case);
  expect_fixed_point(whole_case + "[initial.sand]\nvelocity_m_s = [1.0, 0.0]\n");  // no stress and no pressure of its own
  expect_fixed_point(embedded_case_text());
  expect_fixed_point(
      "name = 'a \"b\" \\ é'\n[region.\"the middle.1\"]\npolygon_px = [[0,0],[1,0],[1,1]]\n[mask.b]\nimage = 'x'\n");
  expect_fixed_point(whole_case + R"(
[synth]
motion = "mpm"
[synth.texture]
noise = 0.02
[synth.mpm]
refine = 2
[synth.material.sand]
density_kg_m3 = 1500
young_pa = 1e7
friction_deg = 30
[boundary.base]
line_m = [[0, 0], [1, 0]]
[boundary.gate]
line_m = [[0.3, 0], [0.2, 0.2]]
type = "roller"
normal = [1, 0]
until_s = 0.1
[body.cylinder]
circle_m = [0, 0, 0.1]
[compare.limits]
strain_rms = 0.1
[output]
fields = ["strain_dev", "velocity_x"]
)");
}

// What a run writes into its record must read back, although frames were found for a [synth] case meanwhile; so must
// what a comparison of two records writes, which simulates nothing.
TEST(RoundTrip, CasesThatRunsWrite) {
  Case drawn = parse_case("[synth]\nmotion = 'none'\n[verify]\nstrain_error = 0.1\n", "c.toml", ".");
  drawn.frames.emplace().path = "/out/frames/frame_*.png";
  expect_fixed_point(write_case(drawn));
  Case compared;
  compared.name = "a against b";
  compared.limits["displacement_rms_m"] = 0.1;
  expect_fixed_point(write_case(compared));
}

TEST(RoundTrip, EveryDataSet) {
  int cases = 0;
  for (const auto& folder : std::filesystem::directory_iterator(PIVNP_SOURCE_DIR "/datasets")) {
    SCOPED_TRACE(folder.path().string());
    const Case c = read_case(folder.path());
    expect_fixed_point(write_case(c));
    ++cases;
  }
  EXPECT_GE(cases, 4);
}

TEST(RoundTrip, EveryDefaultIsFilledIn) {
  const std::string written = write_case(parse_case(whole_case, "c.toml", "."));
  for (const char* line :
       {"\n[piv]\n", "\nwindow_px = 32\n", "\n[np]\n", "\nstride = 1\n", "\ndensity_kg_m3 = 1545.0\n",
        "\n# rate_hz is not given (Hz): ", "\n[compare.limits]\n", "\ngravity_m_s2 = [0.0, -9.81]\n"})
    EXPECT_NE(written.find(line), std::string::npos) << line << written;
  EXPECT_EQ(written.find("[synth"), std::string::npos);
  EXPECT_EQ(written.find("[verify"), std::string::npos);
}

struct Renamed {
  bool level = true;
  double damping = 0.5;
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("level", self.level, OptionInfo{.text = "a switch"});
    visit("damping", self.damping, OptionInfo{.text = "a share", .min = 0, .max = 1, .alias = "friction"});
  }
};

TEST(FormerKeys, AreReadNotedAndWrittenByTheirNewNames) {
  const auto read = [](const std::string& text, Notes& notes) {
    Renamed options;
    Findings found{notes};
    read_fields("c.toml", "part", parse_document(text, "c.toml"), {}, options, found);
    found.faults.raise("c.toml");
    return options;
  };
  Notes notes;
  EXPECT_EQ(read("damping = 0.25\n", notes).damping, 0.25);
  EXPECT_TRUE(notes.empty());
  const Renamed old = read("level = false\nfriction = 0.75\n", notes);
  EXPECT_EQ(old.damping, 0.75);
  EXPECT_FALSE(old.level);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("c.toml:2: part.friction"), std::string::npos) << notes[0];
  EXPECT_NE(notes[0].find("part.damping"), std::string::npos) << notes[0];
  EXPECT_NE(write_fields(old).find("damping = 0.75"), std::string::npos);
  EXPECT_EQ(write_fields(old).find("friction"), std::string::npos);
  EXPECT_THROW(read("damping = 0.25\nfriction = 0.25\n", notes), InputError);  // both
  EXPECT_THROW(read("friction = 2\n", notes), InputError);                     // held to the same range
  EXPECT_THROW(read("frictiom = 0.5\n", notes), InputError);
}

}  // namespace
}  // namespace pivnp::app

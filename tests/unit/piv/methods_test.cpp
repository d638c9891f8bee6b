// A method is one row of a list: one that is added from outside is offered, read from a case, run and held to what it
// demands, like those of the house.
#include "pivnp/piv/methods.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "apps/case/case.hpp"
#include "apps/case/listing.hpp"
#include "pivnp/core/error.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

class Constant final : public Method {
 public:
  void correlate(const ImageView&, const ImageView&, PixelVectors& vectors) override {
    std::fill(vectors.displacement.begin(), vectors.displacement.end(), std::array<float, 2>{1.5f, -2.0f});
    std::fill(vectors.status.begin(), vectors.status.end(), VectorStatus::valid);
  }
  void set_first_mask(const MaskView&) override {}
};

std::unique_ptr<Method> make_constant(const PivOptions&, const Extent&, int) { return std::make_unique<Constant>(); }

class AddedMethod : public testing::Test {
 protected:
  AddedMethod() {
    piv_methods().add({.name = "constant",
                       .text = "the same vector everywhere",
                       .make = &make_constant,
                       .anchors = {Anchor::central},
                       .masks = false,
                       .least_window_px = 24});
  }
  ~AddedMethod() override { piv_methods().remove_last(); }

  PivOptions options() const {
    PivOptions o;
    o.method = "constant";
    return o;
  }
  Scene scene = make_scene(uniform(0, 0), 64, 64, {});
  NodeLattice nodes = even_nodes(64, 64, 16, 16);
};

TEST_F(AddedMethod, RunsLikeTheOthers) {
  const PixelVectors found = measure(scene, nodes, options());
  for (const auto& d : found.displacement) EXPECT_EQ(d, (std::array<float, 2>{1.5f, -2.0f}));
  for (const VectorStatus s : found.status) EXPECT_EQ(s, VectorStatus::valid);
}

TEST_F(AddedMethod, IsOfferedAndReadByACase) {
  const auto& sections = app::case_sections();
  const auto section = std::find_if(sections.begin(), sections.end(), [](const auto& s) { return s.path == "piv"; });
  ASSERT_NE(section, sections.end());
  const auto key =
      std::find_if(section->keys.begin(), section->keys.end(), [](const auto& k) { return k.key == "method"; });
  ASSERT_NE(key, section->keys.end());
  EXPECT_NE(key->allowed.find("constant"), std::string::npos);
  const app::Case c = app::parse_case("[frames]\npath = \"*.png\"\n[piv]\nmethod = \"constant\"\n", "case.toml",
                                      ".");
  ASSERT_TRUE(c.piv);
  EXPECT_EQ(c.piv->method, "constant");
}

TEST_F(AddedMethod, IsHeldToWhatItDemands) {
  PivOptions o = options();
  o.anchor = Anchor::forward;
  EXPECT_THROW(measure(scene, nodes, o), InputError);
  o = options(), o.window_px = 16;
  EXPECT_THROW(measure(scene, nodes, o), InputError);
  const std::vector<std::uint8_t> mask(64 * 64, 1);
  EXPECT_THROW(measure(scene, nodes, options(), 1, {mask.data(), 64, 64, 64}), InputError);
}

TEST(Methods, EachSaysWhatItIsAndCanBeMade) {
  for (const PivMethod& method : piv_methods()) {
    SCOPED_TRACE(method.name);
    EXPECT_FALSE(method.text.empty());
    EXPECT_FALSE(method.anchors.empty());
    PivOptions options;
    options.method = method.name;
    EXPECT_NO_THROW(PairCorrelator(options, even_nodes(128, 128, 16, 32), 128, 128, 1));
  }
}

}  // namespace
}  // namespace pivnp::piv

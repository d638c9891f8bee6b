// The short form of the table of sequences; `sequence_table` prints all of it.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/piv_sequence_rows.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::piv {
namespace {

constexpr int seed = 4711;

TEST(Sequences, TheDefaultMeetsTheShortForm) {
  for (const SequenceRow& row : sequence_rows()) {
    if (!row.brief) continue;
    for (const SequenceFigure& f : row.measure({}, seed, 2)) {
      char asked[32], reached[32];
      std::snprintf(asked, sizeof asked, "%s %.4f", f.at_least ? ">=" : "<=", f.limit);
      std::snprintf(reached, sizeof reached, "%.4f", f.value);
      test::verification_row("sequence, " + row.name + ": " + f.name, asked, reached);
      EXPECT_TRUE(f.met()) << row.name << ": " << f.name << ": asked " << asked << ", reached " << reached;
    }
  }
}

// The generator by itself: what it draws is where its map says.
TEST(Sequences, TextureIsDrawnWhereTheMapCarriesIt) {
  Sequence s{.frames = 3, .seed = seed};
  s.width = s.height = 96;
  s.place = sequence::uniform(3, -2);
  const Image before = draw(s, 0), after = draw(s, 2);
  for (int r = 10; r < 80; ++r)
    for (int c = 0; c < 80; ++c)
      ASSERT_NEAR(after.view().row<std::uint8_t>(r - 4)[c + 6], before.view().row<std::uint8_t>(r)[c], 1);
}

TEST(Sequences, MapsAreTurnedBack) {
  Sequence s;
  for (const auto& map : {std::function<Vec2(const Vec2&, int)>(sequence::band(s, .5, 8)),
                          std::function<Vec2(const Vec2&, int)>(sequence::vortex(s, 2, 80)),
                          std::function<Vec2(const Vec2&, int)>(sequence::extension(s, .003))}) {
    s.place = map;
    const Vec2 X(300, 231);
    EXPECT_LT((sequence::origin(s, s.place(X, 12), 12) - X).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace pivnp::piv

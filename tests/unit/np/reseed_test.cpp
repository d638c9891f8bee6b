// Births: where material flows in, and where it does not.
#include <gtest/gtest.h>

#include <set>

#include "pivnp/np/reseed.hpp"
#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

const Grid grid{{0, 0}, {1, 1}, 11, 6};

VectorField flow(double dx) {
  return vector_field(sample_increments(AffineMotion::rotation(0, {0, 0}, {dx, 0}), grid, Anchor::central, 0, 1), {0, 1});
}

TEST(Reseed, KeepsAWindowFullThroughWhichMaterialFlows) {
  Tracker tracker({}, block(grid, {0, 0}, {10, 5}, 4), 0);
  Reseeder reseeder(grid, 4, SeedPattern::even, tracker);
  std::set<std::int64_t> ids(tracker.particles().id.begin(), tracker.particles().id.end());
  std::size_t born = 0;
  for (int k = 1; k <= 40; ++k) {
    const VectorField field = flow(0.3);
    tracker.step(field, k);
    const ParticleSet more = reseeder.births(tracker, field);
    for (std::size_t p = 0; p < more.size(); ++p) {
      EXPECT_EQ(more.born[p], k);
      EXPECT_LT(more.x0[p].x(), 1);  // only in the column where it enters
      EXPECT_TRUE(ids.insert(more.id[p]).second) << "an id twice";
      EXPECT_EQ(more.label[p], 0);
    }
    born += more.size();
    if (more.size() > 0) tracker.add(more);
    std::vector<int> held(grid.element_count(), 0);
    ElementPoint at;
    for (std::size_t p = 0; p < tracker.state().size(); ++p)
      if (tracker.state()[p].status == ParticleStatus::active && locate(grid, tracker.state()[p].x, at))
        ++held[grid.element(at.i, at.j)];
    for (std::size_t e = 0; e < held.size(); ++e) EXPECT_GT(held[e], 0) << "element " << e << " at " << k;
  }
  // 12 spacings of flow through 5 rows of 4 particles a cell: 12 columns of 20, less what is still in the window.
  EXPECT_GE(born, 9u * 20);
  EXPECT_LE(born, 14u * 20);
  // Strains of the born count from birth, displacement from their own x0.
  const auto last = tracker.state()[tracker.state().size() - 1];
  EXPECT_LT((last.F - Mat2::Identity()).norm(), 1e-6);
}

TEST(Reseed, NotWhereTheMaterialHasGoneOrNeverWas) {
  Tracker tracker({}, block(grid, {0, 0}, {10, 2}, 4), 0);  // two rows; the rest is outside the region
  Reseeder reseeder(grid, 4, SeedPattern::gauss, tracker);
  for (int k = 1; k <= 20; ++k) {
    VectorField field = flow(0.3);
    for (int j = 0; j < grid.ny; ++j) field.status[grid.node(0, j)] = VectorStatus::replaced;
    for (int i = 0; i < grid.nx; ++i) field.status[grid.node(i, 0)] = VectorStatus::masked;
    tracker.step(field, k);
    const ParticleSet more = reseeder.births(tracker, field);
    for (const Vec2& x : more.x0) {
      EXPECT_GT(x.x(), 1);
      EXPECT_GT(x.y(), 1);
      EXPECT_LT(x.y(), 2);
    }
    if (more.size() > 0) tracker.add(more);
  }
}

TEST(Reseed, AParticleAddedLaterMovesLikeOneThatWaited) {
  ParticleSet set = particles_at({{3, 3}, {4, 2}});
  ParticleSet late = particles_at({{5, 3}}, 2);
  late.id = {7};
  ParticleSet all = set;
  all.id.push_back(7), all.label.push_back(0), all.x0.push_back({5, 3}), all.area.push_back(1), all.born.push_back(2);
  all.end.push_back(late.end[0]), all.end_reason.push_back(EndReason::none);
  Tracker added({}, set, 0), waited({}, all, 0);
  for (int k = 1; k <= 5; ++k) {
    added.step(flow(0.2), k);
    waited.step(flow(0.2), k);
    if (k == 2) added.add(late);
  }
  EXPECT_EQ(added.save(), waited.save());
}

}  // namespace
}  // namespace pivnp::np

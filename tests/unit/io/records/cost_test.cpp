// What a run took, and which nodes have no material before them, as the record states it.
#include "pivnp/core/particles/coverage.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "sample.hpp"
#include "same_record.hpp"

namespace pivnp::io {
namespace {

// Particles that fill the square of one cell about the grid's second node of the second row, and move a cell to the right.
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

ParticleSet square(const Grid& grid) {
  ParticleSet set;
  set.label_names = {"sand"};
  const Vec2 centre = grid.position(1, 1);
  for (int k = 0; k < 16; ++k) {
    set.id.push_back(k);
    set.label.push_back(0);
    set.x0.push_back(centre + Vec2((k % 4 - 1.5) / 4 * grid.spacing.x(), (k / 4 - 1.5) / 4 * grid.spacing.y()));
    set.area.push_back(grid.spacing.prod() / 16);
    set.born.push_back(0.0);
    set.end.push_back(nan);
    set.end_reason.push_back(EndReason::none);
  }
  return set;
}

void write(const std::filesystem::path& folder, const RunCost& cost, bool material) {
  const sample::Size size;
  RecordWriter w(folder, sample::head(size), false);
  for (std::size_t k = 0; k < size.pairs; ++k) w.add_pair(sample::pair(size, k));
  w.end_stage("piv", nullptr);
  w.set_frames(sample::frames(size));
  const Grid grid = sample::head(size).grid;
  const ParticleSet set = square(grid);
  w.begin_motion("np", set);
  for (std::size_t k = 0; k <= size.pairs; ++k) {
    MotionFrame f;
    f.time = sample::time(k);
    f.u.assign(set.size(), {float(double(k) * grid.spacing.x()), 0});
    f.F.assign(set.size(), {1, 0, 0, 1});
    f.status.assign(set.size(), ParticleStatus::active);
    w.add_frame("np", f);
  }
  w.end_stage("motion/np", &set);
  if (material) w.set_material("np");
  w.pack();
  w.set_cost(cost);
  w.finish();
}

TEST(RunCostInRecords, ComesBackAndLeavesTheDatasetsAlone) {
  const test::Scratch a, b;
  RunCost cost{{{"vectors", 2.5, 4.75, 3e8, 2.25}, {"mesh_study", 0.5, 0.25, 4e8, nan}}, 8e7, 1e7, "2 processors"};
  write(a.path, cost, true);
  write(b.path, {}, true);
  const RunCost back = RecordReader(a.path / "record.h5").cost();
  EXPECT_EQ(back.machine, "2 processors");
  EXPECT_EQ(back.before_bytes, 8e7);
  EXPECT_EQ(back.expected_bytes, 1e7);
  ASSERT_EQ(back.stages.size(), 2u);
  EXPECT_EQ(back.stages[0].name, "vectors");
  EXPECT_EQ(back.stages[0].wall_s, 2.5);
  EXPECT_EQ(back.stages[0].processor_s, 4.75);
  EXPECT_EQ(back.stages[0].peak_bytes, 3e8);
  EXPECT_EQ(back.stages[0].expected_s, 2.25);
  EXPECT_EQ(words_of(back.stages[1]), "mesh study");
  EXPECT_TRUE(std::isnan(back.stages[1].expected_s));
  EXPECT_TRUE(h5::Source(a.path / "record.h5").children("/cost/vectors").empty());  // attributes alone
}

TEST(Outside, NodesBeforeNoMaterialAreSoInTheRecord) {
  const test::Scratch marked, plain;
  write(marked.path, {}, true);
  write(plain.path, {}, false);
  const sample::Size size;
  const RecordReader with(marked.path / "record.h5"), without(plain.path / "record.h5");
  for (std::size_t k = 0; k < size.pairs; ++k) {
    const VectorField found = with.pair(k), before = without.pair(k);
    EXPECT_EQ(before.status, sample::pair(size, k).status);
    for (int j = 0; j < size.ny; ++j)
      for (int i = 0; i < size.nx; ++i) {
        const std::size_t n = found.grid.node(i, j);
        const bool material = i == int(k) + 1 && j == 1;
        EXPECT_EQ(found.status[n], before.status[n] == VectorStatus::masked || material ? before.status[n] : VectorStatus::outside)
            << k << ": " << i << ", " << j;
        EXPECT_FALSE(!material && usable(found.status[n]));
      }
  }
}

}  // namespace
}  // namespace pivnp::io

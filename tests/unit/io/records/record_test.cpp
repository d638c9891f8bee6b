// What goes in comes out: every array bit by bit.
#include <fstream>

#include "gmock/gmock.h"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

using sample::message_of;
using sample::same_bits;
using ::testing::HasSubstr;

using RecordTest = sample::OfARecord;

void expect_same(const VectorField& a, const VectorField& b) {
  EXPECT_EQ(a.pair, b.pair);
  EXPECT_EQ(a.anchor, b.anchor);
  EXPECT_TRUE(a.grid == b.grid);
  EXPECT_TRUE(same_bits(a.displacement, b.displacement));
  EXPECT_TRUE(same_bits(a.status, b.status));
  EXPECT_TRUE(same_bits(a.cov, b.cov));
  EXPECT_TRUE(same_bits(a.score, b.score));
  EXPECT_TRUE(same_bits(a.path_factor, b.path_factor));
}

void expect_same(const MotionFrame& a, const MotionFrame& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_TRUE(same_bits(a.u, b.u));
  EXPECT_TRUE(same_bits(a.F, b.F));
  EXPECT_TRUE(same_bits(a.status, b.status));
  EXPECT_TRUE(same_bits(a.cov_u, b.cov_u));
  EXPECT_TRUE(same_bits(a.v, b.v));
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (const FieldValues& field : a.fields) EXPECT_TRUE(same_bits(field.values, b.field(field.field->name).values));
}

TEST_F(RecordTest, VectorsComeBackFromOpenAndClosedSegmentsAndFromTheRecord) {
  size.pairs = 150;  // three segments, the last one open
  {
    RecordWriter w(directory.path, sample::head(size), false);
    for (std::size_t k = 0; k < size.pairs; ++k) {
      w.add_pair(sample::pair(size, k));
      if (w.segment_full("piv")) w.close_segment("piv", {});
    }
    for (const std::size_t k : {149ul, 0ul, 63ul, 64ul, 127ul, 128ul}) expect_same(w.pair(k), sample::pair(size, k));
    w.end_stage("piv", nullptr);
    w.finish();
    expect_same(w.pair(77), sample::pair(size, 77));
  }
  const RecordReader r(record);
  ASSERT_EQ(r.pair_count(), size.pairs);
  for (std::size_t k = 0; k < size.pairs; ++k) expect_same(r.pair(k), sample::pair(size, k));
  EXPECT_FALSE(std::filesystem::exists(directory.path / "parts"));
  EXPECT_TRUE(r.motion_names().empty());
  EXPECT_FALSE(r.comparison());
  EXPECT_TRUE(r.frames().empty());
  EXPECT_TRUE(r.energy().empty());
}

TEST_F(RecordTest, HeadFramesMotionsEnergyAndComparisonComeBack) {
  sample::run(directory.path, size, false);
  const RecordReader r(record);
  const RecordHead h = r.head(), expected = sample::head(size);
  EXPECT_EQ(h.command, expected.command);
  EXPECT_EQ(h.case_text, expected.case_text);
  EXPECT_EQ(h.length_unit, "m");
  EXPECT_EQ(h.time_unit, "s");
  EXPECT_TRUE(h.grid == expected.grid);
  EXPECT_TRUE(h.world_from_pixel == expected.world_from_pixel);
  EXPECT_EQ(h.camera_residual, expected.camera_residual);
  EXPECT_EQ(h.metres_per_pixel, expected.metres_per_pixel);
  EXPECT_EQ(r.written_by().version, build_info().version);
  EXPECT_EQ(r.written_by().commit, build_info().commit);
  EXPECT_EQ(r.written_by().libraries, build_info().libraries);

  const std::vector<Frame> frames = sample::frames(size);
  ASSERT_EQ(r.frames().size(), frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(r.frames()[k].name, frames[k].name);
    EXPECT_EQ(r.frames()[k].time, frames[k].time);
    EXPECT_EQ(r.frames()[k].flag, frames[k].flag);
  }

  EXPECT_EQ(r.motion_names(), (std::vector<std::string>{"np", "mpm"}));  // in the order they were begun
  for (const bool simulated : {false, true}) {
    const auto motion = r.motion(simulated ? "mpm" : "np");
    const ParticleSet& p = motion->particles();
    const ParticleSet q = sample::particles_at_end(size);
    EXPECT_EQ(p.id, q.id);
    EXPECT_EQ(p.label, q.label);
    EXPECT_EQ(p.x0, q.x0);
    EXPECT_EQ(p.area, q.area);
    EXPECT_EQ(p.born, q.born);
    EXPECT_TRUE(same_bits(p.end, q.end));
    EXPECT_EQ(p.end_reason, q.end_reason);
    EXPECT_EQ(p.label_names, q.label_names);
    ASSERT_EQ(motion->times().size(), size.pairs + 1);
    for (const std::size_t k : {5ul, 0ul, 3ul}) {
      MotionFrame f = motion->frame(k), g = sample::frame(size, k, simulated);
      g.u[0][0] = f.u[0][0];  // carries the sample engine's state
      expect_same(f, g);
      EXPECT_EQ(f.cov_u.empty(), simulated);
      EXPECT_EQ(f.find("stress") != nullptr, simulated);
    }
  }

  const std::vector<EnergyRow> rows = r.energy();
  ASSERT_EQ(rows.size(), size.pairs + 1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const EnergyRow e = sample::energy(k);
    EXPECT_EQ(std::memcmp(&rows[k], &e, sizeof e), 0);
  }

  const Reactions reactions = r.reactions();
  ASSERT_EQ(reactions.time.size(), size.pairs + 1);
  ASSERT_EQ(reactions.series.size(), 2u);
  EXPECT_EQ(reactions.series[0].name, "boundary.base_left");  // '/' is HDF5's
  EXPECT_TRUE(reactions.series[0].displacement.empty());
  EXPECT_TRUE(std::isnan(reactions.series[0].force[0].x()));
  const ReactionSeries& plate = reactions.series[1];
  for (std::size_t k = 1; k <= size.pairs; ++k) {
    EXPECT_NEAR(reactions.series[0].force[k].y(), -3.0 / 0.02, 1e-9);
    EXPECT_NEAR(reactions.series[0].moment[k], 0.25 / 0.02, 1e-9);
    EXPECT_NEAR(plate.force[k].x(), double(2 * k - 1) / 0.02, 1e-9);
    EXPECT_EQ(plate.displacement[k].x(), 0.01 * double(k));
    EXPECT_EQ(plate.turn[k], 0.125);
  }

  const Comparison c = r.comparison().value(), d = sample::comparison(size);
  EXPECT_EQ(c.names, d.names);
  ASSERT_EQ(c.metrics.size(), d.metrics.size());
  for (std::size_t k = 0; k < c.metrics.size(); ++k) {
    EXPECT_EQ(c.metrics[k].name, d.metrics[k].name);
    EXPECT_EQ(c.metrics[k].value, d.metrics[k].value);
    EXPECT_EQ(c.metrics[k].unit, d.metrics[k].unit);
    EXPECT_EQ(c.metrics[k].definition, d.metrics[k].definition);
    EXPECT_EQ(c.metrics[k].verdict, d.metrics[k].verdict);
    EXPECT_EQ(c.metrics[k].lost_in, d.metrics[k].lost_in);
    EXPECT_EQ(c.metrics[k].limit, d.metrics[k].limit);
  }
  EXPECT_EQ(c.metrics[0].numerical, d.metrics[0].numerical);
  EXPECT_TRUE(std::isnan(c.metrics[0].input));
  EXPECT_EQ(c.metrics[0].uncertainty, d.metrics[0].uncertainty);
  EXPECT_TRUE(std::isnan(c.metrics[1].uncertainty));
  ASSERT_EQ(c.fields.size(), 1u);
  EXPECT_EQ(c.fields[0].name, d.fields[0].name);
  EXPECT_EQ(c.fields[0].unit, d.fields[0].unit);
  EXPECT_EQ(c.fields[0].definition, d.fields[0].definition);
  EXPECT_EQ(c.fields[0].time, d.fields[0].time);
  EXPECT_EQ(c.fields[0].id, d.fields[0].id);
  EXPECT_TRUE(same_bits(c.fields[0].values, d.fields[0].values));
  ASSERT_EQ(c.tables.size(), 1u);
  EXPECT_EQ(c.tables[0].definition, d.tables[0].definition);
  ASSERT_EQ(c.tables[0].columns.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(c.tables[0].columns[k].name, d.tables[0].columns[k].name);
    EXPECT_EQ(c.tables[0].columns[k].unit, d.tables[0].columns[k].unit);
    EXPECT_EQ(c.tables[0].columns[k].definition, d.tables[0].columns[k].definition);
    EXPECT_EQ(c.tables[0].columns[k].values, d.tables[0].columns[k].values);
  }
  EXPECT_EQ(c.times(), d.tables[0].columns[0].values);
}

// Words of schema 1.1 are understood, those of a later version are none.
TEST(Verdicts, AreReadInTheWordsOfEveryVersion) {
  EXPECT_EQ(limit_fate_named("within limit"), LimitFate::met);
  EXPECT_EQ(limit_fate_named("over limit"), LimitFate::exceeded);
  EXPECT_EQ(limit_fate_named("exceeded"), LimitFate::exceeded);
  EXPECT_EQ(verdict_named("met"), Verdict::none);
  EXPECT_EQ(verdict_named("not distinguishable at this u_val"), Verdict::not_resolved);
  for (const auto& named : verdict_names) EXPECT_EQ(verdict_named(named.name), named.value);
  EXPECT_EQ(verdict_named("words of a later version"), Verdict::none);
}

TEST_F(RecordTest, AMotionOutlivesItsReader) {
  sample::run(directory.path, size, false);
  std::unique_ptr<MotionSource> motion;
  {
    const RecordReader r(record);
    motion = r.motion("np");
  }
  EXPECT_EQ(motion->frame(1).u[3], sample::frame(size, 1, false).u[3]);
}

TEST_F(RecordTest, ComputedFieldsAreThoseOfTheDerivedReader) {
  const std::vector<std::string> fields = {"strain_dev", "velocity_x", "strain_sum_xy", "plastic_dev", "mean_stress"};
  sample::run(directory.path, size, false, 64, [] {}, fields);
  const RecordReader r(record);
  const h5::Source source(record);
  for (const std::string motion : {"np", "mpm"}) {
    const auto m = r.motion(motion);
    DerivedReader derived(*m, true);
    for (const std::string& name : fields) {
      const std::string path = "/motion/" + motion + "/fields/" + name;
      const bool known = motion == "mpm" || (name != "plastic_dev" && name != "mean_stress");
      ASSERT_EQ(source.has(path), known) << path;
      if (!known) continue;
      const h5::Dataset d = source.dataset(path);
      d.expect({size.pairs + 1, size.particles});
      const std::vector<float> stored = d.all<float>();
      for (std::size_t k = 0; k <= size.pairs; ++k) {
        const std::vector<double> values = derived.values(name, k);
        for (std::size_t p = 0; p < size.particles; ++p) {
          const float expected = static_cast<float>(values[p]), found = stored[k * size.particles + p];
          EXPECT_TRUE(expected == found || (std::isnan(expected) && std::isnan(found))) << path << " " << k << " " << p;
        }
      }
    }
  }
  EXPECT_EQ(source.attribute_text("/motion/np/fields/velocity_x", "unit"), "m/s");
  EXPECT_EQ(source.attribute_text("/motion/mpm/fields/mean_stress", "unit"), "Pa");
}

TEST_F(RecordTest, WhatGoesWithStrainsComesBack) {
  StrainNote unknown, known;
  unknown.gauge_length = 0.012;
  known.gauge_length = 0.02, known.floor_source = StrainFloor::still_zone;
  known.floor_dev = 1e-3, known.floor_vol = 2e-4, known.floor_path = 0.03;
  for (const StrainNote& note : {unknown, known}) {
    {
      RecordWriter w(directory.path, sample::head(size), false);
      for (const std::string name : {"np", "mpm"}) {
        w.begin_motion(name, sample::particles(size));
        w.add_frame(name, sample::frame(size, 0, name == "mpm"));
        const ParticleSet p = sample::particles(size);
        w.end_stage("motion/" + name, &p);
      }
      w.pack();
      w.set_strain_note("np", note);
      EXPECT_THROW(w.set_strain_note("dic", note), std::logic_error);
      w.finish();
    }
    const RecordReader r(record);
    EXPECT_FALSE(r.strain_note("mpm"));
    const auto found = r.strain_note("np");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->gauge_length, note.gauge_length);
    EXPECT_EQ(found->floor_source, note.floor_source);
    EXPECT_EQ(std::isnan(found->floor_dev), std::isnan(note.floor_dev));
    if (std::isnan(note.floor_dev)) continue;
    EXPECT_EQ(found->floor_dev, note.floor_dev);
    EXPECT_EQ(found->floor_vol, note.floor_vol);
    EXPECT_EQ(found->floor_path, note.floor_path);
  }
}

TEST_F(RecordTest, WhatClosureSaidComesBack) {
  ClosureNote unchecked, agrees, repeated;
  unchecked.verdict = "not checked: fewer than five frames";
  agrees.verdict = "agrees", agrees.chains = {{0, 2}, {3, 5}}, agrees.strength = -0.1, agrees.threshold = 1;
  repeated = agrees;
  repeated.verdict = "repeated error", repeated.strength = 3.5;
  for (std::size_t n = 0; n < sample::head(size).grid.node_count(); ++n)
    repeated.repeated.push_back({1e-4f * float(n), 2e-4f, -1e-5f * float(n)});
  const auto write = [&](const ClosureNote* note) {
    RecordWriter w(directory.path, sample::head(size), false);
    w.add_pair(sample::pair(size, 0));
    w.end_stage("piv", nullptr);
    ClosureNote odd = repeated;
    odd.repeated.pop_back();
    EXPECT_THROW(w.set_closure(odd), std::logic_error);
    if (note != nullptr) w.set_closure(*note);
    w.finish();
  };
  write(nullptr);
  EXPECT_FALSE(RecordReader(record).closure());
  for (const ClosureNote& note : {unchecked, agrees, repeated}) {
    write(&note);
    const auto found = RecordReader(record).closure();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->verdict, note.verdict);
    EXPECT_EQ(found->chains, note.chains);
    EXPECT_EQ(found->strength, note.strength);
    EXPECT_EQ(found->threshold, note.threshold);
    EXPECT_TRUE(same_bits(found->repeated, note.repeated));
  }
}

TEST_F(RecordTest, WhatAFrameLacksIsNaNWhereOthersHaveIt) {
  {
    RecordWriter w(directory.path, sample::head(size), false);
    w.begin_motion("mpm", sample::particles(size));
    for (std::size_t k = 0; k < 4; ++k) {
      MotionFrame f = sample::frame(size, k, true);
      if (k != 2) std::erase_if(f.fields, [](const FieldValues& v) { return v.field->name == "stress"; });
      w.add_frame("mpm", f);
    }
    const ParticleSet p = sample::particles(size);
    w.end_stage("motion/mpm", &p);
    w.finish();
  }
  const auto m = RecordReader(record).motion("mpm");
  EXPECT_TRUE(std::isnan(m->frame(0).field("stress")(1, 0)));
  EXPECT_TRUE(std::isnan(m->frame(3).field("stress")(1, 0)));
  EXPECT_TRUE(same_bits(m->frame(2).field("stress").values, sample::frame(size, 2, true).field("stress").values));
}

TEST_F(RecordTest, LargeItemsAreSplitIntoChunksAndCloseSegmentsEarly) {
  const h5::Shape small = h5::chunk_shape(h5::Type::f32, {11, 2}, 64),
                  large = h5::chunk_shape(h5::Type::f32, {1'000'000, 2, 2}, 64);
  EXPECT_EQ(small, (h5::Shape{64, 11, 2}));
  EXPECT_EQ(large[0], 1u);
  EXPECT_LE(large[1] * 4 * sizeof(float), std::size_t{1} << 20);
  size.particles = 300'000;
  RecordWriter w(directory.path, sample::head(size), false);
  const MotionFrame f = sample::frame(size, 1, false);  // 11.1 MB
  const ParticleSet p = sample::particles(size);
  w.begin_motion("long", p);
  std::size_t count = 0;
  while (!w.segment_full("motion/long") && count < 64) {
    w.add_frame("long", f);
    ++count;
  }
  EXPECT_LT(count, 30u);
  EXPECT_GT(count, 15u);
}

TEST_F(RecordTest, ManyParticlesComeBack) {
  size.particles = 100'003;
  {
    RecordWriter w(directory.path, sample::head(size), false);
    const ParticleSet p = sample::particles(size);
    w.begin_motion("np", p);
    for (std::size_t k = 0; k < 2; ++k) w.add_frame("np", sample::frame(size, k, false));
    w.end_stage("motion/np", &p);
    w.finish();
  }
  const auto m = RecordReader(record).motion("np");
  expect_same(m->frame(1), sample::frame(size, 1, false));
  expect_same(m->frame(0), sample::frame(size, 0, false));
}

}  // namespace
}  // namespace pivnp::io

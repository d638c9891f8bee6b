// The list of recorded fields: a row that is added arrives in the record, its readers and its views, and the contract
// names every row.
#include "pivnp/core/particles/fields.hpp"

#include <fstream>
#include <regex>

#include "pivnp/core/particles/derived.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

/// A row for the time of a test.
struct Listed {
  explicit Listed(MotionField row) : field(motion_fields().add(std::move(row))) {}
  ~Listed() { motion_fields().remove_last(); }
  const MotionField& field;
};

// A view as other programs read it; the program reads no virtual dataset.
std::vector<float> viewed(const h5::Source& source, const std::string& path, std::size_t values) {
  std::vector<float> out(values);
  const hid_t id = H5Dopen2(source.id(), path.c_str(), H5P_DEFAULT);
  EXPECT_GE(H5Dread(id, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), 0) << path;
  H5Dclose(id);
  return out;
}

TEST(Fields, AnAddedOneArrivesInTheRecordItsReadersAndItsViews) {
  const sample::Size size;
  const test::Scratch directory;
  const std::filesystem::path record = directory.path / "record.h5";
  const Listed flux({.name = "flux", .unit = "L/T", .form = FieldForm::vector, .label = "flux of water",
                     .definition = "volume of water through the skeleton, per area and time"});
  const auto value = [](std::size_t k, std::size_t p, std::size_t c) { return sample::value(k, p, 70 + c); };
  {
    RecordWriter w(directory.path, sample::head(size), false);
    w.begin_motion("mpm", sample::particles(size));
    for (std::size_t k = 0; k < 3; ++k) {
      MotionFrame f = sample::frame(size, k, true);
      const std::span<float> values = f.add("flux", size.particles);
      for (std::size_t p = 0; p < size.particles; ++p)
        for (std::size_t c = 0; c < 2; ++c) values[2 * p + c] = value(k, p, c);
      w.add_frame("mpm", f);
    }
    const ParticleSet p = sample::particles(size);
    w.end_stage("motion/mpm", &p);
    w.set_output_fields({"flux_y", "strain_dev"});
    w.finish();
  }

  const std::unique_ptr<MotionSource> motion = RecordReader(record).motion("mpm");
  DerivedReader derived(*motion, true);
  const h5::Source source(record);
  const h5::Dataset stored = source.dataset("/motion/mpm/flux"), computed = source.dataset("/motion/mpm/fields/flux_y");
  stored.expect({3, size.particles, 2});
  const std::vector<float> all = computed.all<float>();
  for (std::size_t k = 0; k < 3; ++k) {
    const MotionFrame f = motion->frame(k);
    const std::vector<double> y = derived.values("flux_y", k);
    const std::vector<float> view = viewed(source, "/xdmf/motion/mpm/flux/00000" + std::to_string(k), 2 * size.particles);
    for (std::size_t p = 0; p < size.particles; ++p)
      for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_EQ(f.field("flux")(p, c), value(k, p, c));
        EXPECT_EQ(view[2 * p + c], value(k, p, c));
        if (c == 0 || f.status[p] == ParticleStatus::ended) continue;
        EXPECT_EQ(y[p], double(value(k, p, c)));
        EXPECT_EQ(all[k * size.particles + p], value(k, p, c));
      }
  }
  EXPECT_EQ(source.attribute_text("/motion/mpm/flux", "unit"), "m/s");
  EXPECT_EQ(source.attribute_text("/motion/mpm/fields/flux_y", "unit"), "m/s");
  EXPECT_EQ(derived_field("flux_x").definition, flux.field.definition);
  std::ifstream xdmf(directory.path / "record.xdmf");
  const std::string text{std::istreambuf_iterator<char>(xdmf), {}};
  EXPECT_NE(text.find("Attribute Name=\"flux\""), std::string::npos);
}

TEST(Fields, AMotionWithoutOneGivesNaNAndStoresNone) {
  const sample::Size size;
  const test::Scratch directory;
  const Listed suction({.name = "suction", .label = "suction", .definition = "pressure of the water below that of the air"});
  sample::run(directory.path, size, false, 64, [] {}, {"suction", "strain_dev"});
  const std::unique_ptr<MotionSource> motion = RecordReader(directory.path / "record.h5").motion("mpm");
  EXPECT_EQ(motion->frame(1).find("suction"), nullptr);
  EXPECT_TRUE(std::isnan(DerivedReader(*motion, true).values("suction", 1)[0]));
  const h5::Source source(directory.path / "record.h5");
  EXPECT_FALSE(source.has("/motion/mpm/suction"));
  EXPECT_FALSE(source.has("/motion/mpm/fields/suction"));
  EXPECT_TRUE(source.has("/motion/mpm/fields/strain_dev"));
}

TEST(Fields, TheFrameRefusesWhatIsNotListed) {
  MotionFrame f;
  EXPECT_THROW(f.add("no_such_field", 3), std::logic_error);
  EXPECT_THROW(f.add("u", 3), std::logic_error);
  EXPECT_THROW(f.field("stress"), std::logic_error);
}

// Name, type with shape, and unit of every array with a time axis stand in docs/format.md, in this order.
TEST(Fields, TheContractNamesEveryOne) {
  std::ifstream in(PIVNP_FORMAT_DOC);
  std::vector<std::array<std::string, 3>> stated, listed;
  const std::regex row(R"(\| (\w+) \| (\w\d \[T\]\[P\]\S*) \| (\S*) ?\|.*)");
  for (std::string line; std::getline(in, line);)
    if (std::smatch found; std::regex_match(line, found, row)) stated.push_back({found[1], found[2], found[3]});
  for (const MotionField& field : motion_fields()) {
    const std::string shape = field.form == FieldForm::tensor  ? "[2][2]"
                              : field.components() > 1 ? "[" + std::to_string(field.components()) + "]"
                                                       : "";
    listed.push_back({field.name, (field.form == FieldForm::code ? "u1 [T][P]" : "f4 [T][P]") + shape, field.unit});
  }
  EXPECT_EQ(stated, listed);
}

}  // namespace
}  // namespace pivnp::io

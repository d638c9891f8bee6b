// Records that other programs changed, or that a later version wrote: read as far as they can be, else one clear line.
#include <fstream>
#include <random>

#include "gmock/gmock.h"
#include "pivnp/core/particles/end_reason.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "pivnp/io/hdf5/probe.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

using sample::message_of;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

class ForeignRecord : public ::testing::Test {
 protected:
  ForeignRecord() {
    sample::run(there.path, size, false);
    fs::resize_file(file, fs::file_size(file) - seal_bytes);
  }
  // As another program would change it.
  template <class T> void set(const std::string& path, std::size_t index, T value) {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const h5::Handle dataset(H5Dopen2(id.get(), path.c_str(), H5P_DEFAULT), H5Dclose),
        space(H5Dget_space(dataset.get()), H5Sclose);
    const hid_t type = std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : sizeof(T) == 1 ? H5T_NATIVE_UINT8 : H5T_NATIVE_INT32;
    std::vector<T> all(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
    ASSERT_GE(H5Dread(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), 0);
    all.at(index) = value;
    ASSERT_GE(H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), 0);
  }
  void set_nodes(std::int64_t nx, std::int64_t ny) {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const h5::Handle grid(H5Gopen2(id.get(), "/grid", H5P_DEFAULT), H5Gclose);
    const h5::Handle a(H5Aopen(grid.get(), "nodes", H5P_DEFAULT), H5Aclose);
    const std::int64_t nodes[2] = {nx, ny};
    ASSERT_GE(H5Awrite(a.get(), H5T_NATIVE_INT64, nodes), 0);
  }
  void remove(const std::string& path) {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    ASSERT_GE(H5Ldelete(id.get(), path.c_str(), H5P_DEFAULT), 0);
  }
  // All that a report asks of a record.
  void read_all() const {
    const RecordReader reader(file);
    for (std::size_t k = 0; k < reader.pair_count(); ++k) reader.pair(k);
    for (const std::string& name : reader.motion_names()) {
      const auto motion = reader.motion(name);
      for (std::size_t k = 0; k < motion->times().size(); ++k) motion->frame(k);
      reader.strain_note(name);
    }
    reader.closure();
    reader.energy();
    reader.comparison();
  }
  std::string fault() const {
    return message_of<InputError>([&] { read_all(); });
  }
  sample::Size size;
  test::Scratch there;
  const fs::path file = there.path / "record.h5";
};

TEST_F(ForeignRecord, CodesOfALaterVersionAreRead) {
  set<std::uint8_t>("/motion/np/end_reason", 2, 6);
  set<std::uint8_t>("/motion/np/status", 2, 9);
  set<std::uint8_t>("/piv/status", 1, 7);
  EXPECT_NO_THROW(read_all());
  const RecordReader reader(file);
  EXPECT_THAT(words(reader.motion("np")->particles().end_reason[2]), HasSubstr("6"));
  EXPECT_EQ(reader.motion("np")->frame(0).status[2], ParticleStatus::ended);
  EXPECT_FALSE(usable(reader.pair(0).status[1]));
}

TEST_F(ForeignRecord, PairsAreOfFramesThatAreThere) {
  set<std::int32_t>("/piv/pair", 3, 77);
  EXPECT_THAT(fault(), AllOf(StartsWith(file.string()), HasSubstr("/piv/pair"), HasSubstr("77")));
  set<std::int32_t>("/piv/pair", 3, -1);
  EXPECT_THAT(fault(), HasSubstr("-1"));
  remove("/frames");
  EXPECT_THAT(fault(), HasSubstr("-1"));
  set<std::int32_t>("/piv/pair", 3, 1);
  EXPECT_NO_THROW(read_all());
}

TEST_F(ForeignRecord, NodesAreWithinReason) {
  for (const auto& [nx, ny] : {std::pair<std::int64_t, std::int64_t>{2'000'000'000, 2'000'000'000}, {-7, 4}, {1LL << 40, 1}}) {
    set_nodes(nx, ny);
    EXPECT_THAT(fault(), HasSubstr("'nodes'"));
  }
  set_nodes(30000, 30000);  // refused by the shape of the vectors, before there is room for so many
  EXPECT_THAT(fault(), HasSubstr("[5, 30000, 30000, 2]"));
}

TEST_F(ForeignRecord, TimesAscendAndPlacesAreFinite) {
  set<double>("/motion/np/x0", 3, std::numeric_limits<double>::infinity());
  EXPECT_THAT(fault(), AllOf(HasSubstr("/motion/np"), HasSubstr("5000000003")));
  set<double>("/motion/np/time", 2, 0.0);
  EXPECT_THAT(fault(), AllOf(HasSubstr("/motion/np/time"), HasSubstr("item 2")));
}

TEST_F(ForeignRecord, LabelsHaveNames) {
  set<std::int32_t>("/motion/np/label", 1, 2);
  EXPECT_THAT(fault(), AllOf(HasSubstr("5000000003"), HasSubstr("label 2")));
}

// Damaged metadata may crash the HDF5 library or keep it busy for ever: not in this process. Bytes of structure (not of
// values) are what it stumbles over, so all kinds of places are tried.
TEST_F(ForeignRecord, DamagedStructureIsOneLineOrHarmless) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const auto bytes = static_cast<std::size_t>(fs::file_size(file));
  std::string whole(bytes, '\0');
  std::ifstream(file, std::ios::binary).read(whole.data(), static_cast<std::streamsize>(bytes));
  int refused = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::string text = whole;
    for (int k = 0; k < 1 + int(random() % 20); ++k) text[random() % (trial % 2 ? bytes : 4096)] = char(random());
    std::ofstream(file, std::ios::binary) << text;
    try {
      read_all();
    } catch (const InputError& error) {
      ++refused;
      EXPECT_THAT(error.what(), StartsWith(file.string()));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(refused, 0);
}

// One item of 3.5 GB, never written, in a file that is large enough to be believed: it is not made room for.
TEST_F(ForeignRecord, MemoryIsNotGivenOutOnTheWordOfANumber) {
  {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const hsize_t known[2] = {1, 2 << 20}, absurd[2] = {1, 7ull << 29};
    const std::vector<char> values(known[1], 'v');
    for (const auto& [name, shape] : {std::pair{"/motion/np/known", known}, {"/motion/np/more", absurd}}) {
      const h5::Handle space(H5Screate_simple(2, shape, nullptr), H5Sclose);
      const h5::Handle dataset(H5Dcreate2(id.get(), name, H5T_STD_U8LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
      ASSERT_TRUE(dataset);
      if (shape == known) {
        ASSERT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
      }
    }
  }
  const std::string line = fault();
  EXPECT_THAT(line, StartsWith(file.string()));
  EXPECT_EQ(line.find('\n'), line.npos);
}

// What it holds may not lie in other files, which it would have opened and shown as its own. A seal changes nothing:
// anyone can make one.
class Elsewhere : public ForeignRecord, public ::testing::WithParamInterface<bool> {
 protected:
  std::string line() const {
    if (GetParam()) {
      EXPECT_EQ(append_seal(file), 0);
      EXPECT_EQ(seal_of(file), Seal::intact);
    }
    return fault();
  }
  void add(const char* kind) {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    if (kind == std::string("link")) {
      ASSERT_GE(H5Lcreate_external("other.h5", "/u", id.get(), "/motion/np/more", H5P_DEFAULT, H5P_DEFAULT), 0);
      return;
    }
    const hsize_t four = 4;
    const h5::Handle space(H5Screate_simple(1, &four, nullptr), H5Sclose), properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    if (kind == std::string("virtual"))
      ASSERT_GE(H5Pset_virtual(properties.get(), space.get(), "other.h5", "/u", space.get()), 0);
    else
      ASSERT_GE(H5Pset_external(properties.get(), "other.h5", 0, 32), 0);
    const h5::Handle dataset(
        H5Dcreate2(id.get(), "/motion/np/more", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
    ASSERT_TRUE(dataset);
  }
};

TEST_P(Elsewhere, VirtualDatasetsAreRefusedByName) {
  add("virtual");
  EXPECT_THAT(line(), AllOf(StartsWith(file.string()), HasSubstr("/motion/np/more"), HasSubstr("other.h5")));
}

TEST_P(Elsewhere, ExternalDatasetsAreRefusedByName) {
  add("external");
  EXPECT_THAT(line(), AllOf(StartsWith(file.string()), HasSubstr("/motion/np/more"), HasSubstr("other.h5")));
}

TEST_P(Elsewhere, ExternalLinksAreRefusedByName) {
  add("link");
  EXPECT_THAT(line(), AllOf(StartsWith(file.string()), HasSubstr("/motion/np/more")));
}

// Filters other than the three that records use are code that nobody needs, or a library to load.
TEST_P(Elsewhere, FiltersAreOnAList) {
  {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const hsize_t shape = 300, chunk = 60;
    const h5::Handle space(H5Screate_simple(1, &shape, nullptr), H5Sclose), properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(properties.get(), 1, &chunk);
    H5Pset_scaleoffset(properties.get(), H5Z_SO_INT, 0);
    const std::vector<std::int32_t> values(shape, 9);
    const h5::Handle dataset(
        H5Dcreate2(id.get(), "/motion/np/more", H5T_STD_I32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
    ASSERT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  }
  EXPECT_THAT(line(), AllOf(StartsWith(file.string()), HasSubstr("/motion/np/more"), HasSubstr("filter 6")));
}

// A dataset that shows itself has no values; HDF5 follows it until its stack is full.
TEST_P(Elsewhere, ValuesThatShowThemselvesAreNotRead) {
  remove("/piv/pair");
  {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const hsize_t shape[2] = {size.pairs, 2};
    const h5::Handle space(H5Screate_simple(2, shape, nullptr), H5Sclose), properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    ASSERT_GE(H5Pset_virtual(properties.get(), space.get(), ".", "/piv/pair", space.get()), 0);
    const h5::Handle dataset(
        H5Dcreate2(id.get(), "/piv/pair", H5T_STD_I32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
    ASSERT_TRUE(dataset);
  }
  EXPECT_THAT(line(), AllOf(StartsWith(file.string()), HasSubstr("/piv/pair"), HasSubstr("elsewhere")));
}

INSTANTIATE_TEST_SUITE_P(SealedOrNot, Elsewhere, ::testing::Bool());

// Nor do sealed segments of a folder to resume lead anywhere.
TEST(Segments, ThatShowAnotherFileAreComputedAgain) {
  test::Scratch there;
  sample::Size size;
  size.pairs = 12;
  {
    RecordWriter w(there.path, sample::head(size), false);
    for (std::size_t k = 0; k < size.pairs; ++k) {
      w.add_pair(sample::pair(size, k));
      if (k % 6 == 5) w.close_segment("piv", {std::byte(k)});
    }
  }
  const fs::path segment = there.path / "parts" / "piv.00000006.h5";
  fs::resize_file(segment, fs::file_size(segment) - seal_bytes);
  {
    const h5::Handle id(H5Fopen(segment.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    ASSERT_GE(H5Lcreate_external("/dev/null", "/", id.get(), "/more", H5P_DEFAULT, H5P_DEFAULT), 0);
  }
  ASSERT_EQ(append_seal(segment), 0);
  RecordWriter again(there.path, sample::head(size), true);
  EXPECT_EQ(again.stage("piv").items, 6u);
}

TEST_F(ForeignRecord, NumbersOfASizeBeyondTheFileAreRefused) {
  {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const hsize_t huge[2] = {1ull << 32, 1ull << 20}, chunk[2] = {1, 1024};
    const h5::Handle space(H5Screate_simple(2, huge, nullptr), H5Sclose), properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(properties.get(), 2, chunk);
    const h5::Handle dataset(
        H5Dcreate2(id.get(), "/motion/np/more", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
    ASSERT_TRUE(dataset);
  }
  EXPECT_THAT(fault(), HasSubstr("/motion/np/more"));
}

}  // namespace
}  // namespace pivnp::io

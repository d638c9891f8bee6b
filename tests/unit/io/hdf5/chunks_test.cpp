// Chunks packed by our threads are what HDF5's own filters read.
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "gtest/gtest.h"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::io::h5 {
namespace {

// Value k of a series.
template <class T>
std::vector<T> values(std::size_t count) {
  std::vector<T> v(count);
  for (std::size_t k = 0; k < count; ++k) v[k] = T(std::sin(0.01 * double(k)) * 100);
  return v;
}

struct Piece {
  std::size_t first, count;
};

// Writes the pieces of a series with `threads`, reads all of it; what was not written is NaN or 0.
template <class T>
void round_trip(const Shape& item, std::size_t items, const std::vector<Piece>& pieces, int threads) {
  const test::Scratch directory;
  const std::filesystem::path path = directory.path / "a.h5";
  const std::size_t per_item = product(item);
  const std::vector<T> all = values<T>(items * per_item);
  std::vector<bool> written(items, false);
  {
    OutputFile out(path, threads);
    {
      Dataset series = out.series("/a", TypeOf<T>::value, item, items, false, "", Packing::deflated);
      for (const Piece& p : pieces) {
        out.write_items(series, TypeOf<T>::value, p.first, p.count, all.data() + p.first * per_item);
        for (std::size_t k = p.first; k < p.first + p.count; ++k) written[k] = true;
      }
    }
    out.commit();
  }
  const Dataset back = Source(path).dataset("/a");
  const std::vector<T> read = back.all<T>();
  ASSERT_EQ(read.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (written[k / per_item])
      ASSERT_EQ(read[k], all[k]) << k;
    else if constexpr (std::is_floating_point_v<T>)
      ASSERT_TRUE(std::isnan(read[k])) << k;
    else
      ASSERT_EQ(read[k], T(0)) << k;
  }
}

TEST(Chunks, SmallItemsInPiecesThatDoNotFitTheChunks) {
  for (const int threads : {1, 3}) {
    round_trip<float>({100, 2}, 150, {{0, 64}, {64, 64}, {128, 22}}, threads);
    round_trip<double>({2000}, 70, {{0, 5}, {5, 30}, {35, 1}, {36, 34}}, threads);
    round_trip<std::uint8_t>({5000}, 100, {{3, 60}, {70, 30}}, threads);
    round_trip<std::int64_t>({7, 3}, 10, {{0, 10}}, threads);
  }
}

TEST(Chunks, LargeItemsAreSplitWithALastPieceThatIsShorter) {
  round_trip<float>({100'003, 4}, 3, {{0, 2}}, 2);
  round_trip<std::uint8_t>({3'000'001}, 2, {{0, 1}, {1, 1}}, 2);
}

// A chunk that is packed before the series has filled it holds the fill value where items come later, or never.
TEST(Chunks, AGrowingSeriesIsNotANumberWhereNothingWasWritten) {
  const test::Scratch directory;
  const std::filesystem::path path = directory.path / "a.h5";
  const std::size_t length = 1000;
  const std::vector<float> all = values<float>(9 * length);
  {
    OutputFile out(path, 2);
    {
      Dataset series = out.series("/a", Type::f32, {length}, 0, true, "", Packing::deflated);
      out.extend(series, 5);
      out.write_items(series, Type::f32, 0, 5, all.data());
      out.extend(series, 9);
      out.write_items(series, Type::f32, 8, 1, all.data() + 8 * length);
    }
    out.commit();
  }
  const std::vector<float> read = Source(path).dataset("/a").all<float>();
  ASSERT_EQ(read.size(), all.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    if (k / length < 5 || k / length == 8)
      ASSERT_EQ(read[k], all[k]) << k;
    else
      ASSERT_TRUE(std::isnan(read[k])) << k;
  }
}

TEST(Chunks, RandomPieces) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 8; ++round) {
    const std::size_t items = 1 + random() % 200, length = 1 + random() % 4000;
    std::vector<Piece> pieces;
    for (std::size_t k = 0; k < items;) {
      const std::size_t count = std::min<std::size_t>(items - k, 1 + random() % 70);
      if (random() % 5 != 0) pieces.push_back({k, count});
      k += count;
    }
    round_trip<float>({length}, items, pieces, 1 + int(random() % 3));
  }
}

TEST(Chunks, TheFileDoesNotDependOnTheThreads) {
  const test::Scratch directory;
  const std::vector<float> all = values<float>(1'200'000);
  std::vector<std::string> bytes;
  for (const int threads : {1, 2, 5}) {
    const std::filesystem::path path = directory.path / (std::to_string(threads) + ".h5");
    OutputFile out(path, threads);
    {
      Dataset series = out.series("/a", Type::f32, {300'000}, 3, false, "", Packing::deflated);
      out.write_items(series, Type::f32, 0, 3, all.data());
    }
    out.write("/whole", Type::f32, {400'000, 3}, all.data(), "m", Packing::deflated);
    out.commit();
    std::ifstream file(path, std::ios::binary);
    bytes.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  EXPECT_LT(bytes[0].size(), all.size() * 2 * sizeof(float));  // packed
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[0], bytes[2]);
}

}  // namespace
}  // namespace pivnp::io::h5

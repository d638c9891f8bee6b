// XXH64 against its reference values (xxHash's own program), and against cutting the bytes anyhow.
#include <gtest/gtest.h>

#include <random>

#include "pivnp/core/hash.hpp"

namespace pivnp {
namespace {

TEST(Hash, IsTheOneOfTheSpecification) {
  EXPECT_EQ(hexadecimal(hash64("")), "ef46db3751d8e999");
  EXPECT_EQ(hexadecimal(hash64("a")), "d24ec4f1a98c6e5b");
  EXPECT_EQ(hexadecimal(hash64("abc")), "44bc2cf5ad770999");
  EXPECT_EQ(hexadecimal(hash64("Nobody inspects the spammish repetition")), "fbcea83c8a378bf1");
}

TEST(Hash, DoesNotDependOnThePieces) {
  std::mt19937 random(7);
  std::string bytes(1000, '\0');
  for (char& c : bytes) c = char(random());
  for (int trial = 0; trial < 50; ++trial) {
    Hash64 hash;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t some = std::min<std::size_t>(random() % 80, bytes.size() - at);
      hash.add(bytes.data() + at, some);
      at += some;
    }
    EXPECT_EQ(hash.value(), hash64(bytes));
  }
}

}  // namespace
}  // namespace pivnp

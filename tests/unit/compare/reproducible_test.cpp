// The same comparison gives the same bits wherever its memory lies.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <random>
#include <utility>

#include "tests/unit/compare/scattered.hpp"

// This program's memory: where `perturbed`, what is neither small nor large gets a place of one arena in an order of chance,
// so that what was asked for later lies before what was asked for earlier as often as not.
namespace {

constexpr std::size_t place_bytes = 1 << 14, places = 4096, least_bytes = 256;
alignas(64) char arena[places * place_bytes];
std::uint16_t free_places[places];
std::size_t free_count = 0, given_once = 0;
bool perturbed = false;

void perturb(unsigned seed) {
  for (; given_once < places; ++given_once) free_places[free_count++] = std::uint16_t(given_once);
  std::minstd_rand random(seed);
  for (std::size_t k = free_count; k > 1; --k) std::swap(free_places[k - 1], free_places[random() % k]);
  perturbed = true;
}

void give_back(void* place) {
  const std::ptrdiff_t at = static_cast<char*>(place) - arena;
  if (at < 0 || at >= std::ptrdiff_t(sizeof arena)) return std::free(place);
  free_places[free_count++] = std::uint16_t(std::size_t(at) / place_bytes);
}

}  // namespace

void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  if (perturbed && bytes >= least_bytes && bytes <= place_bytes && free_count > 0)
    return arena + place_bytes * free_places[--free_count];
  return std::malloc(bytes > 0 ? bytes : 1);
}
void* operator new(std::size_t bytes) {
  if (void* place = operator new(bytes, std::nothrow)) return place;
  throw std::bad_alloc();
}
void operator delete(void* place) noexcept { give_back(place); }
void operator delete(void* place, std::size_t) noexcept { give_back(place); }
void operator delete(void* place, const std::nothrow_t&) noexcept { give_back(place); }

namespace pivnp::compare {
namespace {

void append(std::vector<unsigned char>& bytes, const auto& values) {
  if (values.empty()) return;
  const std::size_t size = values.size() * sizeof(values[0]);
  bytes.resize(bytes.size() + size);
  std::memcpy(bytes.data() + bytes.size() - size, values.data(), size);
}

// Every number of a comparison.
std::vector<unsigned char> bits(const Comparison& c) {
  std::vector<unsigned char> bytes;
  for (const Metric& m : c.metrics) append(bytes, std::vector<double>{m.value, m.uncertainty});
  for (const ComparisonTable& t : c.tables)
    for (const ComparisonTable::Column& column : t.columns) append(bytes, column.values);
  for (const ComparisonField& f : c.fields) append(bytes, f.time), append(bytes, f.id), append(bytes, f.values);
  return bytes;
}

// Neither set has the other's particles: everything is found between neighbours, at edges by the nearest one.
TEST(Reproducible, WhereverTheMemoryLies) {
  const auto bent = [](double more) {
    return [more](const Vec2& x, double t) -> Vec2 {
      return t * Vec2(0.05 * x.y() * x.y() + 0.1 * more, -0.1 * std::sin(x.x() + more));
    };
  };
  ParticleSet scattered = particles_at(jittered(3), 1);
  for (std::int64_t& id : scattered.id) id += 100000;
  const MotionMemory first = motion_of("fine", particles_at(square_lattice(21, 19, 0.5), 0.5), {0, 0.5, 1}, bent(0));
  const MotionMemory second = motion_of("scattered", scattered, {0, 0.4, 1}, bent(0.3));
  const auto expected = bits(compared(first, second)), other_way = bits(compared(second, first));
  ASSERT_GT(expected.size(), 5000u);
  for (unsigned trial = 1; trial <= 4; ++trial) {
    perturb(trial);
    const auto again = bits(compared(first, second)), other_way_again = bits(compared(second, first));
    perturbed = false;
    EXPECT_EQ(again, expected) << trial;
    EXPECT_EQ(other_way_again, other_way) << trial;
  }
}

// What is reproducible by its order: sides of kept triangles, those on their left.
TEST(Reproducible, BoundarySidesGoAnticlockwise) {
  const std::vector<Vec2> points = jittered(5);
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1.0));
  double twice_area = 0, of_triangles = 0;
  const auto cross = [&](int a, int b) {
    const Vec2 &p = points[std::size_t(a)], &q = points[std::size_t(b)];
    return p.x() * q.y() - p.y() * q.x();
  };
  for (const auto& [a, b] : mesh.boundary()) twice_area += cross(a, b);
  for (const auto& [a, b, c] : mesh.triangles()) of_triangles += cross(a, b) + cross(b, c) + cross(c, a);
  EXPECT_GT(of_triangles, 100);
  EXPECT_NEAR(twice_area, of_triangles, 1e-9);
}

}  // namespace
}  // namespace pivnp::compare

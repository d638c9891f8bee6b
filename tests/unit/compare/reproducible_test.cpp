// The same comparison gives the same bits wherever its memory lies.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <new>
#include <random>

#include "tests/unit/compare/scattered.hpp"

// This program's memory: where `perturbed`, each of two places is given out by chance, so that what was asked for later
// may lie before what was asked for earlier.
namespace {
bool perturbed = false;
std::minstd_rand choice(1);
}  // namespace

void* operator new(std::size_t bytes) {
  void* place = std::malloc(bytes > 0 ? bytes : 1);
  if (perturbed && place != nullptr && bytes >= 256) {
    void* other = std::malloc(bytes);
    if (other != nullptr && choice() % 2 == 0) std::swap(place, other);
    std::free(other);
  }
  if (place == nullptr) throw std::bad_alloc();
  return place;
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }

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
  perturbed = true;
  for (unsigned trial = 1; trial <= 4; ++trial) {
    choice.seed(trial);
    EXPECT_EQ(bits(compared(first, second)), expected) << trial;
    EXPECT_EQ(bits(compared(second, first)), other_way) << trial;
  }
  perturbed = false;
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

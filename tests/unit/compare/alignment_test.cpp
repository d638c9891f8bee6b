// Partners by identity and by material position: affine motions come out exactly, gaps and labels are respected.
#include "compare/alignment/partners.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pivnp/core/error.hpp"
#include "tests/unit/compare/motions.hpp"
#include "tests/unit/compare/scattered.hpp"

namespace pivnp::compare {
namespace {

const DisplacementLaw still = [](const Vec2&, double) { return Vec2(0, 0); };

TEST(MaterialMesh, WeightsReproduceThePoint) {
  const unsigned seed = 20240611;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3), place(0.5, 9.5);
  std::vector<Vec2> points = square_lattice(10, 10, 1);
  for (Vec2& p : points) p += Vec2(jitter(random), jitter(random));
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
  int inside = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec2 x(place(random), place(random));
    const auto found = mesh.find(x);
    if (!found) continue;
    Vec2 sum = found->beyond;
    double total = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GE(found->weight[c], 0);
      total += found->weight[c];
      if (found->vertex[c] >= 0) sum += found->weight[c] * points[std::size_t(found->vertex[c])];
    }
    EXPECT_NEAR(total, 1, 1e-14);
    EXPECT_NEAR((sum - x).norm(), 0, 1e-13);
    EXPECT_LT(found->beyond.norm(), 0.5);
    ++inside;
  }
  EXPECT_GT(inside, 1800);
}

TEST(MaterialMesh, SpansOneLostParticleButNoGap) {
  std::vector<Vec2> points;
  for (const Vec2& x : square_lattice(12, 6, 1)) {
    const bool lost = (x - Vec2(2.5, 2.5)).norm() < 0.1;
    const bool gap = x.x() > 6 && x.x() < 9;  // columns 6.5, 7.5, 8.5
    if (!lost && !gap) points.push_back(x);
  }
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
  EXPECT_TRUE(mesh.find(Vec2(2.5, 2.5)));
  EXPECT_TRUE(mesh.find(Vec2(5.9, 3.2)));   // 0.4 beyond the edge
  EXPECT_FALSE(mesh.find(Vec2(6.1, 3.2)));  // 0.6 beyond
  EXPECT_FALSE(mesh.find(Vec2(7.5, 3.2)));
  EXPECT_TRUE(mesh.find(Vec2(9.7, 3.2)));
  EXPECT_FALSE(mesh.find(Vec2(100, 100)));
}

TEST(MaterialMesh, LonePointsAreFoundWithinHalfASpacing) {
  const MaterialMesh mesh({Vec2(0, 0), Vec2(10, 0)}, {1, 1});
  EXPECT_TRUE(mesh.triangles().empty());
  const auto found = mesh.find(Vec2(10.3, 0.2));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->vertex[0], 1);
  EXPECT_EQ(found->weight[0], 1);
  EXPECT_NEAR((found->beyond - Vec2(0.3, 0.2)).norm(), 0, 1e-15);
  EXPECT_FALSE(mesh.find(Vec2(10.4, 0.4)));
}

TEST(MaterialMesh, MedianNeighbourDistance) {
  EXPECT_NEAR(median_neighbour_distance(square_lattice(7, 4, 0.25)), 0.25, 1e-15);
  EXPECT_NEAR(median_neighbour_distance({Vec2(0, 0), Vec2(3, 0), Vec2(6, 0)}), 3, 1e-15);  // all on one line
  EXPECT_EQ(median_neighbour_distance({Vec2(0, 0)}), 0);
}

// The motion is affine and large; both data sets sample it at their own points and times.
TEST(Alignment, AffineMotionBetweenTwoSeedingsIsExactIncludingTheEdge) {
  Mat2 A;
  A << 0.30, 0.20, -0.10, -0.15;
  const DisplacementLaw u = [&](const Vec2& x, double t) -> Vec2 { return t * (A * x + Vec2(0.5, -0.2)); };
  const GradientLaw F = [&](const Vec2&, double t) -> Mat2 { return Mat2::Identity() + t * A; };
  const MotionMemory first = motion_of("fine", particles_at(square_lattice(24, 12, 1.0 / 12), 1.0 / 12),
                                       {0, 0.3, 0.7, 1}, u, F);
  const MotionMemory second =
      motion_of("coarse", particles_at(square_lattice(14, 7, 1.0 / 7), 1.0 / 7), {0, 0.5, 1}, u, F);
  for (const auto& [a, b] : {std::pair{&first, &second}, std::pair{&second, &first}}) {
    const Comparison c = compared(*a, *b);
    EXPECT_EQ(metric(c, "coverage_first").value, 1);
    EXPECT_EQ(metric(c, "coverage_second").value, 1);
    EXPECT_LT(metric(c, "displacement_max").value, 1e-6);  // float storage
    EXPECT_LT(metric(c, "strain_dev_max").value, 1e-6);
    EXPECT_LT(metric(c, "strain_vol_rms").value, 1e-6);
    EXPECT_GT(metric(c, "displacement_peak_first").value, 0.5);
  }
}

// Partners renewed only where a particle was lost are those that a fresh start would find.
TEST(Alignment, RenewedPartnersAreThoseOfAFreshStart) {
  const ParticleSet fine = particles_at(square_lattice(24, 12, 1.0 / 12), 1.0 / 12);
  ParticleSet coarse = particles_at(jittered(3), 1);
  for (Vec2& x : coarse.x0) x = Vec2(x.x() / 5, x.y() / 10);
  coarse.area.assign(coarse.size(), float(0.02));
  const MotionMemory a = motion_of("a", fine, {0, 1}, still), b = motion_of("b", coarse, {0, 1}, still);
  const CommonTimes common = common_times(a, b);
  DataSet first(a, common), second(b, common);
  first.at(0), second.at(0);
  Alignment kept(first, second);
  ASSERT_FALSE(kept.by_identity());
  std::vector<std::uint8_t> followed(coarse.size(), 1);
  for (const std::size_t lost : {44U, 45U, 27U, 90U, 0U}) {
    followed[lost] = 0;
    kept.update(followed);
  }
  MotionFrame f = b.frame(0);
  for (std::size_t q = 0; q < followed.size(); ++q)
    if (!followed[q]) f.status[q] = ParticleStatus::ended;
  MotionMemory rest("b", "m", "s", coarse);
  rest.add(f);
  f.time = 1;
  rest.add(f);
  DataSet left(rest, common);
  left.at(0);
  const Alignment fresh(first, left);
  std::size_t partners = 0;
  for (std::size_t p = 0; p < fine.size(); ++p) {
    if (!has_partner(kept.partners()[p])) continue;
    ++partners;
    const std::vector<double> x = dense(kept.partners()[p], coarse.size()), y = dense(fresh.partners()[p], coarse.size());
    for (std::size_t q = 0; q < coarse.size(); ++q) EXPECT_NEAR(x[q], y[q], 1e-9);
  }
  EXPECT_GT(partners, fine.size() / 2);
}

TEST(Alignment, EqualIdsAtOtherPlacesAreNotIdentity) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  ParticleSet moved = set;
  for (Vec2& x : moved.x0) x += Vec2(0.25, 0);
  const DisplacementLaw u = [](const Vec2& x, double t) -> Vec2 { return Vec2(t * x.x(), 0); };
  const GradientLaw F = [](const Vec2&, double t) -> Mat2 { return Vec2(1 + t, 1).asDiagonal().toDenseMatrix(); };
  const Comparison c = compared(motion_of("a", set, {0, 1}, u, F), motion_of("b", moved, {0, 1}, u, F));
  EXPECT_LT(metric(c, "displacement_max").value, 1e-6);  // by id the difference would be 0.25
}

TEST(Alignment, IdentityNeedsNoOrderAndLeavesOutWhatTheOtherLacks) {
  const ParticleSet set = particles_at(square_lattice(5, 5, 1), 1);
  ParticleSet part;
  for (std::size_t p = 20; p-- > 0;) {  // the lower four rows, backwards
    part.id.push_back(set.id[p]);
    part.label.push_back(0);
    part.x0.push_back(set.x0[p]);
    part.area.push_back(1);
  }
  part.label_names = {"soil"};
  const DisplacementLaw u = [](const Vec2& x, double t) -> Vec2 { return t * Vec2(x.x() * x.y(), x.y()); };
  const Comparison c = compared(motion_of("a", set, {0, 1}, u), motion_of("b", part, {0, 1}, u));
  EXPECT_DOUBLE_EQ(metric(c, "coverage_first").value, 0.8);
  EXPECT_DOUBLE_EQ(metric(c, "coverage_second").value, 1);
  EXPECT_EQ(metric(c, "displacement_max").value, 0);
  ASSERT_EQ(c.fields[0].id.size(), 20U);
  EXPECT_EQ(c.fields[0].id.back(), 19);
  EXPECT_EQ(c.fields[0].values.size(), 40U);
}

TEST(Alignment, LabelsOfOneNamePairOnlyWithEachOther) {
  // Two layers that touch; the second data set numbers the names the other way round and is shifted by half a spacing.
  ParticleSet a = particles_at(square_lattice(8, 8, 1), 1), b = particles_at(square_lattice(8, 8, 1, Vec2(0.5, 0)), 1);
  a.label_names = {"sand", "clay"};
  b.label_names = {"clay", "sand"};
  for (std::size_t p = 0; p < 64; ++p) {
    a.label[p] = a.x0[p].y() < 4 ? 0 : 1;
    b.label[p] = b.x0[p].y() < 4 ? 1 : 0;
  }
  const DisplacementLaw slide = [](const Vec2& x, double t) { return Vec2(x.y() < 4 ? 0 : t, 0); };
  // Without labels the first's points would be interpolated across the slip; with them every layer is uniform.
  for (Vec2& x : a.x0) x.y() += x.y() < 4 ? 0.2 : -0.2;
  const MotionMemory first = motion_of("a", a, {0, 1}, slide), second = motion_of("b", b, {0, 1}, slide);
  EXPECT_LT(metric(compared(first, second), "displacement_max").value, 1e-12);

  ParticleSet nameless = b;
  nameless.label_names = {"layer 1", "layer 2"};
  const MotionMemory unlabelled = motion_of("c", nameless, {0, 1}, slide);
  EXPECT_NEAR(metric(compared(first, unlabelled), "displacement_max").value, 0.2, 1e-3);
}

TEST(Alignment, WithoutAreasTheSpacingIsMeasured) {
  ParticleSet a = particles_at(square_lattice(6, 6, 0.5), 0.5);
  ParticleSet b = particles_at(square_lattice(6, 6, 0.5, Vec2(0.2, 0)), 0.5);
  a.area.assign(a.size(), 0);
  b.area.clear();
  const Comparison c = compared(motion_of("a", a, {0, 1}, still), motion_of("b", b, {0, 1}, still));
  EXPECT_EQ(metric(c, "coverage_first").value, 1);
}

TEST(Alignment, NoPartnerAtAllIsAnError) {
  const MotionMemory a = motion_of("lab", particles_at(square_lattice(4, 4, 1), 1), {0, 1}, still);
  const MotionMemory b = motion_of("sim", particles_at(square_lattice(4, 4, 1, Vec2(50, 0)), 1), {0, 1}, still);
  try {
    compared(a, b);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("'lab'"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("'sim'"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace pivnp::compare

// Figure 2.6 of Alvarado (2018) (Pinyol & Alvarado 2017): a cubic polynomial read through five nodes by linear and by
// quadratic elements, and by linear elements on nine nodes. Here also the cubic element and the B-splines.
//   published: a drawing without numbers: (c) and (d) follow the function more closely than (b).
//   criterion: on [0, 1] the greatest error of linear elements is that of their chords and falls by at least 3 when the
//     spacing is halved; quadratic elements on five nodes are better than linear ones; cubic shapes repeat the
//     polynomial to round-off. With PIVNP_VERIFICATION_DIR set the figure is drawn there (figure_2_6.svg, .png).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "apps/plot/chart.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

// Turns twice on [0, 1].
double polynomial(double x) { return 16 * (x - 0.1) * (x - 0.5) * (x - 0.85) + 1; }

struct Line {
  std::vector<double> x, read, error;
  double worst = 0;
};

// The displacement u_x that particles along y = 1/2 read from nodes at 0, 1/cells ... 1.
Line read_line(ShapeFunctions shape, int cells) {
  constexpr double size = 1e-3;  // of the displacement: any
  const Grid grid{{0, 0}, {1.0 / cells, 1.0 / cells}, cells + 1, cells + 1};
  NodalIncrements d;
  d.anchor = Anchor::forward;
  d.grid = grid;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) d.displacement.push_back({size * polynomial(grid.position(i, j).x()), 0});
  d.status.assign(grid.node_count(), VectorStatus::valid);
  std::vector<Vec2> places;
  for (int k = 0; k <= 400; ++k) places.emplace_back(k / 400.0, 0.5);
  NpOptions options = bilinear();
  options.shape = shape;
  Tracker tracker(options, particles_at(places), 0);
  tracker.step(d, 1);
  Line line;
  for (std::size_t p = 0; p < places.size(); ++p) {
    line.x.push_back(places[p].x());
    line.read.push_back((tracker.state()[p].x.x() - places[p].x()) / size);
    line.error.push_back(std::abs(line.read.back() - polynomial(places[p].x())));
    line.worst = std::max(line.worst, line.error.back());
  }
  return line;
}

TEST(Figure26, LinearQuadraticAndCubicThroughTheSameNodes) {
  const Line linear = read_line(ShapeFunctions::bilinear, 4), quadratic = read_line(ShapeFunctions::quadratic, 4), fine = read_line(ShapeFunctions::bilinear, 8);
  EXPECT_GT(linear.worst, 0.1);
  EXPECT_LT(quadratic.worst, 0.9 * linear.worst);
  EXPECT_GT(linear.worst / fine.worst, 3.0);  // 4 for small spacings
  // The cubic element: five nodes leave one group of three cells and one moved back. Both repeat the cubic.
  for (const ShapeFunctions shape : {ShapeFunctions::cubic, ShapeFunctions::bspline3})
    EXPECT_LT(read_line(shape, 4).worst, 1e-11) << name_of(shape);
  pivnp::test::verification_row("figure 2.6: a cubic through nodes",
                                "greatest error: quadratic below linear; halved spacing at least 3 times less",
                                "linear " + number(linear.worst, 3) + ", quadratic " + number(quadratic.worst, 3) +
                                    ", linear, halved spacing " + number(fine.worst, 3));
  const char* folder = std::getenv("PIVNP_VERIFICATION_DIR");
  if (folder == nullptr || *folder == '\0') return;
  plot::Chart chart{"x", "displacement", {}, false};
  plot::ChartCurve exact{"cubic polynomial", {}, {}};
  for (const double x : linear.x) exact.x.push_back(x), exact.y.push_back(polynomial(x));
  chart.curves = {exact, {"4 linear", linear.x, linear.read}, {"2 quadratic", quadratic.x, quadratic.read},
                  {"8 linear", fine.x, fine.read}};
  plot::write_chart(chart, std::filesystem::path(folder) / "figure_2_6");
  EXPECT_GT(std::filesystem::file_size(std::filesystem::path(folder) / "figure_2_6.png"), 5000u);
}

}  // namespace
}  // namespace pivnp::np

// Direct correlation, by which drift is corrected: subsets a second, of several sides, rigid to sheared.
#include "pivnp/piv/window/subset.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "tests/bench/piv/bench.hpp"

namespace pivnp::bench {

namespace {

struct Shape {
  std::string name;
  Mat2 A;
};

}  // namespace

int subsets(const BenchOptions& options) {
  options.print_head();
  const std::vector<Shape> shapes = {{"even motion", Mat2::Identity()},
                                     {"stretched by 1.05", (Mat2() << 1.05, 0, 0, 1 / 1.05).finished()},
                                     {"sheared by .3", (Mat2() << 1, 0.3, 0, 1).finished()},
                                     {"turned by 20 degrees", Eigen::Rotation2Dd(0.349).toRotationMatrix()}};
  std::printf("%-22s %8s %12s %12s %10s %8s\n", "motion", "side px", "subsets/s", "us", "ns/pixel", "found");
  const Vec2 centre = 0.5 * Vec2(options.side - 1, options.side - 1);
  for (const Shape& shape : shapes) {
    const auto map = [&](const Vec2& x) { return Vec2(centre + shape.A * (x - centre) + Vec2(3.3, -2.6)); };
    image::TextureOptions texture = options.texture;
    texture.noise = 0.01, texture.seed = static_cast<std::uint64_t>(options.seeds.front());
    const auto pair =
        image::synthetic_pair([&](const Vec2& x) { return Vec2(map(x) - x); }, options.side, options.side, texture);
    const piv::SubsetImage first(pair.first.view(), {}, options.threads),
        second(pair.second.view(), {}, options.threads);
    for (const int side : {21, 33, 65}) {
      std::vector<piv::AffinePrediction> asked;
      for (double y = 0.3 * options.side; y < 0.7 * options.side; y += 9.7)
        for (double x = 0.3 * options.side; x < 0.7 * options.side; x += 9.3) {
          piv::AffinePrediction at;
          at.from = Vec2(x, y), at.to = map(at.from) + Vec2(0.1, -0.08), at.A = shape.A;
          asked.push_back(at);
        }
      piv::SubsetOptions subset;
      subset.side_px = side;
      double best = 1e30;
      std::size_t found = 0;
      for (int n = 0; n < options.repeats; ++n) {
        const double start = now(options);
        const auto matches = piv::match_subsets(first, second, asked, subset, options.threads);
        best = std::min(best, now(options) - start);
        found = std::size_t(
            std::count_if(matches.begin(), matches.end(), [](const piv::SubsetMatch& m) { return m.found; }));
      }
      const double each = best / double(asked.size());
      std::printf("%-22s %8d %12.0f %12.2f %10.2f %7.1f%%\n", shape.name.c_str(), side, 1 / each, 1e6 * each,
                  1e9 * each / (side * side), 100.0 * double(found) / double(asked.size()));
    }
  }
  return 0;
}

}  // namespace pivnp::bench
